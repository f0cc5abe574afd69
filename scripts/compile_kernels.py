"""Compile every numba kernel into the cache, so that the first run doesn't wait for the compiler."""

from __future__ import annotations

from nw_gear_monitor.analyse import kernels
from nw_gear_monitor.gearing import gearing
from nw_gear_monitor.warm_up import warm_up
from nw_gear_sim import config
from nw_gear_sim.simulation import compile_kernels


def main() -> None:
    """Compile the kernels of the simulator, then those of the monitor and of `nw_gear analyse`."""
    compile_kernels()
    warm_up(gearing(config.load(None)))
    kernels.compile_kernels()


if __name__ == "__main__":
    main()
