"""The script that shows that a move changes nothing sees a change, and runs what it says."""

import json

import snapshot


def test_a_sample_is_compiled_to_every_profile_and_proven_again(tmp_path):
    snapshot.write(tmp_path, None, False, ["quarter.wed"])
    for profile, ending in snapshot.PROFILES.items():
        certificate = tmp_path / f"quarter.wed.{profile}{ending}.json"
        if certificate.exists():
            assert json.loads(certificate.read_text("utf-8"))["ok"]
    programs = [p for p in tmp_path.iterdir() if p.suffix in (".3b", ".nc", ".zd", ".4b")]
    assert len(programs) > 12
    said = [p.read_text("utf-8").splitlines()[-1] for p in tmp_path.glob("said-*.txt")]
    assert said.count("0") > 40
    assert not [s for s in said if "Error" in s and "WrongUse" not in s and "Usage" not in s]


def test_a_changed_and_a_missing_file_are_named(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    for folder in (one, two):
        folder.mkdir()
        (folder / "same").write_text("a")
        (folder / "changed").write_text(folder.name)
    (two / "new").write_text("b")
    assert snapshot.differences(one, two) == ["changed", "new"]
