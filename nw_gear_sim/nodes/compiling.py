"""Loads the kernels, and says so where they have to be compiled first, because nothing else happens meanwhile."""

from __future__ import annotations

import threading
from collections.abc import Callable

from nw_gear_sim.simulation import compile_kernels

PATIENCE = 3.0
"""Seconds after which kernels can't have come from the cache."""
COMPILING = "compiling kernels: this takes about a minute, and only once"


def compile_with_notice(integrator: str, say: Callable[[str], object]) -> None:
    """Compile the kernels of an integrator or load them from the cache; `say` is told if that takes long."""
    notice = threading.Timer(PATIENCE, say, [COMPILING])
    notice.daemon = True
    notice.start()
    try:
        compile_kernels(integrator)
    finally:
        notice.cancel()
