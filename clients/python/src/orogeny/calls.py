"""The HTTP calls of the service, apart from how they are sent: each is a request, and how to read its answer."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar
from urllib.parse import quote, urlencode, urlsplit

import numpy.typing as npt

from . import operations
from .errors import AnswerError, OrogenyError
from .grid import Region, RegionLike
from .heights import Heights, heights_from_r32, heights_to_r32
from .operations import LayerName, Operation
from .results import Change

T = TypeVar("T")


@dataclass(frozen=True)
class Answer:
    """What came back: `headers` have lower-case names."""

    status: int
    headers: Mapping[str, str]
    body: bytes


@dataclass(frozen=True)
class Call(Generic[T]):
    """A request, and how its answer is read; `path` holds the query."""

    method: str
    path: str
    read: Callable[[Answer], T]
    body: bytes | None = None
    headers: Mapping[str, str] = field(default_factory=dict)

    def result(self, answer: Answer) -> T:
        """Read the answer; raises `OrogenyError` where the service refused."""
        if not 200 <= answer.status < 300:
            raise refusal(answer)
        return self.read(answer)


def check_url(url: str) -> str:
    """Check the service's address, and take the slash from its end."""
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError(f"`{url}` is no address of a service: http://HOST:PORT or https://HOST")
    if parts.username is not None or parts.password is not None or parts.query or parts.fragment:
        raise ValueError("a token does not belong into the address, which ends up in logs: give it as `token`")
    return url.rstrip("/")


def live_url(url: str, terrain: str, author: str | None) -> str:
    """The address of a terrain's live channel."""
    checked = check_url(url)
    query = "?" + urlencode({"author": author}) if author is not None else ""
    return f"ws{checked[len('http') :]}/v1/terrains/{quote(terrain, safe='')}/live{query}"


def authorization(token: str | None) -> dict[str, str]:
    """The header that a token is sent in."""
    if token is None:
        return {}
    if not token or not token.isascii() or not token.isprintable() or " " in token:
        raise ValueError("a token is printable ASCII without spaces")
    return {"authorization": f"Bearer {token}"}


def refusal(answer: Answer) -> OrogenyError | AnswerError:
    """The exception for an answer that is no success."""
    try:
        error = json.loads(answer.body)["error"]
        return OrogenyError(str(error["code"]), str(error["message"]), error.get("limit"), answer.status)
    except (ValueError, KeyError, TypeError, AttributeError):
        text = answer.body[:200].decode("utf-8", "replace")
        return AnswerError(f"status {answer.status} with what is no error of the service: {text!r}")


def terrains() -> Call[list[dict[str, Any]]]:
    """Which terrains there are."""
    return Call("GET", "/v1/terrains", _list_under("terrains"))


def brushes() -> Call[list[dict[str, Any]]]:
    """Every brush as a JSON Schema."""
    return Call("GET", "/v1/brushes", _list_under("brushes"))


class TerrainCalls:
    """The calls of one terrain by one author."""

    def __init__(self, name: str, author: str | None) -> None:
        self.name = name
        self._path = f"/v1/terrains/{quote(name, safe='')}"
        self._author = {} if author is None else {"author": author}

    def info(self) -> Call[dict[str, Any]]:
        """Size, layers, place in the history."""
        return Call("GET", self._path, _read_object)

    def read_heights(self, region: RegionLike | None, level: int, layer: LayerName | None) -> Call[Heights]:
        """Heights of a region."""
        query: dict[str, Any] = {"format": "r32", "level": level}
        if region is not None:
            place = Region.of(region)
            query |= {"x": place.x, "z": place.z, "width": place.width, "depth": place.depth}
        if layer is not None:
            query["layer"] = layer
        return Call("GET", self._with("heights", query), lambda answer: heights_from_r32(answer.headers, answer.body))

    def write_heights(self, array: npt.ArrayLike, x_m: float, z_m: float, layer: LayerName | None) -> Call[Change]:
        """Write heights onto a layer."""
        body, width, depth = heights_to_r32(array)
        query: dict[str, Any] = {"format": "r32", "x": float(x_m), "z": float(z_m), "width": width, "depth": depth}
        if layer is not None:
            query["layer"] = layer
        path = self._with("heights", query | self._author)
        return Call("PUT", path, _read_change, body, {"content-type": "application/octet-stream"})

    def apply(self, todo: Iterable[Operation]) -> Call[Change]:
        """Run operations, all or none."""
        return self._post("operations", {"operations": list(todo)})

    def undo(self, count: int, anyone: bool) -> Call[Change]:
        """Take back what was done last."""
        return self._post("undo", _which(count, anyone))

    def redo(self, count: int, anyone: bool) -> Call[Change]:
        """Do again what was taken back last."""
        return self._post("redo", _which(count, anyone))

    def history(self, before: int | None, limit: int | None) -> Call[list[dict[str, Any]]]:
        """What was done, newest first."""
        query = {name: value for name, value in (("before", before), ("limit", limit)) if value is not None}
        return Call("GET", self._with("history", query), _list_under("entries"))

    def _with(self, what: str, query: Mapping[str, Any]) -> str:
        return f"{self._path}/{what}?{urlencode(query)}" if query else f"{self._path}/{what}"

    def _post(self, what: str, value: Mapping[str, Any]) -> Call[Change]:
        body = operations.to_json({**value, **self._author}).encode()
        return Call("POST", f"{self._path}/{what}", _read_change, body, {"content-type": "application/json"})


def _which(count: int, anyone: bool) -> dict[str, Any]:
    if count < 1:
        raise ValueError(f"a count is 1 or more, not {count}")
    return {"count": count, **({"anyone": True} if anyone else {})}


def _read_json(answer: Answer) -> Any:
    try:
        return json.loads(answer.body)
    except ValueError as error:
        raise AnswerError(f"an answer that is no JSON: {answer.body[:200]!r}") from error


def _read_object(answer: Answer) -> dict[str, Any]:
    value = _read_json(answer)
    if not isinstance(value, dict):
        raise AnswerError(f"an answer that is no object: {answer.body[:200]!r}")
    return value


def _read_change(answer: Answer) -> Change:
    return Change.parse(_read_object(answer))


def _list_under(name: str) -> Callable[[Answer], list[dict[str, Any]]]:
    """Read a list of objects out of `{name: [...]}`."""

    def read(answer: Answer) -> list[dict[str, Any]]:
        value = _read_object(answer).get(name)
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise AnswerError(f"an answer without a list `{name}` of objects: {answer.body[:200]!r}")
        return value

    return read
