"""``wedmcam zd065``: the memory of the machine as a file."""

import json
import random
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import wedmcam
from wedmcam import api
from wedmcam.__main__ import report_stop
from wedmcam.cli.main import cli
from wedmcam.controllers.zd065 import memory
from wedmcam.formats import compact

SAMPLES = Path(__file__).parents[2] / "samples"
KEY = wedmcam.compile(SAMPLES / "key-punch.dxf", to="compact", offset=0.1).data
LINES = bytes.fromhex("01017000005000 02017000005000 31 03000300000400 00")


def run(*words):
    """Return what a command says; its ``exit_code`` is the exit status of ``wedmcam``."""
    done = CliRunner().invoke(cli, ["zd065", *map(str, words)], standalone_mode=False)
    if done.exception is None:
        done.exit_code = done.return_value
    else:
        done.exit_code = report_stop(done.exception)
    assert done.exit_code in (0, 1, 2)
    return done


@pytest.fixture
def image(tmp_path):
    def written(data: bytes, at: int = 0, fill: bool = True) -> Path:
        path = tmp_path / "memory.img"
        whole = bytes(at) + data
        path.write_bytes(whole.ljust(memory.SIZE, b"\0") if fill else whole)
        return path

    return written


# --- display -------------------------------------------------------------------------------------


def test_three_bytes_at_a_time_on_six_digits_with_their_time(image):
    done = run("show", image(LINES), "0", "0x7", "--time", "500ms")
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines() == [
        "0x0000  010170  at 0 s",
        "0x0003  000050  at 0.5 s",
        "0x0006  0002    at 1 s",
    ]
    assert "3 groups of three bytes, 0.5 s each: 1.5 s" in done.stderr


def test_all_of_the_memory_is_shown_at_its_base(image):
    done = run("show", image(LINES), "--base", "$0200", "--json")
    told = json.loads(done.stdout)
    assert len(told["groups"]) == 1366
    assert told["groups"][0]["address"] == 0x200
    assert told["groups"][-1] == {"address": 0x11FF, "digits": "00", "shown_at_s": 1365.0}
    assert b"".join(bytes.fromhex(g["digits"]) for g in told["groups"]) == LINES.ljust(4096, b"\0")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["0x10", "0x0f"], "ends before it begins"),
        (["0x1000"], "outside of the memory, which has 0x0000 to 0x0fff"),
        (["0", "0x1000"], "outside of the memory"),
        (["0100"], "'0100' is no address"),
        (["1F"], "'1F' is no address"),
        (["-1"], ""),
        (["65536"], "no address"),
        (["--time", "0"], "no time"),
        (["--time", "-2s"], "no time"),
        (["--base", "0xf001"], "its base is 0xf000 at most"),
    ],
)
def test_addresses_and_times_that_are_none(image, words, said):
    done = run("show", image(LINES), *words)
    assert done.exit_code == 2
    assert said in str(done.exception)
    assert not done.stdout


# --- recognition ---------------------------------------------------------------------------------


@pytest.mark.parametrize("format_", ["compact", "rotation", "compensation"])
def test_type_number_and_last_address(image, format_):
    more = {"corner": 0.3} if format_ == "compensation" else {}
    made = wedmcam.compile(SAMPLES / "washer.wed", to=format_, offset=0.1, **more)
    if made.data is None:
        pytest.skip(f"no sample in {format_}")
    for at in (0, 0x123):
        done = run("identify", image(made.data, at), "--base", "0x200", "--json")
        told = json.loads(done.stdout)
        assert done.exit_code == 0, done.output
        assert told["format"] == format_
        assert (told["first_address"], told["last_address"]) == (
            0x200 + at,
            0x200 + at + len(made.data) - 1,
        )
        if format_ == "compact":
            program, *_ = api.read_program(made.data, format=format_)
            assert told["blocks"] == len(program.blocks) - 1  # the end byte is none


def test_585_lines_fill_the_memory(image):
    data = LINES[:7] * 585
    done = run("identify", image(data))
    assert done.exit_code == 0
    assert "585 blocks" in done.stdout
    assert "last address 0x0fff" in done.stdout


def test_lines_alone_do_in_two_formats(image):
    assert "same bytes" in run("identify", image(LINES)).stdout
    told = json.loads(run("identify", image(LINES), "--format", "compensation", "--json").stdout)
    assert (told["format"], told["blocks"]) == ("compensation", 4)


