"""`nw_gear demo`: the whole suite as processes, until the recording holds the wanted time, then the report.

The nodes are started as processes of their own, exactly as a person would start them; this command only watches them
and ends them in the right order.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer

from nw_gear_common.cli import Interrupted
from nw_gear_common.errors import InputError, NwGearError
from nw_gear_common.processes import ChildRefused, Process, stop_all

WIND_SOURCES = ("weibull", "constant", "step", "gust")
SUBSCRIBERS = 2
"""The monitor and the recorder: the simulator waits for both, so that no block is missed."""


def demo(
    duration: Annotated[float, typer.Option(help="Simulated seconds to record.", min=0.05)] = 30.0,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="New folder of the run (default runs/<time>).")
    ] = None,
    config: Annotated[str, typer.Option(help="Configuration over the default one: a file or a preset's name.")] = "",
    wind: Annotated[str, typer.Option(help="weibull, constant, step, gust, or a CSV file.")] = "weibull",
    seed: Annotated[int, typer.Option(help="Seed of the wind.", min=0)] = 1,
    real_time_factor: Annotated[
        float, typer.Option(help="Simulated seconds per second; 0 = as fast as possible.", min=0.0)
    ] = 1.0,
    domain: Annotated[
        int | None, typer.Option(help="ROS domain (default ROS_DOMAIN_ID, else one of its own).", min=0, max=232)
    ] = None,
    report: Annotated[bool, typer.Option(help="Write the report afterwards.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")] = False,
) -> None:
    """Run wind, gearbox, monitor and recorder, then write the report."""
    folder = _new_folder(output)
    environment = _environment(domain)
    processes: list[Process] = []
    try:
        for command in _commands(folder, duration, config, wind, seed, real_time_factor):
            processes.append(Process(command, folder / "logs", environment))
        simulated = _watch(processes, duration, environment)
        _end(processes)
        page = _review(folder, environment) if report else None
    except BaseException as error:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
        stop_all(reversed(processes))
        if isinstance(error, ChildRefused):
            shutil.rmtree(folder)
        elif isinstance(error, Interrupted):
            print(f"interrupted; the recording up to now is in {folder}", file=sys.stderr)
        raise
    if as_json:
        result = {"run": str(folder), "recording": str(folder / "recording"), "report": page, "simulated": simulated}
        print(json.dumps(result))
    else:
        print(f"recording: {folder / 'recording'}" + (f"\nreport:    {page}" if page else ""))


def _new_folder(output: Path | None) -> Path:
    folder = output or Path("runs") / datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    if folder.exists():
        raise InputError(f"-o {folder}", "a new folder", "one that exists")
    try:
        (folder / "logs").mkdir(parents=True)
    except OSError as error:
        raise InputError(f"-o {folder}", "a folder that can be made", str(error)) from None
    return folder


def _environment(domain: int | None) -> dict[str, str]:
    """The environment of every process: loopback only, and a domain that other runs on this machine don't use."""
    environment = dict(os.environ)
    environment.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    if domain is not None:
        environment["ROS_DOMAIN_ID"] = str(domain)
    environment.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    environment["PYTHONUNBUFFERED"] = "1"
    return environment


def _commands(
    folder: Path, duration: float, config: str, wind: str, seed: int, real_time_factor: float
) -> list[tuple[str, dict[str, object]]]:
    """The executables and their parameters, in the order in which they start."""
    clocked: dict[str, object] = {} if real_time_factor == 1.0 else {"use_sim_time": True}
    measured: dict[str, object] = {"source": "file", "file": str(Path(wind).absolute())}
    source: dict[str, object] = {"source": wind} if wind in WIND_SOURCES else measured
    given = str(Path(config).absolute()) if Path(config).is_file() else config
    chosen: dict[str, object] = {"config": given} if config else {}
    provenance = json.dumps({"command_line": sys.argv})
    simulator = {"real_time_factor": real_time_factor, "duration": duration, "wait_for": SUBSCRIBERS}
    return [
        ("recorder_node", {"uri": str((folder / "recording").absolute()), "provenance": provenance, **clocked}),
        ("gear_monitor_node", {**chosen, **clocked}),
        ("gear_sim_node", {**simulator, **chosen}),
        ("wind_node", {"seed": seed, **source, **chosen, **clocked}),
    ]


def _watch(processes: list[Process], duration: float, environment: dict[str, str]) -> float:
    """Show progress until the simulator has ended by itself; return the simulated seconds."""
    os.environ.update({key: environment[key] for key in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE")})
    from nw_gear_common.watching import Watch  # noqa: PLC0415 - rclpy is imported only where a command needs it

    simulator = next(p for p in processes if p.name == "gear_sim_node")
    with Watch(duration) as watch:
        while simulator.running:
            watch.look(0.2)
            for process in processes:
                if process is not simulator and not process.running:
                    raise process.failure()
        if simulator.code != 0:
            raise simulator.failure()
    return duration


def _end(processes: list[Process]) -> None:
    """End what still runs, the sources first, the recorder last."""
    remaining = sorted(processes, key=lambda p: p.name == "recorder_node")
    for process in remaining:
        process.stop()
        if process.code != 0:
            raise process.failure()


def _review(folder: Path, environment: dict[str, str]) -> str:
    page = folder / "report.html"
    command = [sys.executable, "-m", "nw_gear_common.launcher", "nw_gear", "review", str(folder), "-o", str(page)]
    done = subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=False)
    if done.returncode != 0:
        code = done.returncode
        raise NwGearError(f"the report could not be written (exit code {code}); the recording is in {folder}")
    return str(page)
