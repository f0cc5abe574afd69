"""Work for the tests of the runner; workers import it."""

import os
import signal
import time
from pathlib import Path

import numpy as np


def square(piece):
    """Leave a mark for each call, then square."""
    folder, number = piece
    with (Path(folder) / f"{number}.calls").open("a", encoding="utf-8") as file:
        file.write(f"{os.getpid()}\n")
    return {"square": np.array([float(number) ** 2])}


def slow_square(piece):
    time.sleep(0.3)
    return square(piece)


def dies_once(piece):
    """The worker that gets number 3 first is killed by the system."""
    folder, number = piece
    mark = Path(folder) / "died"
    if number == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return square(piece)


def always_dies(_piece):
    os.kill(os.getpid(), signal.SIGKILL)


def fails_at_five(piece):
    if piece[1] == 5:
        raise ZeroDivisionError("five")
    return square(piece)
