"""The whole suite for hours: memory of every process, lost blocks, and a restart of each node in the middle.

    python benchmark/soak/run.py --hours 1 [--folder DIR] [--publish]

Real time, default wind, recorder and dashboard beside simulator and monitor. For the first half nothing is disturbed;
then each node in turn is ended and started again, and the others have to notice and to go on. Prints one JSON object;
the exit code is 1 where something isn't as it should be. `--publish` keeps the result and the table of docs/soak.md.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import tempfile
import time
import urllib.request
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "benchmark"), str(ROOT)]

from soak import checks  # noqa: E402 - found by the line above
from soak.suite import Suite, apart  # noqa: E402
from soak.witness import OK, STALE, WARN, Witness, witnessing  # noqa: E402

LOOK_EVERY, SAMPLE_EVERY = 0.2, 5.0
UNDISTURBED = 0.5
"""Share of the time before the first restart."""
NOTICE_LIMIT, RETURN_LIMIT, PAGE_WITHIN = 30.0, 90.0, 30.0
SIM, MONITOR, RECORDER = "gear_sim_node: integration", "gear_monitor_node: stream", "recorder_node: recording"
STAGE, SERVER, WIND = "gear_monitor_node: stage III", "dashboard_node: server", "wind_node: wind"
PARAMETERS: dict[str, dict[str, str]] = {
    "recorder_node": {},
    "gear_monitor_node": {},
    "dashboard_node": {"port": "0"},
    "gear_sim_node": {"wait_for": "3"},
    "wind_node": {},
}


@dataclass(frozen=True)
class Restart:
    """What is seen when a node is missing, and when it is back; who has to be well meanwhile."""

    node: str
    seen_missing: Callable[[Witness], bool]
    seen_back: Callable[[Witness], bool]
    unharmed: tuple[str, ...]


def page(witness: Witness) -> bool:
    """Whether the dashboard's page can be fetched where the node says it is."""
    words = witness.message(SERVER).split()
    if witness.level(SERVER) is None or not words:
        return False
    try:
        with urllib.request.urlopen(words[-1], timeout=PAGE_WITHIN) as answer:
            return bool(answer.status == 200)
    except OSError:
        return False


def windless(witness: Witness) -> bool:
    """Whether the simulator misses the wind."""
    return witness.message(SIM).startswith(("nothing on", "waiting for"))


def heard(witness: Witness) -> bool:
    """Whether the monitor hears the simulator."""
    return witness.level(STAGE) not in (None, STALE) and "no whole second" not in witness.message(STAGE)


RESTARTS = (
    Restart("wind_node", windless, lambda w: w.level(WIND) is not None and not windless(w), (SIM, MONITOR, RECORDER)),
    Restart("gear_monitor_node", lambda w: w.level(STAGE) is None, heard, (SIM, RECORDER)),
    Restart("recorder_node", lambda w: w.level(RECORDER) is None, lambda w: w.level(RECORDER) == OK, (SIM, MONITOR)),
    Restart("dashboard_node", lambda w: w.level(SERVER) is None, page, (SIM, MONITOR, RECORDER)),
    Restart(
        "gear_sim_node",
        lambda w: w.level(STAGE) == STALE,
        heard,
        (WIND, RECORDER),
    ),
)


class Soak:
    """One run."""

    def __init__(self, suite: Suite, witness: Witness) -> None:
        self.problems: list[str] = []
        self.restarts: list[dict[str, Any]] = []
        self._suite, self._witness = suite, witness
        self._sampled = 0.0

    def wait(self, limit: float, until: Callable[[], bool] = lambda: False) -> float | None:
        """Listen until something holds; returns the seconds it took, None where it didn't within the limit."""
        began = time.monotonic()
        while (spent := time.monotonic() - began) < limit:
            time.sleep(LOOK_EVERY)
            if time.monotonic() - self._sampled > SAMPLE_EVERY:
                self._sampled = time.monotonic()
                self._suite.sample()
                for name in self._suite.dead():
                    self.problems.append(f"{name} ended by itself")
                    self._suite.stop(name)
            if until():
                return spent
        return None

    def begin(self) -> None:
        """Start everything and wait until it runs."""
        for name in self._suite.names:
            self._suite.start(name)
        if self.wait(240.0, lambda: self._witness.blocks > 20 and page(self._witness)) is None:
            self.problems.append("the suite didn't start")

    def restart(self, what: Restart) -> None:
        """End a node and start it again."""
        witness = self._witness
        self._suite.stop(what.node)
        noticed = self.wait(NOTICE_LIMIT, lambda: what.seen_missing(witness))
        harmed = [status for status in what.unharmed if witness.level(status) not in (OK, WARN)]
        if what.node == "gear_sim_node":
            witness.expect_a_break()
        self._suite.start(what.node)
        back = self.wait(RETURN_LIMIT, lambda: what.seen_back(witness))
        self.restarts.append({"node": what.node, "noticed_s": noticed, "back_s": back, "harmed": harmed})
        if noticed is None or back is None or harmed:
            self.problems.append(f"restart of {what.node}: noticed {noticed}, back {back}, harmed {harmed}")


def soak(hours: float, folder: Path) -> dict[str, Any]:
    """Run the suite and return what was found."""
    length = 3600.0 * hours
    with witnessing() as witness:
        suite = Suite(folder, PARAMETERS)
        run = Soak(suite, witness)
        began = time.monotonic()
        try:
            run.begin()
            run.wait(UNDISTURBED * length)
            pause = (1.0 - UNDISTURBED) * length / (len(RESTARTS) + 1)
            for what in RESTARTS:
                run.restart(what)
                run.wait(pause)
            run.wait(length - (time.monotonic() - began))
            lost = witness.value(RECORDER, "lost messages (1)")
        finally:
            suite.stop_all()
    return checks.result(hours, suite, witness, run.restarts, run.problems, lost)


def main() -> int:
    """Run and report; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=1.0)
    parser.add_argument("--folder", type=Path, help="of logs and recordings (default: a temporary one)")
    parser.add_argument("--publish", action="store_true", help="keep the result in benchmark/results and docs/soak.md")
    given = parser.parse_args()
    apart()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the nodes are ended too
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        found = soak(given.hours, folder)
    print(json.dumps(found, indent=1))
    if given.publish:
        checks.publish(found, ROOT)
    return int(bool(found["problems"]))


if __name__ == "__main__":
    raise SystemExit(main())
