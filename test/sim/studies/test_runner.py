"""Pieces of a study: each computed once, kept whatever happens, on processes and on a real cluster."""

import json
import os
import resource
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from nw_gear_common.errors import InputError, NwGearError
from nw_gear_sim.studies.runner import run
from nw_gear_sim.studies.store import Store
from test.sim.studies import pieces as work

ROOT = Path(__file__).resolve().parents[3]
COUNT = 8


def make(tmp_path, identity=("squares",)):
    marks = tmp_path / "marks"
    marks.mkdir(exist_ok=True)
    store = Store(tmp_path / "study", {"what": list(identity)})
    return {str(n): (str(marks), n) for n in range(COUNT)}, store, marks


def calls(marks):
    return {path.stem: len(path.read_text(encoding="utf-8").splitlines()) for path in marks.glob("*.calls")}


def right(store):
    return {key: float(store.get(key)["square"][0]) for key in store.done()} == {str(n): n**2 for n in range(COUNT)}


def test_every_piece_is_computed_once(tmp_path):
    pieces, store, marks = make(tmp_path)
    seen = []
    assert run(pieces, work.square, store, workers=2, say=seen.append) == COUNT
    assert run(pieces, work.square, store, workers=2) == 0
    assert calls(marks) == {str(n): 1 for n in range(COUNT)}
    assert right(store)
    assert [p.done for p in seen] == list(range(COUNT + 1))
    assert seen[-1].left == 0.0


def test_after_a_failure_the_rest_is_computed_later(tmp_path):
    pieces, store, marks = make(tmp_path)
    with pytest.raises(ZeroDivisionError):
        run(pieces, work.fails_at_five, store, workers=1)
    kept = store.done()
    assert "0" in kept
    assert "5" not in kept
    assert run(pieces, work.square, store, workers=1) == COUNT - len(kept)
    assert all(calls(marks)[key] == 1 for key in kept)
    assert right(store)


def test_a_worker_that_is_killed_loses_nothing(tmp_path):
    pieces, store, _ = make(tmp_path)
    run(pieces, work.dies_once, store, workers=2)
    assert right(store)


def test_workers_that_keep_dying_are_given_up(tmp_path):
    pieces, store, _ = make(tmp_path)
    with pytest.raises(NwGearError, match="a worker died 3 times"):
        run(pieces, work.always_dies, store, workers=1)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_study_that_is_killed_goes_on(tmp_path, number):
    pieces, store, marks = make(tmp_path)
    script = f"""
        from pathlib import Path
        from nw_gear_sim.studies.runner import run
        from nw_gear_sim.studies.store import Store
        from test.sim.studies.pieces import slow_square
        if __name__ == "__main__":
            pieces = {pieces!r}
            run(pieces, slow_square, Store(Path({str(store.folder)!r}), {{"what": ["squares"]}}), workers=1)
    """
    file = tmp_path / "study.py"
    file.write_text(textwrap.dedent(script), encoding="utf-8")
    process = subprocess.Popen([sys.executable, file], env={**os.environ, "PYTHONPATH": str(ROOT)})
    end = time.monotonic() + 60
    while len(list((store.folder / "pieces").glob("*.npz"))) < 2:
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.02)
    process.send_signal(number)
    process.wait(timeout=30)
    kept = store.done()
    assert 2 <= len(kept) < COUNT
    assert run(pieces, work.square, store, workers=1) == COUNT - len(kept)
    assert right(store)
    assert all(calls(marks)[key] == 1 for key in kept)


def start(*arguments):
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_on_a_cluster_whose_worker_is_killed(tmp_path):
    pieces, store, marks = make(tmp_path)
    file = tmp_path / "scheduler.json"
    scheduler = start(
        "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)
    )
    running = [scheduler]
    try:
        end = time.monotonic() + 60
        while not file.exists():
            assert time.monotonic() < end
            time.sleep(0.05)
        address = json.loads(file.read_text(encoding="utf-8"))["address"]
        running += [
            start("worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
            for _ in range(2)
        ]
        time.sleep(0.1)
        victim = running[1]

        def say(progress):
            if progress.done == 2:
                victim.send_signal(signal.SIGKILL)

        waited = time.monotonic() + 60
        while True:
            try:
                run(pieces, work.slow_square, store, dask=address, say=say)
                break
            except InputError:  # no workers yet
                assert time.monotonic() < waited
                time.sleep(0.2)
        assert right(store)
        assert set(calls(marks)) == {str(n) for n in range(COUNT)}
    finally:
        for process in running:
            process.kill()
            process.wait(timeout=10)


def test_a_cluster_that_is_not_there(tmp_path):
    pieces, store, _ = make(tmp_path)
    with pytest.raises(InputError, match=r"--dask tcp://127\.0\.0\.1:9"):
        run(pieces, work.square, store, dask="tcp://127.0.0.1:9")


# --- the store --------------------------------------------------------------------------------------------------------


def test_another_study_is_refused(tmp_path):
    make(tmp_path)
    with pytest.raises(InputError, match=r'what.*"squares".*"cubes"'):
        Store(tmp_path / "study", {"what": ["cubes"]})


def test_a_damaged_piece_is_put_aside_and_computed_again(tmp_path):
    pieces, store, marks = make(tmp_path)
    run(pieces, work.square, store, workers=1)
    path = store.folder / "pieces" / "4.npz"
    path.write_bytes(path.read_bytes()[:-30])
    assert run(pieces, work.square, store, workers=1) == 1
    assert store.damaged == ["4"]
    assert path.with_suffix(".npz.damaged").exists()
    assert calls(marks)["4"] == 2
    assert right(store)


def test_a_full_disk_is_said_and_keeps_the_rest(tmp_path):
    pieces, store, _ = make(tmp_path)
    run({"0": pieces["0"]}, work.square, store, workers=1)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, before[1]))  # no file may grow beyond 100 bytes
    try:
        with pytest.raises(InputError, match="room for the results"):
            run(pieces, work.square, store, workers=1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert store.done() == {"0"}
    assert list((store.folder / "pieces").iterdir()) == [store.folder / "pieces" / "0.npz"]


def test_folders_that_cannot_be_used(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="can be written to"):
        Store(tmp_path / "file", {})
    (tmp_path / "loose" / "pieces").mkdir(parents=True)
    (tmp_path / "loose" / "pieces" / "a.npz").touch()
    with pytest.raises(InputError, match="pieces without it"):
        Store(tmp_path / "loose", {})
