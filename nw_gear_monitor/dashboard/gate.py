"""Who may see the page: loopback by default, another address only with a token that every request carries.

Pure: header values in, a verdict out.
"""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit

from nw_gear_common.errors import InputError

LOOPBACK_NAMES = ("localhost",)
SHORTEST_TOKEN = 16
ALLOWED, HAND_OVER, REFUSED = "allowed", "hand over", "refused"


def is_loopback(host: str) -> bool:
    """Whether a name or address of a host is this machine's own loopback."""
    if host in LOOPBACK_NAMES:
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def check_address(address: str, token: str) -> None:
    """Refuse an address beyond loopback without a token, and tokens that are guessed or can't be carried.

    Raises:
        InputError: says which.
    """
    if address not in LOOPBACK_NAMES:
        try:
            ipaddress.ip_address(address)
        except ValueError:
            raise InputError("parameter address", "an IP address or localhost", repr(address)) from None
    if not token:
        if not is_loopback(address):
            raise InputError("parameter token", f"a token, as {address} can be reached from other machines", "none")
        return
    if len(token) < SHORTEST_TOKEN or not token.isascii() or not token.replace("-", "").replace("_", "").isalnum():
        expected = f"at least {SHORTEST_TOKEN} letters, digits, - or _"
        raise InputError("parameter token", expected, f"{len(token)} characters")


@dataclass(frozen=True)
class Verdict:
    """What to do with a request, and why.

    Attributes:
        what: `allowed`, `hand over` (put the token into a cookie and leave it out of the address) or `refused`.
        reason: of a refusal.
    """

    what: str
    reason: str = ""


class Gate:
    """Judges requests.

    Args:
        address: that the server listens on.
        port: of it.
        token: "" for none.
    """

    def __init__(self, address: str, port: int, token: str) -> None:
        self._loopback = is_loopback(address)
        self._token = token
        self.cookie = f"nw_gear_dashboard_{port}"

    def judge(self, headers: Mapping[str, str], query_token: str, cookie_token: str) -> Verdict:
        """Judge a request.

        Args:
            headers: of the request, with the usual capitals.
            query_token: from the address line, "" for none.
            cookie_token: from the cookie, "" for none.
        """
        host = headers.get("Host", "")
        if self._loopback and not is_loopback(_name(host)):
            return Verdict(REFUSED, "this page answers to localhost alone")
        origin = headers.get("Origin", "")
        if origin and urlsplit(origin).netloc != host:
            return Verdict(REFUSED, "asked for by another page")
        if not self._token:
            return Verdict(ALLOWED)
        bearer = headers.get("Authorization", "").removeprefix("Bearer ")
        if self._same(cookie_token) or self._same(bearer):
            return Verdict(ALLOWED)
        if self._same(query_token):
            return Verdict(HAND_OVER)
        return Verdict(REFUSED, "the token is missing or wrong: open http://ADDRESS:PORT/?token=TOKEN")

    def _same(self, given: str) -> bool:
        return bool(given) and hmac.compare_digest(given.encode(), self._token.encode())


def _name(host: str) -> str:
    """Name or address in the header `Host`, without the port."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""
