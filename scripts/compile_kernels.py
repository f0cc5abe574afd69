"""Compile every numba kernel into the cache, so that the first run doesn't wait for the compiler."""

from __future__ import annotations

from nw_gear_sim.simulation import compile_kernels


def main() -> None:
    """Compile the simulator's kernels."""
    compile_kernels()


if __name__ == "__main__":
    main()
