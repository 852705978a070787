"""wedmcam.toml: where it is looked for, what wins, and what is said when it is wrong."""

import json
import shutil
from pathlib import Path

import pytest
from test_cli import wedmcam

import parts
from wedmcam.cli import main, settings
from wedmcam.cli.commands.config import config_command

COLUMNS = Path(main.__file__).parents[1] / "machines" / "b3-columns.toml"
SQUARE = parts.dxf_bytes((parts.rectangle(20_000, 10_000),))


@pytest.fixture
def shop(tmp_path):
    (tmp_path / "jobs" / "inner").mkdir(parents=True)
    (tmp_path / "user" / "wedmcam").mkdir(parents=True)
    for place in ("jobs", "jobs/inner"):
        (tmp_path / place / "part.dxf").write_bytes(SQUARE)
    return tmp_path


def put(shop, folder, *lines):
    (shop / folder / settings.NAME).write_text("\n".join(lines) + "\n", "utf-8")


def config(shop, *line, input_="jobs/inner/part.dxf"):
    done = wedmcam("config", input_, "--json", *line, cwd=shop, env=user(shop))
    assert done.returncode == 0, done.stderr.decode()
    return json.loads(done.stdout)


def user(shop):
    return {"XDG_CONFIG_HOME": str(shop / "user")}


def compiled(shop, *line, input_="jobs/inner/part.dxf", output="x.3b"):
    done = wedmcam("compile", input_, "-o", output, "--json", *line, cwd=shop, env=user(shop))
    assert done.returncode == 0, done.stderr.decode()
    return json.loads(done.stdout)


def test_nearer_files_win_and_typed_options_win_over_all(shop):
    put(shop, "user/wedmcam", 'lead = "2mm"', "overcut = 0.5", 'join = "20um"')
    put(shop, "jobs", "# the shop", "wire = 0.18", 'gap = "10um"', "lead = 3")
    put(shop, "jobs/inner", "lead = 4")
    told = config(shop, "--join", "5um")
    assert told["files"] == [
        f"{folder}/wedmcam.toml" for folder in ("jobs/inner", "jobs", "user/wedmcam")
    ]
    got = told["settings"]
    assert got["lead"] == {
        "value": 4,
        "from": "file",
        "file": "jobs/inner/wedmcam.toml",
        "line": 1,
    }
    assert got["wire"] == {
        "value": 0.18,
        "from": "file",
        "file": "jobs/wedmcam.toml",
        "line": 2,
    }
    assert got["overcut"]["file"] == "user/wedmcam/wedmcam.toml"
    assert got["join"] == {"value": "0.005mm", "from": "option"}
    assert got["convex"] == {"value": "arc", "from": "default"}
    assert compiled(shop)["offset_um"] == 100
    assert compiled(shop)["options"]["lead_um"] == 4000
    assert compiled(shop, "--lead", "1.5")["options"]["lead_um"] == 1500
    assert "lead_um" not in compiled(shop, "--no-config")["options"]


def test_offset_and_wire_with_gap_do_not_meet_across_levels(shop):
    put(shop, "jobs", "wire = 0.18", 'gap = "10um"')
    assert compiled(shop, "--offset", "0.2")["offset_um"] == 200
    assert compiled(shop, "--wire", "0.28")["offset_um"] == 150
    put(shop, "jobs/inner", "offset = 0.3")
    assert compiled(shop)["offset_um"] == 300
    assert {a["key"] for a in config(shop)["aside"]} == {"wire", "gap"}
    assert compiled(shop, "--side", "on")["offset_um"] == 0
    put(shop, "jobs/inner", 'side = "on"')
    assert compiled(shop)["side"] == "on"
    assert compiled(shop, "--offset", "0.1")["side"] == "part"


