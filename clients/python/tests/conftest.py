from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from orogeny import Client, Terrain

from .fake_service import FakeService

# How long an example takes says more of the machine than of the code.
settings.register_profile("orogeny", deadline=None)
settings.load_profile("orogeny")


@pytest.fixture
def fake() -> Iterator[FakeService]:
    with FakeService() as service:
        yield service


@pytest.fixture
def service_url() -> str:
    url = os.environ.get("OROGENY_SERVICE_URL")
    if not url:
        pytest.skip("OROGENY_SERVICE_URL names no running service: integration tests are NOT run")
    return url


@pytest.fixture
def service_token() -> str | None:
    return os.environ.get("OROGENY_SERVICE_TOKEN") or None


@pytest.fixture
def terrain(service_url: str, service_token: str | None, request: pytest.FixtureRequest) -> Iterator[Terrain]:
    """The first terrain of the running service, by an author of this test alone; what is left is taken back."""
    with Client(service_url, service_token, f"test {request.node.name}"[:64]) as client:
        yield client.terrain(client.terrains()[0]["name"])
