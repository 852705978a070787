"""docs/zd065.md: its commands are run, and print what it shows."""

from page_commands import ROOT, run_page

#: What processes a figure literally is refused by the judge.
REFUSED = (
    "wedmcam verify tooth.zdr --copies 23 --angle 15 --open-loop --against samples/gear.wed "
    "--cuts 2"
)


def test_the_commands_of_the_page_print_what_it_shows(tmp_path):
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    run_page("docs/zd065.md", tmp_path, 20, {REFUSED: 3})
