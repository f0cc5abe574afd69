"""The command line: exit codes and what goes where."""

import signal
import subprocess
import sys

import pytest
import typer

import nw_gear_common
from nw_gear_common import cli
from nw_gear_common.errors import InputError, NwGearError


def application(action):
    app = typer.Typer(pretty_exceptions_enable=False, rich_markup_mode=None)
    app.callback()(lambda: None)

    @app.command()
    def act(number: int = typer.Option(1, "--number")):
        action(number)

    return app


@pytest.fixture
def run(monkeypatch):
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}

    def call(action, *arguments):
        monkeypatch.setattr(cli, "build", lambda: application(action))
        return cli.main(arguments)

    yield call
    for number, handler in handlers.items():
        signal.signal(number, handler)


def raising(error):
    def action(_number):
        raise error

    return action


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (InputError("file.csv: row 3", "a number", "'x'"), 2, "nw_gear: file.csv: row 3: expected a number, got 'x'\n"),
        (NwGearError("the disk is full"), 1, "nw_gear: the disk is full\n"),
        (cli.Interrupted(signal.SIGINT), 130, ""),
        (cli.Interrupted(signal.SIGTERM), 143, ""),
        (typer.Abort(), 130, ""),
    ],
)
def test_errors_become_exit_codes_and_one_line(run, capsys, error, code, message):
    assert run(raising(error), "act") == code
    out, err = capsys.readouterr()
    assert (out, err) == ("", message)


@pytest.mark.parametrize("arguments", [["act", "--number", "x"], ["act", "--nothing"], ["act", "left over"], ["other"]])
def test_wrong_arguments_give_one_line_and_code_2(run, capsys, arguments):
    assert run(lambda _number: None, *arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("nw_gear: ")
    assert err.count("\n") == 1


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_a_command_and_lets_it_tidy_up(run, number, code):
    tidied = []

    def action(_number):
        try:
            signal.raise_signal(number)
        finally:
            tidied.append(True)

    assert run(action, "act") == code
    assert tidied


def test_an_error_that_nobody_foresaw_is_not_hidden(run):
    with pytest.raises(ZeroDivisionError):
        run(lambda number: 1 / (number - 1), "act")


def nw_gear(*arguments):
    command = [sys.executable, "-m", "nw_gear_common.launcher", "nw_gear", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)


def test_version():
    done = nw_gear("--version")
    assert (done.returncode, done.stdout) == (0, f"nw_gear {nw_gear_common.__version__}\n")


@pytest.mark.parametrize("command", ["demo", "review", "info", "recover"])
def test_every_command_has_help_and_is_quick_about_it(command):
    done = nw_gear(command, "--help")
    assert done.returncode == 0, done.stderr
    assert command in done.stdout
    assert "\x1b" not in done.stdout


def test_help_imports_no_heavy_library():
    heavy = "{'numba', 'scipy', 'bokeh', 'rclpy', 'mcap'}"
    code = f"import sys; from nw_gear_common import cli; cli.build(); print(sorted({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout.strip() == "[]"
