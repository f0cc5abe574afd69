// Reads an MCAP file with @mcap/core and decodes every message with @foxglove/rosmsg2-serialization.
// Prints one JSON object: per topic its type, count, and every message as [log time in ns as text, message].
// With "count" behind the file the messages are read, decompressed and counted, but neither decoded nor printed.

import { open } from "node:fs/promises";
import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader } from "@mcap/core";
import { decompress as zstd } from "fzstd";
import lz4 from "lz4js";

const counting = process.argv[3] === "count";
const file = await open(process.argv[2], "r");
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const buffer = new Uint8Array(Number(size));
    await file.read(buffer, 0, Number(size), Number(offset));
    return buffer;
  },
};
const decompressHandlers = {
  zstd: (buffer, size) => zstd(buffer, new Uint8Array(Number(size))),
  lz4: (buffer) => new Uint8Array(lz4.decompress(buffer)),
};

const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const decoders = new Map();
const topics = {};
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  const text = new TextDecoder().decode(schema.data);
  decoders.set(channel.id, new serialization.MessageReader(rosmsg.parse(text, { ros2: true })));
  topics[channel.topic] = {
    type: schema.name,
    encoding: schema.encoding,
    count: Number(reader.statistics.channelMessageCounts.get(channel.id) ?? 0n),
    messages: [],
  };
}
if (counting) Object.values(topics).forEach((topic) => (topic.count = 0));
for await (const message of reader.readMessages()) {
  if (counting) {
    topics[reader.channelsById.get(message.channelId).topic].count += 1;
    continue;
  }
  const decoded = decoders.get(message.channelId).readMessage(message.data);
  topics[reader.channelsById.get(message.channelId).topic].messages.push([String(message.logTime), decoded]);
}
const metadata = {};
for await (const record of reader.readMetadata()) {
  metadata[record.name] = Object.fromEntries(record.metadata);
}
await file.close();

const plain = (_key, value) => {
  if (typeof value === "bigint") return Number(value);
  return ArrayBuffer.isView(value) ? Array.from(value) : value;
};
console.log(JSON.stringify({ profile: reader.header.profile, topics, metadata }, plain));
