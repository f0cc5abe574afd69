"""Keeps the baseline of a running monitor in its file: read once, written now and then, never over something else."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nw_gear_common.errors import InputError
from nw_gear_monitor.alarms import store
from nw_gear_monitor.alarms.baseline import Baseline

PARAMETER = "parameter baseline_file"
EVERY = 60.0
"""Seconds between two writings, while something is learned."""
RATE_TOLERANCE = 1e-3
"""Sample rates that differ by less are the same."""


class Keeper:
    """The baseline and its file.

    Args:
        file: path; "" keeps the baseline in memory alone.
        identity: of the machine.

    Attributes:
        baseline: what the file held, or an empty one.
        trouble: why the file could not be written last time, "" where it could.

    Raises:
        InputError: the file can't be used: damaged, of another machine, or nothing can be written there.
    """

    def __init__(self, file: str, identity: Mapping[str, Any]) -> None:
        self.path = Path(file).expanduser().absolute() if file else None
        self.trouble = ""
        self._identity = dict(identity)
        found = None if self.path is None else store.read(self.path, self._identity)
        if found is None and self.path is not None:
            _check_folder(self.path.parent)
        self.baseline = Baseline() if found is None else found
        self.found = found is not None
        self._written = self._content()
        self._last = 0.0

    def admit(self, rate: float) -> str:
        """Compare the sample rate (Hz) with that at which the baseline was learned; "" or why it can't be used.

        Spectra end at half of it and impacts are cut differently: features at another rate are other features.
        """
        known = self.baseline.rate
        if known is None:
            self.baseline.rate = rate
            return ""
        if abs(rate - known) <= RATE_TOLERANCE * known:
            return ""
        return f"the baseline was learned at {known:g} Hz, the waveform has {rate:g} Hz"

    def keep(self, moment: float) -> None:
        """Write the file where it is time (s, any steady clock) and something has changed; see `trouble`."""
        if moment - self._last >= EVERY:
            self._last = moment
            self.save()

    def save(self) -> None:
        """Write the file now, where something has changed; see `trouble`."""
        content = self._content()
        if self.path is None or content == self._written:
            return
        try:
            store.write(self.path, self.baseline, self._identity)
            self.trouble, self._written = "", content
        except InputError as error:
            self.trouble = str(error)

    def export(self, file: str) -> str:
        """Write a copy somewhere else and return its path.

        Raises:
            InputError: no file is named, or it can't be written.
        """
        if not file:
            raise InputError("parameter export_file", "the file to write to", "nothing")
        path = Path(file).expanduser().absolute()
        store.write(path, self.baseline, self._identity)
        return str(path)

    def _content(self) -> tuple[float, bool, int]:
        """What changes with everything that is learned or set."""
        windows = sum(float(block[0].sum()) for block in self.baseline.bins.values())
        return windows, self.baseline.frozen, len(self.baseline.names)


def _check_folder(folder: Path) -> None:
    if not folder.is_dir():
        raise InputError(PARAMETER, "a file in a folder that exists", f"no folder {folder}")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(PARAMETER, "a folder that can be written to", str(folder))
