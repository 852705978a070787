"""Outputs appear whole or not at all, in pieces too."""

import pytest

from wedmcam.files import write_files


def test_an_output_may_come_in_pieces(tmp_path):
    name = str(tmp_path / "a.csv")
    write_files([(name, (str(k).encode() for k in range(3)))])
    assert (tmp_path / "a.csv").read_bytes() == b"012"


def test_pieces_that_end_early_leave_all_as_it_was(tmp_path):
    def pieces():
        yield b"half"
        raise MemoryError

    (tmp_path / "a.csv").write_bytes(b"before")
    outputs = [(str(tmp_path / "b.csv"), b"other"), (str(tmp_path / "a.csv"), pieces())]
    with pytest.raises(MemoryError):
        write_files(outputs)
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]
    assert (tmp_path / "a.csv").read_bytes() == b"before"
