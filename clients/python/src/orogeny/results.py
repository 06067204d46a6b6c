"""What the service answers with, as small typed objects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .errors import AnswerError
from .grid import Grid, Region


@dataclass(frozen=True)
class Change:
    """Something that was done and is on disk.

    `revision` counts changes since the service started. `entries` are the numbers of new entries in its history; an
    undo or redo makes none. `rect` is where it changed: empty, nowhere, as by an undo of nothing; `None`, perhaps
    everywhere.
    """

    revision: int
    entries: tuple[int, ...]
    rect: Region | None

    @classmethod
    def parse(cls, value: Mapping[str, Any]) -> Change:
        """Read what the service wrote."""
        try:
            rect = value.get("rect")
            entries = tuple(int(entry) for entry in value.get("entries") or ())
            return cls(int(value["revision"]), entries, _region(rect))
        except (KeyError, TypeError, ValueError) as error:
            raise AnswerError(f"what was done cannot be read: {error!r} in {value!r}") from error

    def then(self, later: Change) -> Change:
        """This change and a later one as one."""
        rect = self.rect.union(later.rect) if self.rect is not None and later.rect is not None else None
        return Change(later.revision, self.entries + later.entries, rect)


@dataclass(frozen=True)
class Hello:
    """What a live channel begins with.

    `width` and `depth` are samples at full resolution, `levels` how many coarser levels there are, `lowest_m` and
    `highest_m` heights.
    """

    client: int
    author: str
    terrain: str
    revision: int
    width: int
    depth: int
    spacing_m: float
    page_size: int
    levels: int
    lowest_m: float
    highest_m: float

    @classmethod
    def parse(cls, event: Mapping[str, Any]) -> Hello:
        """Read the event `hello`."""
        try:
            return cls(
                client=int(event["client"]),
                author=str(event["author"]),
                terrain=str(event["terrain"]),
                revision=int(event["revision"]),
                width=int(event["width"]),
                depth=int(event["depth"]),
                spacing_m=float(event["spacing"]),
                page_size=int(event["page_size"]),
                levels=int(event["levels"]),
                lowest_m=float(event["lowest"]),
                highest_m=float(event["highest"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise AnswerError(f"the event `hello` cannot be read: {error!r} in {event!r}") from error

    @property
    def grid(self) -> Grid:
        """The samples of the terrain."""
        return Grid(self.width, self.depth, self.spacing_m)


def _region(rect: Any) -> Region | None:
    if rect is None:
        return None
    x, z, width, depth = (float(value) for value in rect)
    return Region(x, z, width, depth)
