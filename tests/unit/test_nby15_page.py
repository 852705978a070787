"""docs/nby15.md: its commands run, and print what it shows."""

import shutil

from page_commands import ROOT, run_page

#: Commands that are to fail.
FAILS = {
    "wedmcam verify key.n15 --correct -300": 1,
    "wedmcam verify key.n15 --correct -300 --run-off": 1,
    "wedmcam simulate key.n15 --controller nby15 --fault short@500:300": 1,
    "wedmcam simulate key.n15 --controller nby15 --scale 10": 1,
    "wedmcam simulate key.n15 --controller nby15 --correct -300 --run-off --plot off.svg": 1,
}


def test_the_page_is_true(tmp_path):
    shutil.copytree(ROOT / "samples", tmp_path / "samples")
    run_page("docs/nby15.md", tmp_path, 13, FAILS)