def test_the_certificate_repeats_what_was_in_force(shop):
    shutil.copy(COLUMNS, shop / "jobs" / "mine.toml")
    put(shop, "jobs", "offset = 0.1", "corner = 0.5", 'profile = "mine.toml"')
    made = compiled(shop, "--certificate", "c.json")
    assert made["options"]["corner_um"] == 500
    assert made["profile"] == "mine"
    put(shop, "jobs", "offset = 0.2")
    (shop / "jobs" / "mine.toml").unlink()
    done = wedmcam("verify", "x.3b", "--certificate", "c.json", cwd=shop, env=user(shop))
    assert done.returncode == 0, done.stderr.decode()


def test_a_profile_of_another_format_is_left_aside(shop):
    put(shop, "jobs", "offset = 0.1", 'profile = "b3-columns"')
    assert compiled(shop)["profile"] == "b3-columns"
    assert compiled(shop, output="x.zd")["profile"] == "zd065"
    assert compiled(shop, "--to", "compact", output="-x")["profile"] == "zd065"
    for name in ("x.zd", "x.3b"):
        line = ("verify", name, "--against", "jobs/part.dxf")
        done = wedmcam(*line, cwd=shop, env=user(shop))
        assert done.returncode == 0, done.stderr.decode()
    put(shop, "jobs", "offset = 0.1", 'to = "compact"')
    assert compiled(shop, output="y.zdx")["format"] == "compact"
    assert compiled(shop)["format"] == "3b"


def test_units_of_a_shop_are_weaker_than_those_of_a_drawing(shop):
    put(shop, "jobs", 'units = "um"', "offset = 0.1")
    assert compiled(shop)["units"] == "mm"
    (shop / "jobs" / "none.dxf").write_bytes(
        parts.dxf_bytes((parts.rectangle(20_000, 10_000),), units=0)
    )
    assert compiled(shop, input_="jobs/none.dxf")["units"] == "um"


def test_standard_input_is_of_this_folder(shop):
    put(shop, ".", "offset = 0.1")
    done = wedmcam("check", "-", "--json", cwd=shop, stdin=SQUARE, env=user(shop))
    assert json.loads(done.stdout)["offset_um"] == 100
    done = wedmcam("check", "-", "--json", cwd=shop / "user", stdin=SQUARE, env=user(shop))
    assert json.loads(done.stdout)["offset_um"] == 100


def test_batch_takes_each_item_from_its_own_folder(shop):
    put(shop, "jobs", "offset = 0.1")
    put(shop, "jobs/inner", 'profile = "zd065"', "wire = 0.2", "gap = 0.1")
    (shop / "jobs" / "wrong").mkdir()
    (shop / "jobs" / "wrong" / "part.dxf").write_bytes(SQUARE)
    put(shop, "jobs/wrong", "ofset = 0.1")
    done = wedmcam("batch", "jobs", "-o", "out", "--json", cwd=shop, env=user(shop))
    assert done.returncode == 2, done.stderr.decode()
    assert "jobs/wrong/wedmcam.toml:1:1: error[settings-key]" in done.stderr.decode()
    records = {r["input"]: r for r in map(json.loads, done.stdout.splitlines())}
    assert records["jobs/part.dxf"]["offset_um"] == 100
    assert records["jobs/inner/part.dxf"]["offset_um"] == 200
    assert records["jobs/inner/part.dxf"]["output"] == "out/inner/part.zd"
    assert records["jobs/wrong/part.dxf"]["status"] == 2
    assert (shop / "out/inner/part.zd").exists()


