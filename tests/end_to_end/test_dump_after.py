"""`--dump-after` and the times of `-v`."""

from fork_server import wedmcam


def run(*args):
    done = wedmcam(*args)
    done.stdout, done.stderr = done.stdout.decode(), done.stderr.decode()
    return done


def test_stages_come_in_the_order_in_which_they_were_asked_for(tmp_path):
    out = tmp_path / "key.3b"
    args = ["compile", "samples/key-punch.dxf", "-o", out, "--offset", "0.1"]
    plain = run(*args)
    done = run(*args, "--dump-after", "program", "--dump-after", "sketch")
    assert done.returncode == plain.returncode == 0
    assert done.stdout.index("program: 60 blocks") < done.stdout.index("sketch: 56 segments")
    assert plain.stdout == ""
    assert done.stderr == plain.stderr


def test_what_was_reached_is_shown_of_a_refused_drawing():
    done = run("check", "samples/plate.dxf", "--offset", "9", "--dump-after", "contours",
               "--dump-after", "plan")  # fmt: skip
    assert done.returncode == 1
    assert done.stdout.startswith("contours: 10\n")
    assert "plan: the compile did not come so far" in done.stderr


def test_standard_output_is_one_thing(tmp_path):
    for more in (["--json"], ["--split"], ["--to", "3b,iso"]):
        done = run("compile", "samples/plate.dxf", "-o", tmp_path / "p.3b", "--offset", "0.1",
                   "--dump-after", "plan", *more)  # fmt: skip
        assert done.returncode == 2
        assert "--dump-after takes standard output" in done.stderr


def test_verbose_tells_the_time_of_stages():
    done = run("check", "samples/plate.dxf", "--offset", "0.1", "-v")
    assert "stages     read " in done.stderr
    assert "verify" in done.stderr
