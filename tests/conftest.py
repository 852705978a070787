"""Shared by all tests: helpers beside this file can be imported; settings of hypothesis."""

import os

import pytest
from hypothesis import HealthCheck, settings

from wedmcam.diag import finding

#: The same examples in every run: a change is judged by what it changed, not by luck. `make hunt`
#: looks for new ones; what it finds becomes an @example.
settings.register_profile(
    "wedmcam",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    print_blob=True,
    derandomize=True,
    max_examples=50,
)
settings.register_profile(
    "hunt", settings.get_profile("wedmcam"), derandomize=False, max_examples=200
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "wedmcam"))

finding.CHECKS = True  # values that do not fit a template are faults here


def pytest_addoption(parser):
    parser.addoption(
        "--update-golden",
        action="store_true",
        help="write the golden files anew; then look at git diff",
    )


@pytest.fixture(autouse=True, scope="session")
def _nobodys_settings(tmp_path_factory):
    """Keep the settings of whoever runs the tests out of them."""
    os.environ["XDG_CONFIG_HOME"] = str(tmp_path_factory.mktemp("configuration"))


@pytest.fixture
def update_golden(request):
    return request.config.getoption("--update-golden")


@pytest.fixture(scope="session")
def corpus():
    """Folder of real drawings, or skip: they are not part of the project."""
    folder = os.environ.get("WEDMCAM_CORPUS")
    if not folder or not os.path.isdir(folder):
        pytest.skip("WEDMCAM_CORPUS names no folder of real drawings")
    return folder