WRONG = [
    ("ofset = 0.1", "1:1", "did you mean 'offset'?", "^~~~~"),
    ("a = [\n 1,\n]", "1:1", "wedmcam config", "^"),
    ('side = "prat"', "1:8", "did you mean 'part'?", "^~~~~~"),
    ('gap = "1 furlong"  # long', "1:7", "is no length", "^~~~~~~~~~~"),
    ("\toffset = true", "1:11", "takes a length", "^~~~"),
    ("offset = nan", "1:10", "is no length", "^~~"),
    ("reverse = 1", "1:11", "takes true or false", "^"),
    ('jobs = "2"', "1:8", "takes a whole number", "^~~"),
    ("start = [[1, 2], 3]", "1:9", "takes a point", "^"),
    ('profile = "b3-colums"', "1:11", "b3-columns", "^"),
    ('profile = "gone.toml"', "1:11", "there is no file", "^"),
    ('to = "3c"', "1:6", "takes 3b", "^"),
    ('certificate = "c.json"', "1:1", "file of one run", "^~~~~~~~~~~"),
    ("[compile]\noffset = 0.1", "1:1", "without sections", "^~~~~~~~~"),
    ("offset = 0.1\noffset = 0.2", "2:", "settings-syntax", "^"),
    ("offset = ", "1:", "settings-syntax", "^"),
    ('layer = ["中", 3]', "1:9", "takes text", "^~~~~~~~~"),
    ("# one\nwire = 0.18\noffset = 0.1", "3:10", "not both", "^~~"),
    ("corner = 0.05\noffset = 0.1", "1:10", "below the offset", "^~~~"),
    ("\n\noffset = -1", "3:10", "takes 0 to 100 m", "^~"),
]


@pytest.mark.parametrize(("text", "place", "said", "mark"), WRONG)
def test_what_is_wrong_is_said_with_line_and_caret(shop, text, place, said, mark):
    put(shop, "jobs", text)
    line = ("compile", "jobs/part.dxf", "-o", "x.3b")
    done = wedmcam(*line, cwd=shop, env=user(shop))
    heard = done.stderr.decode()
    assert done.returncode == 2, heard
    assert heard.startswith(f"jobs/wedmcam.toml:{place}")
    assert said in heard
    assert any(line.lstrip(" |\t").startswith(mark) for line in heard.splitlines()[1:])
    assert not (shop / "x.3b").exists()


def test_all_that_is_wrong_is_said_at_once(shop):
    put(shop, "jobs", "ofset = 1", "lead = true", 'side = "x"')
    put(shop, "user/wedmcam", "wier = 1")
    done = wedmcam("check", "jobs/part.dxf", cwd=shop, env=user(shop))
    assert done.stderr.decode().count("error[settings-") == 4


def test_every_option_that_names_no_file_can_stand_there():
    known = settings.known_options(main.cli)
    assert {"offset", "wire", "gap", "profile", "jobs", "strict", "arithmetic"} <= set(known)
    never = {key for key, option in known.items() if settings.of_one_run(option)}
    assert {"output", "certificate", "plot", "against"} <= never
    shown = {settings.key_of(p) for p in config_command.params}
    assert set(known) - never <= shown


def test_a_folder_is_its_own_folder(shop):
    put(shop, "jobs/inner", "lead = 4")
    assert config(shop, input_="jobs/inner")["settings"]["lead"]["value"] == 4


def mirrored(folder):
    """A 3B profile of a machine whose x runs the other way."""
    text = (COLUMNS.parent / "b3-compact.toml").read_text("utf-8")
    (folder / "turned.toml").write_text(text + "\n[axes]\nmirror_x = true\n", "utf-8")


def said(shop, *line, status=0):
    done = wedmcam(*line, cwd=shop / "jobs", env=user(shop))
    assert done.returncode == status, done.stderr.decode()
    return done.stdout.decode() + done.stderr.decode()


