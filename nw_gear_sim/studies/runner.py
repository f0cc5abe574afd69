"""Computes the pieces of a study that aren't there yet, on all cores or on a cluster, and keeps each as it comes."""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.tables import Array
from nw_gear_sim.studies.store import Store

Work = Callable[[Any], dict[str, Array]]
AHEAD = 2
"""Pieces handed out per worker: one that is computed, one that waits, so that no worker is ever idle."""
MOST_CRASHES = 3
CONNECT_WITHIN = 5.0


@dataclass(frozen=True)
class Progress:
    """How far a study is.

    Attributes:
        done, total: pieces.
        elapsed: seconds of this run; left: estimated seconds to its end, NaN before the first piece.
        seconds_per_piece: of one worker's time; workers: at the same time.
    """

    done: int
    total: int
    elapsed: float
    left: float
    seconds_per_piece: float
    workers: int


def run(
    pieces: Mapping[str, Any],
    work: Work,
    store: Store,
    *,
    workers: int | None = None,
    dask: str = "",
    say: Callable[[Progress], None] = lambda _: None,
) -> int:
    """Compute what is missing.

    A piece that was finished is kept whatever happens afterwards: an interruption, a failure of another piece, a crash
    of a worker. Workers that die are replaced and their pieces given out again.

    Args:
        pieces: key -> what `work` is called with; both have to survive pickling.
        work: a function of a module.
        store: where results are and go.
        workers: processes; as many as cores by default.
        dask: address of the scheduler of an existing cluster, in the place of processes here.
        say: told about progress after every piece.

    Returns:
        number of pieces computed now.

    Raises:
        InputError: no such cluster, or what `work` or the store raises.
        NwGearError: workers keep dying.
    """
    finished = store.done()
    missing = [key for key in pieces if key not in finished]
    count = workers or len(os.sched_getaffinity(0))
    if count < 1:
        raise InputError("--workers", "at least 1", str(count))
    began, crashes = time.monotonic(), 0
    say(_progress(len(pieces) - len(missing), len(pieces), 0, began, count))
    while missing:
        try:
            with _executor(count, dask) as (executor, parallel):
                for key, arrays in _results(executor, work, pieces, list(missing), AHEAD * parallel):
                    store.put(key, arrays)
                    missing.remove(key)
                    done = len(pieces) - len(missing)
                    say(_progress(done, len(pieces), done - len(finished & set(pieces)), began, parallel))
        except BrokenProcessPool:
            crashes += 1
            if crashes >= MOST_CRASHES:
                raise NwGearError(
                    f"a worker died {crashes} times (out of memory?); {len(pieces) - len(missing)} of {len(pieces)} "
                    f"pieces are kept in {store.folder}"
                ) from None
    return len(pieces) - len(finished & set(pieces))


def _results(
    executor: Executor, work: Work, pieces: Mapping[str, Any], waiting: list[str], most: int
) -> Iterator[tuple[str, dict[str, Array]]]:
    """Yield results as they come; what is under way when this ends is given up."""
    running: dict[Future[dict[str, Array]], str] = {}
    try:
        while waiting or running:
            while waiting and len(running) < most:
                key = waiting.pop(0)
                running[executor.submit(work, pieces[key])] = key
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                yield running.pop(future), future.result()
    finally:
        for future in running:
            future.cancel()


@contextmanager
def _processes(workers: int) -> Iterator[Executor]:
    """Processes that leave Ctrl-C to their parent, and end at once where it does."""
    before = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), _ignore_interrupts)
    try:
        yield pool
        pool.shutdown()
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in set(multiprocessing.active_children()) - before:
            process.terminate()
        raise


def _ignore_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextmanager
def _executor(workers: int, dask: str) -> Iterator[tuple[Executor, int]]:
    if not dask:
        with _processes(workers) as pool:
            yield pool, workers
        return
    try:
        from distributed import Client  # noqa: PLC0415 - only where a cluster is used
    except ImportError:
        raise InputError("--dask", "the package `distributed` (pip install distributed)", "none") from None
    try:
        client = Client(dask, timeout=CONNECT_WITHIN, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f"--dask {dask}", "the address of a running scheduler", str(error)) from None
    with client:
        threads = sum(client.nthreads().values())
        if threads == 0:
            raise InputError(f"--dask {dask}", "a cluster with workers", "none")
        yield client.get_executor(retries=MOST_CRASHES, pure=False), threads


def _progress(done: int, total: int, now: int, began: float, workers: int) -> Progress:
    elapsed = time.monotonic() - began
    each = elapsed / now if now else float("nan")
    return Progress(done, total, elapsed, each * (total - done), each * workers, workers)
