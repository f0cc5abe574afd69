"""Who may see the live page: tried on the gate alone, then over HTTP and websockets."""

import asyncio
import threading

import pytest
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from nw_gear_common.errors import InputError
from nw_gear_monitor.dashboard.feed import Feed
from nw_gear_monitor.dashboard.gate import ALLOWED, HAND_OVER, REFUSED, Gate, check_address, is_loopback
from nw_gear_monitor.dashboard.page import Show
from nw_gear_monitor.dashboard.server import Server

TOKEN = "abcdefgh-0123456789"


@pytest.mark.parametrize("address", ["127.0.0.1", "localhost", "::1", "127.1.2.3"])
def test_loopback_needs_no_token(address):
    check_address(address, "")
    assert is_loopback(address)


@pytest.mark.parametrize("address", ["0.0.0.0", "::", "192.168.1.5", "10.0.0.1"])
def test_other_addresses_need_one(address):
    with pytest.raises(InputError, match="token"):
        check_address(address, "")
    check_address(address, TOKEN)


@pytest.mark.parametrize("token", ["short", "with spaces in the middle", "semicolons;in;a;cookie", "ümläute-ümläute-"])
def test_tokens_that_are_guessed_or_break_a_cookie_are_refused(token):
    with pytest.raises(InputError, match="token"):
        check_address("127.0.0.1", token)


@pytest.mark.parametrize("address", ["example.org", "", "127.0.0.1.evil.org", "127.0.0.1 "])
def test_only_addresses_are_listened_on(address):
    with pytest.raises(InputError, match="address"):
        check_address(address, TOKEN)


@pytest.mark.parametrize(
    ("headers", "allowed"),
    [
        ({"Host": "127.0.0.1:5000"}, True),
        ({"Host": "localhost:9999"}, True),  # an SSH tunnel
        ({"Host": "[::1]:5000"}, True),
        ({"Host": "localhost:5000", "Origin": "http://localhost:5000"}, True),
        ({"Host": "evil.org:5000"}, False),  # its name leads to 127.0.0.1
        ({"Host": "localhost.evil.org"}, False),
        ({}, False),
        ({"Host": "127.0.0.1:5000", "Origin": "http://evil.org"}, False),  # another page opens a websocket
        ({"Host": "127.0.0.1:5000", "Origin": "http://127.0.0.1:6000"}, False),
        ({"Host": "127.0.0.1:5000", "Origin": "null"}, False),
    ],
)
def test_pages_of_others_get_nothing(headers, allowed):
    assert (Gate("127.0.0.1", 5000, "").judge(headers, "", "").what == ALLOWED) == allowed


def test_a_token_goes_into_a_cookie_or_a_header():
    gate, host = Gate("0.0.0.0", 80, TOKEN), {"Host": "turbine7:80"}
    assert gate.judge(host, "", "").what == REFUSED
    assert gate.judge(host, TOKEN, "").what == HAND_OVER
    assert gate.judge(host, TOKEN[:-1], "").what == REFUSED
    assert gate.judge(host, "", TOKEN).what == ALLOWED
    assert gate.judge(host, "", TOKEN + "x").what == REFUSED
    assert gate.judge({**host, "Authorization": f"Bearer {TOKEN}"}, "", "").what == ALLOWED
    assert gate.judge({**host, "Authorization": "Bearer "}, "", "").what == REFUSED
    assert gate.judge({**host, "Origin": "http://evil.org"}, "", TOKEN).what == REFUSED


@pytest.fixture
def served():
    started = []

    def serve(token):
        server = Server("127.0.0.1", 0, token)
        feed = Feed(10.0, 3.0)
        server.start(Show(feed, server.digest, lambda request: None, "live", "/nw_gear/waveform", 20.0, 3.0))
        started.append(server)
        return server

    yield serve
    for server in started:
        server.stop()


def fetch(url, **options):
    async def get():
        client = AsyncHTTPClient(force_instance=True)
        try:
            return await client.fetch(HTTPRequest(url, follow_redirects=False, **options))
        except HTTPClientError as error:
            return error.response
        finally:
            client.close()

    return asyncio.run(get())


def test_every_request_has_to_carry_the_token(served):
    server = served(TOKEN)
    for path in ("", "static/js/bokeh.min.js", "ws", "metadata", "autoload.js", "alive", "favicon.ico", "nothing"):
        response = fetch(server.url + path)
        assert response.code == 403, path
        assert TOKEN not in response.body.decode()
    handed = fetch(f"{server.url}?token={TOKEN}")
    assert handed.code == 302
    assert handed.headers["Location"] == "/"
    cookie = handed.headers["Set-Cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    carried = {"Cookie": cookie.split(";")[0]}
    page = fetch(server.url, headers=carried)
    assert page.code == 200
    assert "waiting for" not in page.body.decode()  # the page's words come through the websocket
    assert fetch(f"{server.url}static/js/bokeh.min.js", headers=carried).code == 200

    async def websocket(headers):
        request = HTTPRequest(server.url.replace("http", "ws") + "ws", headers=headers)
        connection = await websocket_connect(request, subprotocols=["bokeh"])
        connection.close()

    with pytest.raises(HTTPClientError) as refused:
        asyncio.run(websocket({}))
    assert refused.value.code == 403
    with pytest.raises(HTTPClientError) as refused:
        asyncio.run(websocket({**carried, "Origin": "http://evil.org"}))
    assert refused.value.code == 403
    asyncio.run(websocket(carried))


def test_nothing_on_the_page_comes_from_elsewhere_and_a_port_that_is_taken_is_named(served):
    server = served("")
    text = fetch(server.url).body.decode()
    assert "waveform" in text.lower()
    addresses = [part.split('"')[0] for mark in ('src="', 'href="') for part in text.split(mark)[1:]]
    assert [a for a in addresses if not a.startswith(("/static/", "#", "data:,"))] == []
    assert fetch(server.url, headers={"Host": "evil.org"}).code == 403
    with pytest.raises(InputError, match=r"port: expected a free port"):
        Server("127.0.0.1", server.port, "")


def test_a_server_that_is_stopped_leaves_its_port_and_its_thread(served):
    server = served("")
    server.stop()
    assert not any(thread.name == "server" for thread in threading.enumerate())
    Server("127.0.0.1", server.port, "").stop()
