"""What the README promises to readers: the snippet works over DDS, the files it names exist, the picture is there."""

import re
import sys

import numpy as np
from std_msgs.msg import Float64MultiArray

from nw_gear_common.ros import to_message
from nw_gear_common.tables import Table
from test.system.installing import ROOT
from test.system.processes import Probe, Process

README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_snippet_reads_the_waveform():
    (snippet,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(snippet.splitlines()) == 1 + 5
    process = Process([sys.executable, "-c", snippet])
    message = to_message(Table("sample", ("time", "x_I_1"), np.array([[0.0, 1.0], [0.5, 4.25]])))
    try:
        with Probe() as probe:
            publisher = probe.node.create_publisher(Float64MultiArray, "/nw_gear/waveform", 20)
            probe.wait_for_match("/nw_gear/waveform", process, subscribers=1)
            probe.wait_until(lambda: publisher.get_subscription_count() >= 1, process)

            def seen():
                publisher.publish(message)
                return "time,x_I_1 [0.5  4.25]" in process.stdout

            probe.wait_until(seen, process)
    finally:
        process.close()


def test_every_file_that_is_linked_exists():
    links = [link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link]
    assert "docs/pictures/report.png" in links
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_every_make_target_that_is_named_exists():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    text = README + (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`make ([a-z-]+)", text)) | set(re.findall(r"^make ([a-z-]+)", text, re.MULTILINE))
    assert {"demo", "test", "test-all", "setup", "lint", "docs", "bench"} <= named
    assert [target for target in named if not re.search(rf"^{target}:", makefile, re.MULTILINE)] == []
