"""Loads a page in headless Chromium without any network and tells what it drew and complained about."""

import json
import os
import re
import shutil
import subprocess
from html import unescape

import pytest

PROBE = """
<script>
function canvases(root) {
  let found = [...root.querySelectorAll("canvas")];
  for (const element of root.querySelectorAll("*"))
    if (element.shadowRoot) found = found.concat(canvases(element.shadowRoot));
  return found;
}
function drawn(canvas) {
  if (!canvas.width || !canvas.height) return 0;
  const context = canvas.getContext("2d");
  if (!context) return 0;
  const pixels = context.getImageData(0, 0, canvas.width, canvas.height).data;
  const colours = new Set();
  for (let i = 0; i < pixels.length; i += 4) {
    if (pixels[i + 3] > 0) colours.add(65536 * pixels[i] + 256 * pixels[i + 1] + pixels[i + 2]);
  }
  return colours.size;
}
function report() {
  const figures = [...document.querySelectorAll("[data-root-id]")].map(
    div => {
      const all = canvases(div);
      return {id: div.id, colours: Math.max(0, ...all.map(drawn)), height: Math.max(0, ...all.map(c => c.height))};
    });
  const loads = performance.getEntriesByType("resource").map(entry => entry.name).filter(
    name => !name.startsWith("data:"));
  const pre = document.createElement("pre");
  pre.id = "probe";
  pre.textContent = JSON.stringify({figures, loads, wide: document.documentElement.scrollWidth > window.innerWidth});
  document.body.appendChild(pre);
}
function wait(left) {
  const ready = window.Bokeh && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle);
  if (ready) setTimeout(report, 500);
  else if (left > 0) setTimeout(() => wait(left - 1), 100);
}
window.addEventListener("load", () => wait(600));
</script>
"""


def chromium():
    """The browser, or a skip with the reason; in CI it has to be there."""
    known = ("chromium", "chromium-browser", "google-chrome")
    found = next((path for name in known if (path := shutil.which(name))), None)
    if found is None:
        if os.environ.get("CI") == "true":
            pytest.fail("CI needs chromium (Debian's package)")
        pytest.skip("chromium isn't installed")
    return found


def look(page, folder, width=1400, probe=PROBE):
    """Load a page: returns what the probe saw, and the lines of the console that are errors or warnings.

    A probe is a script that ends by putting its JSON into an element `pre` with the id `probe`.
    """
    probed = folder / "probed.html"
    text = page.read_text(encoding="utf-8")
    end = text.rindex("</body>")
    probed.write_text(text[:end] + probe + text[end:], encoding="utf-8")
    command = [
        chromium(),
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--host-resolver-rules=MAP * ~NOTFOUND",
        f"--user-data-dir={folder / 'profile'}",
        f"--window-size={width},2000",
        "--virtual-time-budget=60000",
        "--enable-logging=stderr",
        "--dump-dom",
        f"file://{probed}",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=150, check=False)
    found = re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.DOTALL)
    assert found, f"the page never became idle: {done.stderr[-2000:]}"
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line and "[bokeh" not in line]
    return json.loads(unescape(found.group(1))), console
