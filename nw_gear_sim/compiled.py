"""How kernels are compiled: without the GIL, dividing by zero as NumPy does, and cached on disk.

`_nrt=False` leaves out the counting of references to arrays, which would take half of the time of a right-hand side;
kernels then can't make arrays, they work on those they are given. The option is numba's own but undocumented, so a new
version of numba has to be tried out first.

Numba notices when the file of a cached function changes, but not when that of a function it calls does. So the cache is
a folder named by a digest of all files with kernels: `~/.cache/nw_gear/kernels-<digest>`, or the same below
`NUMBA_CACHE_DIR` or `XDG_CACHE_HOME`, or a new temporary folder where none of them can be written.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numba.core.compiler
import numba.core.config

SOURCES = ("compiled.py", "model.py", "stepping.py", "integrator/*.py", "modal/*.py", "physics/*.py", "batch/*.py")
"""Files with kernels."""

_OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False}


def digest() -> str:
    """Return a short digest of the sources of all kernels and the version of numba."""
    package = Path(__file__).parent
    total = hashlib.sha256(numba.__version__.encode())
    for path in sorted(path for pattern in SOURCES for path in package.glob(pattern)):
        total.update(path.read_bytes())
    return total.hexdigest()[:16]


def cache_folder() -> Path:
    """Return the folder of the compiled kernels; it is made where it isn't there."""
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(home) / "nw_gear") / f"kernels-{digest()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return Path(tempfile.mkdtemp(prefix="nw_gear-kernels-"))
    return folder if os.access(folder, os.W_OK) else Path(tempfile.mkdtemp(prefix="nw_gear-kernels-"))


_FOLDER = str(cache_folder())


def _compiler(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    def decorate(function: Callable[..., Any]) -> Any:
        kept = numba.core.config.CACHE_DIR
        numba.core.config.CACHE_DIR = _FOLDER  # read when a function is decorated
        try:
            return numba.njit(**_OPTIONS, **options)(function)
        finally:
            numba.core.config.CACHE_DIR = kept

    return decorate


kernel = _compiler()
"""Compiles a function on its first call."""

inlined = _compiler(inline="always")
"""The same, put into its callers, so that large tuples of constants aren't passed on."""

fused = _compiler(fastmath={"contract"})
"""The same as `kernel`, with multiplications and additions fused."""

summing = _compiler(fastmath={"contract", "reassoc", "nsz"})
"""The same as `fused`, with sums in any order, so that they run in lanes; it is the same on one machine."""


class _Apart(numba.core.compiler.Compiler):
    """Compiles functions whose array arguments don't overlap: LLVM then needn't check that before it runs in lanes."""

    def define_pipelines(self) -> Any:
        self.state.flags.noalias = True
        return super().define_pipelines()


apart = _compiler(fastmath={"contract"}, pipeline_class=_Apart)
"""The same as `fused`, for functions which are never given the same array twice if they write to it."""

rounding = _compiler(fastmath=False)
"""The same as `kernel`, also where it is called by functions that fuse, whose options `kernel` would take over."""