def test_commands_that_read_programs_take_the_profile_of_the_shop(shop):
    mirrored(shop / "jobs")
    put(shop, "jobs", "offset = 0.1", 'profile = "turned.toml"')
    said(shop, "compile", "part.dxf", "-o", "x.3b")
    line = ("convert", "x.3b", "-o", "x.nc", "--profile", "iso-um")
    assert "read as turned" in said(shop, *line)
    said(shop, "verify", "x.nc", "--against", "part.dxf", status=1)
    put(shop, "jobs", "offset = 0.1", 'profile = "turned.toml"', 'profile-in = "iso-um"')
    said(shop, "verify", "x.nc", "--against", "part.dxf")
    assert said(shop, "diff", "x.3b", "x.nc", "--json").count("true") == 1
    assert "mirror" in said(shop, "dump", "x.3b")
    assert said(shop, "explain", "x.3b", "--block", "2", "--no-config") != said(
        shop, "explain", "x.3b", "--block", "2"
    )
    # Of the output, where it has its format; what is typed wins.
    assert "(turned)" in said(shop, "convert", "x.nc", "-o", "y.3b")
    assert (shop / "jobs" / "y.3b").read_bytes() == (shop / "jobs" / "x.3b").read_bytes()
    assert "(b3-compact)" in said(shop, "convert", "x.nc", "-o", "z.3b", "--profile", "b3-compact")
    # Nothing of a part: the shop's offset and gap are no business of a program that is there.
    put(shop, "jobs", 'gap = "10um"', "wire = 0.2", 'to = "compact"', 'side = "die"')
    assert "read as" not in said(shop, "convert", "z.3b", "-o", "z.dxf")


def test_commands_that_read_programs_take_the_offsets_of_the_controller(shop):
    said(shop, "compile", "part.dxf", "-o", "x.nc", "--profile", "iso-g41", "--offset", "0.1")
    said(shop, "dump", "x.nc", status=1)
    said(shop, "convert", "x.nc", "-o", "x.3b", status=1)
    put(shop, "jobs", 'd = ["1=0.1mm"]', 'whole-in = "um"')
    said(shop, "dump", "x.nc")
    said(shop, "convert", "x.nc", "-o", "x.3b")
    said(shop, "diff", "x.nc", "x.3b")
    said(shop, "convert", "x.nc", "-o", "y.3b", "--no-config", status=1)


def test_a_bad_file_keeps_nobody_from_an_explanation(shop):
    put(shop, "jobs", "ofset = 0.1")
    assert "settings-key" in said(shop, "explain", "settings-key")
    assert "settings-key" in said(shop, "dump", "x.3b", status=2)


def test_a_profile_of_the_shop_counts_among_several_formats(shop):
    """Once --to 3b,iso left it aside in silence: a machine with mirrored axes got no mirror."""
    mirrored(shop / "jobs")
    put(shop, "jobs", "offset = 0.1", 'profile = "turned.toml"')
    said(shop, "compile", "part.dxf", "-o", "one.3b")
    assert "profile turned" in said(shop, "compile", "part.dxf", "-o", "two", "--to", "3b,iso")
    jobs = shop / "jobs"
    assert (jobs / "two.3b").read_bytes() == (jobs / "one.3b").read_bytes()


def test_settings_without_effect_on_a_part_program_are_not_told_and_typed_options_are(shop):
    text = "contour a { circle center (0, 0) radius 5 }\ncut a outside offset 0.1 start (9, 0)\n"
    (shop / "jobs" / "a.wed").write_text(text)
    put(shop, "jobs", "wire = 0.18", "gap = 0.01", "lead = 2", "stop = 1", 'layer = ["CUT*"]')
    done = wedmcam("check", "jobs/a.wed", cwd=shop, env=user(shop))
    assert done.returncode == 0
    assert b"no effect" not in done.stderr
    for line, word in (
        (("--gap", "0.02"), "--gap has no effect"),
        (("--wire", "0.2", "--gap", "0.02"), "--wire and --gap have no effect"),
        (("--offset", "0.2"), "--offset has no effect"),
        (("--lead", "1mm"), "--lead has no effect"),  # also where it is the usual
    ):
        for command in (("check", "jobs/a.wed"), ("batch", "jobs", "-o", "out")):
            said = wedmcam(*command, *line, cwd=shop, env=user(shop)).stderr.decode()
            assert said.count("has no effect") + said.count("have no effect") == 1, said
            assert word in said