def test_random_data_are_recognised_and_left_as_they_are(image):
    rng = random.Random(3)
    for _ in range(20):
        data = bytes(rng.randrange(256) for _ in range(memory.SIZE))
        path = image(data)
        done = run("identify", path, "--json")
        assert done.exit_code == 1
        assert json.loads(done.stdout)["format"] == "random"
        assert path.read_bytes() == data


def test_random_memory_is_cleared_on_request_only(image, tmp_path):
    out = tmp_path / "out.img"
    path = image(b"\xff\x13" * 2048)
    done = run("identify", path, "--clear", "-o", out)
    assert done.exit_code == 0, done.output
    assert out.read_bytes() == bytes(memory.SIZE)
    assert path.read_bytes() == b"\xff\x13" * 2048
    assert run("identify", path, "--clear").exit_code == 2
    assert run("identify", path, "--clear", "-o", path).exit_code == 2


@pytest.mark.parametrize("damaged", [None, 0, 7, 40, 41])
def test_a_program_is_never_cleared(image, tmp_path, damaged):
    data = bytearray(KEY)
    if damaged is not None:
        data[damaged] = 0xFF
    done = run("identify", image(bytes(data)), "--clear", "-o", tmp_path / "out.img")
    assert done.exit_code == 1
    assert "not-random" in done.output
    assert not (tmp_path / "out.img").exists()


def test_a_text_is_no_data_of_the_machine(image):
    done = run("identify", image(b"B9900B0B39600GYNR1\nDD\n", fill=False))
    assert done.exit_code == 1
    assert "3B text" in done.output


@pytest.mark.parametrize("base", [0, 0x200])
@pytest.mark.parametrize("at", range(0, 60))
def test_a_damaged_byte_is_a_finding_with_its_place(image, at, base):
    data = bytearray(KEY)
    data[at] = 0xFF
    done = run("identify", image(bytes(data)), "--base", base, "--json")
    assert done.exit_code == 1
    told = json.loads(done.stdout)
    assert told["format"] == "compact"
    assert told["bad_address"] == base + at
    places = [d["at"]["start"] for d in told["diagnostics"] if d["severity"] == "error"]
    starts = _starts(KEY)
    assert {base + at, base + max(s for s in starts if s <= at)} & set(places)


def _starts(data):
    at, out = 0, []
    while step := compact.LENGTH[data[at]]:
        out.append(at)
        at += step
    return out


def test_blocks_behind_a_damaged_place_can_be_read(image):
    data = bytearray(KEY)
    first, second = _starts(KEY)[3:5]
    data[first] = 0x99
    told = json.loads(run("identify", image(bytes(data)), "--json").stdout)
    again = next(d for d in told["diagnostics"] if d["code"] == "image-damaged")
    assert again["values"]["next"] == second
    rest = run("identify", image(bytes(data)), "--at", hex(second))
    assert rest.exit_code == 0, rest.output


@pytest.mark.parametrize(("size", "severity"), [(0, "error"), (4097, "error"), (24, "note")])
def test_an_image_of_another_size(tmp_path, size, severity):
    path = tmp_path / "a.img"
    path.write_bytes(LINES.ljust(size, b"\0")[:size])
    for words in (["identify"], ["show"], ["find"]):
        done = run(*words, path, *(["1"] if words == ["find"] else []))
        assert f"{severity}[image-size]" in done.output
        assert done.exit_code == (severity == "error")


def test_a_cleared_memory(image):
    done = run("identify", image(b""))
    assert done.exit_code == 1
    assert "cleared: 4096 bytes, all 0" in done.stdout


# --- find ----------------------------------------------------------------------------------------


def test_the_address_of_every_block(image):
    path = image(KEY, 0x10)
    for number, start in enumerate(_starts(KEY), 1):
        found, findings = api.find_block(api.read_memory(path)[0], number)
        assert not findings
        assert found.address == 0x10 + start
        assert found.data == KEY[start : start + len(found.data)]
    done = run("find", path, number + 1)
    assert done.exit_code == 1
    assert f"there is no block {number + 1}: the data have {number}" in done.output


def test_what_find_says(image):
    done = run("find", image(LINES), "3")
    assert done.stdout == "block 3: 0x000e to 0x000e, pause: 31\n"
    told = json.loads(run("find", image(LINES), "4", "--base", "0x100", "--json").stdout)
    assert told["block"]["address"] == 0x10F
    assert told["block"]["instruction"] == "L3"
    assert run("find", image(LINES), "0").exit_code == 2
    assert run("find", image(b"\xff\x13" * 2048), "1").exit_code == 1
    assert run("find", image(b""), "1").exit_code == 1


