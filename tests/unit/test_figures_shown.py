"""docs/figures: every picture stands on a page, and every page's pictures are there."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"


def test_every_picture_is_shown_and_there():
    shown = {
        name
        for page in DOCS.glob("*.md")
        for name in re.findall(r"\]\(figures/([^)]+)\)", page.read_text("utf-8"))
    }
    assert {path.name for path in (DOCS / "figures").iterdir()} == shown
