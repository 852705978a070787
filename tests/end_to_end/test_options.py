"""Every option, setting and key of a profile with values that nobody means: exit 2, or a finding.

A value that is wrong is refused where it is read, by the name of the option or key. No value at all
ends in an internal error.
"""

import datetime
import json
import re

import click
import pytest

import parts
from wedmcam import __main__, api, machines
from wedmcam.cli.main import cli
from wedmcam.cli.settings import known_options, of_one_run
from wedmcam.machines.read import _SCHEMA
from wedmcam.option_table import ROWS, Kind, field_rows
from wedmcam.options import Options, WrongUse

SQUARE = parts.dxf_bytes((parts.rectangle(2_000, 1_000),))
#: What no option takes, or only one of another kind.
WORDS = (
    *("", " ", "0", "-1", "nan", "inf", "-inf", "1e308", "1e-308", "0.0000001", "1e999", "0x10"),
    *(
        "9" * 400,
        "1-",
        "0-0",
        "5-2",
        "-",
        "--",
        "1,2",
        "nan,nan",
        "1e300,0",
        "1=nan",
        "0=0",
        "9=-1",
    ),
    *(
        "\u0661",
        "\u00b2",
        "\udcff",
        "\x00",
        "a\x1b[31m",
        "\u202e",
        "x" * 5000,
        "[",
        "*",
        "[!",
        "💥",
    ),
    *(
        "mm",
        "um",
        "part",
        "die",
        "left",
        "on",
        "10um",
        "/",
        ".",
        "no.toml",
        "/dev/null",
        "1" * 5000,
    ),
)
#: The same as values of TOML.
VALUES = (
    *(
        0,
        -1,
        1,
        10**30,
        1.5,
        float("nan"),
        float("inf"),
        1e308,
        True,
        False,
        "",
        "x",
        "\x00",
        "1e999",
    ),
    *(
        [],
        [1],
        [[1]],
        ["a"],
        {},
        {"a": 1},
        datetime.date(2020, 1, 1),
        [float("nan")] * 2,
        "9" * 500,
    ),
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "part.dxf").write_bytes(SQUARE)
    made = api.compile(SQUARE, offset=0.1)
    (tmp_path / "part.3b").write_bytes(made.data)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "none"))
    return tmp_path


def run(capfd, *line):
    """Run a line in this process; return its exit status and what was said."""
    try:
        status = cli.main(list(line), prog_name="wedmcam", standalone_mode=False)
    except (Exception, SystemExit) as why:
        status = __main__._status(why)
    said = capfd.readouterr()
    return (status if isinstance(status, int) else 0), said.out, said.err


LINES = {
    "compile": ("compile", "part.dxf", "-o", "x.3b"),
    "inspect": ("inspect", "part.dxf"),
    "verify": ("verify", "part.3b"),
    "convert": ("convert", "part.3b", "-o", "x.nc"),
    "diff": ("diff", "part.3b", "part.3b"),
    "dump": ("dump", "part.3b"),
    "explain": ("explain", "part.3b"),
}
OPTIONS = sorted(
    {
        (command, option.opts[0])
        for command in LINES
        for option in cli.get_command(click.Context(cli), command).params
        if isinstance(option, click.Option) and not option.is_flag and option.opts[0] != "-o"
    }
)


@pytest.mark.parametrize(("command", "option"), OPTIONS)
def test_no_value_of_an_option_is_an_internal_error(folder, capfd, command, option):
    # An offset makes a corner, a side and a path; what both give is wrong use, and that is fine.
    for word in WORDS:
        if "\x00" in word:  # no command line holds it
            continue
        status, out, err = run(capfd, *LINES[command], option, word)
        assert status in (0, 1, 2, 3), (word, err)
        assert "internal" not in err, (word, err)
        assert not re.search("[\x00-\x08\x0b-\x1f\x7f\u202e\ud800-\udfff]", out + err), word
        assert len(err) < 20_000, word


@pytest.mark.parametrize(
    ("option", "word", "takes"),
    [
        ("--tolerance", "0", "0.000001 um to 10 mm"),
        ("--tolerance", "-1", "0.000001 um to 10 mm"),
        ("--join", "-0.1", "0 to 100 m"),
        ("--offset", "-0.1", "0 to 100 m"),
        ("--stop", "0.5um", "0, or 0.001 mm"),
        ("--lead", "101 m", "no length"),
        ("--feed", "0", "0.001 um to"),
        ("--cuts", "0-3", "2-5"),
    ],
)
def test_field_a_wrong_value_names_its_option_and_what_it_takes(folder, capfd, option, word, takes):
    status, _, err = run(capfd, *LINES["compile"], option, word)
    assert status == 2
    assert option in err
    assert takes in err


@pytest.mark.parametrize(
    "field", sorted(row.name for row in field_rows() if row.kind is Kind.LENGTH)
)
@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf"), 1e300, "1", True, [1], {}])
def test_the_library_refuses_the_same_values(field, value):
    with pytest.raises(WrongUse, match=f"--{field[:-3].replace('_', '-')} takes"):
        Options.of(**{field: value})