# --- move ----------------------------------------------------------------------------------------


@given(st.data())
@settings(max_examples=200, deadline=None)
def test_law_of_the_move(data):
    held = data.draw(st.binary(min_size=1, max_size=40))
    first = data.draw(st.integers(0, len(held) - 1))
    last = data.draw(st.integers(first, len(held) - 1))
    count = last + 1 - first
    to = data.draw(st.integers(0, len(held) - count))
    after = memory.moved(held, first, last, to)
    for k, byte in enumerate(after):
        if to <= k < to + count:
            assert byte == held[first + k - to]
        elif first <= k <= last:
            assert byte == 0
        else:
            assert byte == held[k]
    if to != first:
        image = api.read_memory(held)[0]
        move, _ = api.move_memory(image, first, last, to)
        zero = {k for a, b in move.cleared for k in range(a, b + 1)}
        assert zero == set(range(first, last + 1)) - set(range(to, to + count))
        assert move.image.data[: len(held)] == after


def test_move_writes_the_memory_and_says_what_is_where(image, tmp_path):
    path, out = image(LINES), tmp_path / "out.img"
    done = run("move", path, "0", "0x16", "0x800", "-o", out)
    assert done.exit_code == 0, done.output
    assert out.read_bytes() == (bytes(0x800) + LINES).ljust(memory.SIZE, b"\0")
    assert path.read_bytes() == LINES.ljust(memory.SIZE, b"\0")
    assert "cleared  0x0000 to 0x0016" in done.stdout
    assert "4 blocks" in done.stdout
    assert run("move", out, "0x800", "0x816", "0", "--in-place").exit_code == 0
    assert out.read_bytes() == path.read_bytes()


def test_overlapping_ranges(image):
    path = image(LINES)
    done = run("move", path, "0", "22", "7", "--in-place", "--json")
    told = json.loads(done.stdout)
    assert told["cleared"] == [{"from_address": 0, "to_address": 6}]
    assert path.read_bytes()[:30] == bytes(7) + LINES
    done = run("move", path, "7", "29", "0", "--in-place", "--json")
    assert json.loads(done.stdout)["cleared"] == [{"from_address": 23, "to_address": 29}]
    assert path.read_bytes() == LINES.ljust(memory.SIZE, b"\0")


def test_what_is_overwritten_or_parted_is_said(image, tmp_path):
    both = LINES.ljust(0x20, b"\0") + LINES
    out = tmp_path / "out.img"
    done = run("move", image(both), "0", "22", "0x22", "-o", out)
    assert done.exit_code == 0
    assert "memory-overwritten" in done.output
    assert run("move", image(both), "0", "22", "0x22", "-o", out, "--strict").exit_code == 1
    done = run("move", image(LINES), "3", "15", "0x100", "-o", out)
    assert done.output.count("block-parted") == 2


@pytest.mark.parametrize(
    "words",
    [
        ["0", "22", "0x100"],
        ["0", "22", "0xff0", "-o", "OUT"],
        ["22", "0", "0x100", "-o", "OUT"],
        ["0", "4096", "0", "-o", "OUT"],
        ["0", "22", "0x100", "-o", "IMAGE"],
        ["0", "22", "0x100", "-o", "OUT", "--in-place"],
    ],
)
def test_moves_that_are_none(image, tmp_path, words):
    path, out = image(LINES), tmp_path / "out.img"
    known = {"OUT": str(out), "IMAGE": str(path)}
    assert run("move", path, *(known.get(w, w) for w in words)).exit_code == 2
    assert not out.exists()
    assert path.read_bytes() == LINES.ljust(memory.SIZE, b"\0")


@given(st.binary(max_size=300), st.integers(0, 320), st.sampled_from([0, 0x200]))
@settings(max_examples=150, deadline=None)
def test_no_memory_fails(data, at, base):
    image, findings = api.read_memory(data, base)
    if image is None:
        assert findings
        return
    for where in (None, base + at):
        seen, _ = api.recognise_memory(image, where)
        assert seen.known or seen.format in ("random", "cleared")
        block, findings = api.find_block(image, 1 + at % 5, where)
        assert block is not None or findings
    api.clear_memory(image)
