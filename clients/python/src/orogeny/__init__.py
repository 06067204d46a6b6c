"""Reads and brushes terrains of an Orogeny service.

Lengths are metres; x goes to the east, z to the south, from the terrain's north-west corner. Arrays are float32,
indexed `[z, x]`, row 0 in the north.
"""

from .aio import AsyncClient, AsyncTerrain
from .client import Client, Terrain
from .errors import AnswerError, ConnectionLost, FrameError, OrogenyError, OrogenyException, StrokeCut
from .events import Events
from .frames import PageFrame
from .grid import Grid, Region, Samples
from .heights import Heights
from .live import Live, LiveStroke
from .live_thread import LiveThread, ThreadMirror, ThreadStroke
from .mirror import Mirror
from .results import Change, Hello
from .subscription import LiveMirror, Subscription

__all__ = [
    "AnswerError",
    "AsyncClient",
    "AsyncTerrain",
    "Change",
    "Client",
    "ConnectionLost",
    "Events",
    "FrameError",
    "Grid",
    "Heights",
    "Hello",
    "Live",
    "LiveMirror",
    "LiveStroke",
    "LiveThread",
    "Mirror",
    "OrogenyError",
    "OrogenyException",
    "PageFrame",
    "Region",
    "Samples",
    "StrokeCut",
    "Subscription",
    "Terrain",
    "ThreadMirror",
    "ThreadStroke",
]
__version__ = "0.1.0"
