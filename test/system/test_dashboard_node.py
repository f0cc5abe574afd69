"""The dashboard as a process: what it listens on, what it refuses, and how it ends."""

import os
import re
import signal
import socket
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import GetParameters

from nw_gear_common import names
from test.system.processes import LIMIT, Probe, running

TOKEN = "abcdefgh-0123456789"
ADDRESS = re.compile(r"^dashboard: (http://127\.0\.0\.1:(\d+)/)$", re.MULTILINE)


def listening(pid):
    """Addresses on which a process listens (TCP, IPv4 and IPv6, as /proc has them)."""
    inodes = set()
    for entry in Path(f"/proc/{pid}/fd").iterdir():
        target = os.readlink(entry)
        if target.startswith("socket:["):
            inodes.add(target[8:-1])
    found = []
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in inodes:
                found.append(fields[1])
    return found


def get(url, **headers):
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=LIMIT) as response:
            return response.status
    except urllib.error.HTTPError as error:
        error.close()
        return error.code


def test_it_listens_on_loopback_alone_tells_its_address_keeps_its_token_and_ends_well():
    with Probe() as probe, running("dashboard_node", [f"token:={TOKEN}"]) as dashboard:
        said = probe.collect(DiagnosticArray, names.DIAGNOSTICS)
        probe.wait_until(lambda: ADDRESS.search(dashboard.stdout) is not None, dashboard, limit=60.0)
        assert len(dashboard.stdout.splitlines()) == 1
        url, port = ADDRESS.search(dashboard.stdout).groups()
        assert listening(dashboard.pid) == [f"0100007F:{int(port):04X}"]
        assert get(url) == 403
        assert get(url, Authorization=f"Bearer {TOKEN}") == 200

        def addresses():
            statuses = [s for array in said for s in array.status if s.name == "dashboard_node: server"]
            return {pair.value for status in statuses for pair in status.values if pair.key == "address"}

        probe.wait_until(lambda: addresses() == {url}, dashboard)
        request = GetParameters.Request(names=["token", "address"])
        answer = probe.call(GetParameters, "/nw_gear/dashboard_node/get_parameters", request, dashboard)
        assert [value.string_value for value in answer.values] == ["(set)", "127.0.0.1"]
        dashboard.signal(signal.SIGTERM)
        assert dashboard.wait() == 0
        assert TOKEN not in dashboard.stdout + dashboard.stderr


def test_an_address_beyond_loopback_without_a_token_is_refused_in_one_line():
    with running("dashboard_node", ["address:=0.0.0.0"]) as dashboard:
        assert dashboard.wait(60.0) == 2
        assert len(dashboard.stderr.splitlines()) == 1
        assert "parameter token" in dashboard.stderr


@pytest.mark.slow
def test_a_port_that_is_taken_is_refused_in_one_line():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with running("dashboard_node", [f"port:={port}"]) as dashboard:
            assert dashboard.wait(60.0) == 2
            assert len(dashboard.stderr.splitlines()) == 1
            assert "parameter port" in dashboard.stderr
