"""Words of the container: keys and encodings that rosbag2, Foxglove and the readers of this project look for."""

from __future__ import annotations

PROFILE = "ros2"
SCHEMA_ENCODING = "ros2msg"
MESSAGE_ENCODING = "cdr"

QOS_KEY = "offered_qos_profiles"
"""In the metadata of a channel: what the publishers offered, YAML as in metadata.yaml version 9."""

HASH_KEY = "topic_type_hash"
"""In the metadata of a channel: RIHS01 hash of the type."""

PROVENANCE = "nw_gear."
"""What the names of this project's metadata records begin with."""

RUN = f"{PROVENANCE}run"
"""Metadata record: command line, versions, date, and what the caller gave."""

LOSS = f"{PROVENANCE}loss"
"""Metadata record: what is known to be missing, topic by topic. Written when it changes; the last one counts."""

NODE = f"{PROVENANCE}node."
"""Beginning of the metadata records with all parameters of one node each; the node's name follows."""
