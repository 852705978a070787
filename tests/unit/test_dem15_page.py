"""docs/dem15.md: its commands are run, and its tables are measured."""

import vector_errors
from page_commands import ROOT, run_page

REFUSED = {
    "wedmcam simulate key.d15 --controller dem15 --resume key.state --fault limit@9000": 1,
    "wedmcam check samples/plate.dxf --offset 0.1 --to dem15": 1,
    "printf 'UM\\n0 0 400 0 255 150 64\\nE\\n' > current.d15; wedmcam dump current.d15": 1,
    "wedmcam convert key.3b -o other.d15": 1,
}


def test_the_commands_of_the_page_print_what_it_shows(tmp_path):
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    run_page("docs/dem15.md", tmp_path, 9, REFUSED)


def test_the_tables_of_the_page_are_what_is_measured():
    page = (ROOT / "docs" / "dem15.md").read_text("utf-8").splitlines()
    for line in [*vector_errors.directions(), *vector_errors.rows()]:
        assert line in page
