"""The machine on which something was measured."""

from __future__ import annotations

import os
import platform
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

CPU_FILE = Path("/proc/cpuinfo")
INSTRUCTION_SETS = ("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512dq", "avx512vl", "neon", "asimd", "sve")
"""Those which decide how many numbers are worked on at once."""
LIBRARIES = ("numpy", "scipy", "numba", "llvmlite")


@dataclass(frozen=True)
class Machine:
    """Processor, its instruction sets among INSTRUCTION_SETS, cores at hand, operating system, versions."""

    processor: str
    instruction_sets: tuple[str, ...]
    cores: int
    load: float
    system: str
    versions: dict[str, str]

    def as_values(self) -> dict[str, object]:
        """Return the same as plain values for JSON."""
        return asdict(self)

    def __str__(self) -> str:
        sets = " ".join(self.instruction_sets) or "unknown"
        versions = ", ".join(f"{name} {number}" for name, number in self.versions.items())
        return (
            f"{self.processor}, {self.cores} cores (load {self.load:.2f} at the start), {self.system}\n"
            f"instruction sets: {sets}\n{versions}"
        )


def describe() -> Machine:
    """Look at this machine; what isn't known here is left empty."""
    facts = _cpu_facts()
    known = set(facts.get("flags", facts.get("Features", "")).split())
    versions = {"Python": platform.python_version()} | {name: _version(name) for name in LIBRARIES}
    return Machine(
        processor=_processor(facts),
        instruction_sets=tuple(name for name in INSTRUCTION_SETS if name in known),
        cores=len(os.sched_getaffinity(0)),
        load=os.getloadavg()[0],
        system=f"{platform.system()} {platform.machine()}",
        versions=versions,
    )


def _processor(facts: dict[str, str]) -> str:
    name = facts.get("model name") or platform.processor() or platform.machine()
    family, model = facts.get("cpu family"), facts.get("model")
    return f"{name} (family {family}, model {model})" if family and model else name


def _cpu_facts() -> dict[str, str]:
    """Return the entries of the first processor."""
    try:
        text = CPU_FILE.read_text(encoding="utf-8")
    except OSError:
        return {}
    pairs = (line.split(":", 1) for line in text.split("\n\n")[0].splitlines() if ":" in line)
    return {key.strip(): value.strip() for key, value in pairs}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
