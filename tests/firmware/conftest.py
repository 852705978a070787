"""The cutting program is assembled once a session."""

import pytest
from machine import Machine, assemble


@pytest.fixture(scope="session")
def image(tmp_path_factory):
    return assemble(tmp_path_factory.mktemp("firmware"))


@pytest.fixture
def machine(image):
    return Machine(image)
