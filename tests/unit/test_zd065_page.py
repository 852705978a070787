"""docs/zd065.md: its commands are run, and print what it shows."""

import re

from page_commands import ROOT, run_page

PAGE = (ROOT / "docs" / "zd065.md").read_text("utf-8")

#: What processes a figure literally is refused by the judge.
REFUSED = (
    "wedmcam verify tooth.zdr --copies 23 --angle 15 --open-loop --against samples/gear.wed "
    "--cuts 2"
)


def test_the_commands_of_the_page_print_what_it_shows(tmp_path):
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    scenario = re.search(r"^```toml\n(.*?)^```$", PAGE, re.S | re.M)
    (tmp_path / "day.toml").write_text(scenario[1], "utf-8")
    run_page("docs/zd065.md", tmp_path, 40, {REFUSED: 3, "wedmcam simulate key.zd": 1})