@pytest.mark.parametrize("value", VALUES, ids=str)
def test_options_of_a_certificate_may_be_anything(value):
    for field in ROWS:
        try:
            Options.from_data({field: value})
        except WrongUse:
            continue


KEYS = sorted(k for k, option in known_options(cli).items() if not of_one_run(option))


def test_field_cuts_of_a_settings_file(folder, capfd):
    (folder / "wedmcam.toml").write_text('cuts = "1-1"\noffset = 0.1\n')
    status, _, err = run(capfd, "check", "part.dxf")
    assert status == 0
    assert "contours   1 cut" in err


@pytest.mark.parametrize("key", KEYS)
def test_no_value_of_a_setting_is_an_internal_error(folder, capfd, key):
    for value in VALUES:
        (folder / "wedmcam.toml").write_text(f"{key} = {toml(value)}\n", encoding="utf-8")
        status, _, err = run(capfd, "check", "part.dxf")
        assert status in (0, 1, 2, 3), (value, err)
        assert "internal" not in err, (value, err)
        if status == 2:
            assert re.search(rf"--{key}|'{key}'", err) or "--" in err or "block" in err, (
                value,
                err,
            )


@pytest.mark.parametrize(
    "data",
    [
        b"\xff\xfe",
        b"\x00" * 100,
        b"a = " + b"[" * 20_000,
        b"a = " + b"9" * 20_000,
        b'"\\u0000" = 1',
        b"offset = 0.1\noffset = 0.2",
        b"[[offset]]",
        b"a.b.c = 1",
        b"\xef\xbb\xbfoffset = 0.1",
        b"#" * 2_000_000,
    ],
    ids=lambda data: repr(data[:12]),
)
def test_settings_and_profiles_may_be_any_bytes(folder, capfd, data):
    for name, line in (
        ("wedmcam.toml", ("check", "part.dxf")),
        ("p.toml", ("check", "part.dxf", "--profile", "p.toml")),
        ("p.toml", ("profile", "check", "p.toml")),
        ("p.toml", ("verify", "part.3b", "--certificate", "p.toml")),
        ("p.toml", ("profile", "probe", "--read", "p.toml")),
    ):
        (folder / "wedmcam.toml").unlink(missing_ok=True)
        (folder / name).write_bytes(data)
        status, _, err = run(capfd, *line)
        assert status in (1, 2), (line, err)
        assert "internal" not in err, (line, err)
        assert len(err) < 20_000
        assert name in err


def test_folders_in_the_place_of_files(folder, capfd):
    for line in (
        ("check", "part.dxf", "--profile", "d.toml"),
        ("compile", "d.dxf", "-o", "x.3b"),
        ("verify", "part.3b", "--against", "d.dxf"),
        ("verify", "part.3b", "--certificate", "d.dxf"),
        ("profile", "check", "d.toml"),
        ("diff", "part.3b", "d.3b"),
        ("identify", "d.3b"),
        ("plot", "part.dxf", "-o", "d.svg"),
    ):
        for name in ("d.toml", "d.dxf", "d.3b", "d.svg"):
            (folder / name).mkdir(exist_ok=True)
        status, _, err = run(capfd, *line)
        assert status in (1, 2), (line, err)
        assert "internal" not in err, (line, err)
    (folder / "wedmcam.toml").mkdir()
    status, _, err = run(capfd, "check", "part.dxf", "--offset", "0.1")
    assert status == 0, err


def toml(value):
    """Return a value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {toml(v)}" for k, v in value.items()) + "}"
    return json.dumps(value) if isinstance(value, str) else str(value)


def profile(section, key, value):
    """Return the built-in 3B or ISO profile with one value set, as TOML."""
    name = "iso-mm" if section == "iso" else "b3-compact"
    lines = [line for line in machines.text(name).splitlines() if not line.startswith("#")]
    lines = [line for line in lines if not re.match(rf"{key}\s*=", line)]
    said = f"{key} = {toml(value)}"
    if not section:
        return "\n".join([said, *lines])
    head = f"[{section}]"
    if any(line.startswith(head) for line in lines):
        return "\n".join(f"{head}\n{said}" if line.startswith(head) else line for line in lines)
    return "\n".join([*lines, head, said])


@pytest.mark.parametrize(("section", "key"), [(s, k) for s in _SCHEMA for k in _SCHEMA[s]], ids=str)
def test_no_value_of_a_profile_is_an_internal_error(section, key):
    for value in (*VALUES, 2, 5, 9, 99, 1000, 10**6, "B", "D", " ", "\t", "utf-8", "gbk", [10, 10]):
        machine, found = machines.parse(profile(section, key, value), "p.toml")
        assert (machine is None) == bool(found)
        if machine is None:
            continue
        made = api.compile(SQUARE, profile=machine, offset=0.1)
        assert made.ok or made.findings, value


def test_field_a_profile_whose_limits_hold_nothing(folder, capfd):
    (folder / "p.toml").write_text(profile("limits", "count_um", 1))
    status, _, err = run(capfd, "check", "part.dxf", "--offset", "0.1", "--profile", "p.toml")
    assert status == 2
    assert "'limits.count_um' takes a whole number, 1000 to 999999, not 1" in err
