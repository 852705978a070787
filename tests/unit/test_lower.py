"""Lowering: closed loop, budgets, limits, control records."""

import numpy as np
import pytest

import parts
from plans import one_scene
from wedmcam.controllers.pointwise import LineTable, arc_end, of_table, run
from wedmcam.diag import TextSpan
from wedmcam.ir.contour import Contour, vertices
from wedmcam.ir.plan import Cut, Side
from wedmcam.ir.program import Axis, Kind, Role
from wedmcam.transforms.lower import Rules, lower
from wedmcam.transforms.lower.repair import best_chain

ROTATE = of_table("rotate")


def plan_of(*paths, threads=None, keeps=None, **more):
    cuts = tuple(
        Cut(
            p,
            p,
            threads[k]
            if threads
            else (round(float(p.vertices["x"][0])), round(float(p.vertices["y"][0]))),
            keeps_left=keeps,
            number=k + 1,
            **more,
        )
        for k, p in enumerate(paths)
    )
    return one_scene(cuts, paths, (0,) * len(paths), Side.ON, 0.0)


def made(plan, rules=None):
    program, found = lower(plan, rules or Rules(ROTATE))
    assert program is not None, found
    return program, found


def ends(program, table=LineTable.ROTATE):
    motion = run(program.blocks, table)
    assert (motion.steps >= 0).all()
    return np.cumsum(motion.dx) + program.origin[0], np.cumsum(motion.dy) + program.origin[1]


def test_random_circles_close_exactly():
    rng = np.random.default_rng(7)
    for k in range(150):
        x, y = rng.uniform(-5e4, 5e4, 2)
        r, a = 10 ** rng.uniform(0.8, 5), rng.uniform(0, 6.28)
        circle = Contour(
            vertices([(x + r * np.cos(a), y + r * np.sin(a), x, y, 1 - 2 * (k % 2), -1)]), True
        )
        program, _ = made(plan_of(circle, threads=[(round(x), round(y))]))
        ex, ey = ends(program)
        assert (ex[-1], ey[-1]) == program.origin


@pytest.mark.parametrize("square", [False, True])
def test_every_arc_lands_on_its_micron(square):
    table = LineTable.MIRROR if square else LineTable.ROTATE
    for seed in range(20):
        for contour in parts.random_part(seed):
            program, _ = made(plan_of(contour), Rules(of_table(table), square=square))
            ex, ey = ends(program, table)
            contour_blocks = program.blocks["role"] == Role.CONTOUR
            contour_blocks &= program.blocks["kind"] <= Kind.ARC
            # Every vertex of the outline has a block end within a micron and a bit.
            at = np.column_stack([ex, ey])[contour_blocks]
            for x, y in zip(contour.vertices["x"], contour.vertices["y"], strict=True):
                assert np.hypot(*(at - (x, y)).T).min() <= 1.6


def test_axis_of_an_arc_is_the_textbook_one_away_from_45_degrees():
    """G by the end: nearer the x axis GY, nearer the y axis GX (2-3b.md)."""
    for seed in range(20):
        program, _ = made(plan_of(*parts.random_part(seed)))
        b = program.blocks[program.blocks["kind"] == Kind.ARC]
        motion = run(b, LineTable.ROTATE)
        fx, fy = np.abs(b["x"] + motion.dx), np.abs(b["y"] + motion.dy)
        clear = np.abs(fx - fy) > 2
        assert (b["axis"][clear] == np.where(fx > fy, Axis.Y, Axis.X)[clear]).all()


def test_long_lines_and_large_circles_are_split_within_the_limits():
    long = Contour(vertices([(0, 0, 0, 0, 0, -1), (2_500_000, 1000, 0, 0, 0, -1)]), False)
    program, _ = made(plan_of(long))
    assert (program.blocks["count"] <= 999_999).all()
    assert ends(program)[0][-1] == 2_500_000
    for radius in (300_000, 900_000):
        circle = parts.circle(0, 0, radius)
        for rules in (Rules(ROTATE), Rules(ROTATE, square=True, arc_um=10_000_000)):
            program, found = made(plan_of(circle), rules)
            assert (program.blocks["count"] <= 999_999).all()
            assert not [d for d in found if d.code == "radius-over-limit"]


def test_radius_over_the_limit_becomes_chords_and_is_said():
    circle = parts.circle(0, 0, 1_500_000)
    program, found = made(plan_of(circle))
    assert [d.code for d in found if d.severity == 1] == ["radius-over-limit"]
    assert not (program.blocks["kind"] == Kind.ARC).any()
    program, found = made(plan_of(circle), Rules(ROTATE, square=True, arc_um=10_000_000))
    assert (program.blocks["kind"] == Kind.ARC).any()


@pytest.mark.parametrize("side", ["part", "die"])
@pytest.mark.parametrize("radius", [1_000_050, 1_200_000, 4_000_000])
def test_chords_of_large_radii_are_proven(radius, side):
    import wedmcam

    made = wedmcam.compile(parts.dxf_bytes((parts.circle(0, 0, radius),)), offset=0.1, side=side)
    assert made.ok, [d.message for d in made.findings if d.severity == 2]
    assert made.verdict.gouge_um <= 1.6


def test_an_arc_that_rounds_to_nothing_never_becomes_a_circle():
    """Q-05: start = end after rounding is no block, never a full circle."""
    r = 50_000.0
    a = 0.4 / r
    rows = [
        (r, 0, 0, 0, 1, -1),
        (r * np.cos(a), r * np.sin(a), 0, 0, 0, -1),
        (r + 3000, 4000, 0, 0, 0, -1),
        (r + 3000, 0, 0, 0, 0, -1),
    ]
    program, _ = made(plan_of(Contour(vertices(rows), True)))
    assert run(program.blocks, LineTable.ROTATE).steps.sum() < 40_000


def test_almost_a_full_circle_survives():
    """Q-06: 359.9999 degrees are neither dropped nor closed by a second turn."""
    r, a = 10_000.0, np.radians(359.9999)
    rows = [(r, 0, 0, 0, 1, -1), (r * np.cos(a), r * np.sin(a), 0, 0, 0, -1)]
    program, _ = made(plan_of(Contour(vertices(rows), False)))
    steps = int(run(program.blocks, LineTable.ROTATE).steps.sum())
    assert abs(steps - 8 * r) < 20


def test_ten_thousand_specks_are_not_lost():
    """Q-02: a path of 0.1 um moves goes where it goes."""
    n = 4000
    x = np.linspace(0, 400, n + 1)
    rows = [(v, 0.0, 0, 0, 0, -1) for v in x]
    program, _ = made(plan_of(Contour(vertices(rows), False)))
    assert ends(program)[0][-1] == 400


def test_control_records():
    """Cut, D, move, D, cut, DD; a single line between two D is written as two."""
    one = Contour(vertices([(0, 0, 0, 0, 0, -1), (1001, 0, 0, 0, 0, -1)]), False)
    two = parts.rectangle(3000, 2000, 10_000, 0)
    program, _ = made(plan_of(one, two))
    kinds = [Kind(k).name for k in program.blocks["kind"]]
    assert kinds == [
        *("LINE", "LINE", "PAUSE", "MOVE", "PAUSE"),
        *("LINE",) * 4,
        "STOP",
    ]
    same_place = plan_of(two, two)
    kinds = [Kind(k).name for k in made(same_place)[0].blocks["kind"]]
    assert kinds.count("PAUSE") == 1
    assert "MOVE" not in kinds


def test_sources_that_contours_share_are_listed_once():
    said = tuple(TextSpan("part.wed", line, 1) for line in range(1, 5))
    other = (TextSpan("part.wed", 9, 1),)
    v = vertices([(0, 0, 500, 0, 1, 0)])
    paths = []
    for k, sources in enumerate((said, said, other, said)):
        row = v.copy()
        row["x"] += 2000 * k
        row["cx"] += 2000 * k
        row["source"] = k if sources is said else 0
        paths.append(Contour(row, True, sources))
    program, _ = made(plan_of(*paths))
    assert program.sources == said + other
    cutting = program.blocks[program.blocks["kind"] == Kind.ARC]
    for number, path in enumerate(paths, 1):
        rows = cutting["source"][cutting["cut"] == number]
        assert len(rows)
        assert {program.sources[r] for r in rows} == {path.source_of(0)}


def test_a_move_over_the_limit_is_refused():
    far = parts.circle(2_000_000, 0, 1000)
    program, found = lower(plan_of(parts.circle(0, 0, 1000), far), Rules(ROTATE))
    assert program is None
    assert [d.code for d in found] == ["move-too-long"]


def test_stop_and_overcut():
    square = parts.rectangle(10_000, 10_000)
    plan = plan_of(square, threads=[(-1000, 0)], stop_um=3000.0, overcut_um=500.0)
    program, _ = made(plan)
    b = program.blocks
    pause = int(np.flatnonzero(b["kind"] == Kind.PAUSE)[0])
    ex, ey = ends(program)
    assert (ex[pause], ey[pause]) == (0, 3000)
    over = b["role"] == Role.OVERCUT
    assert (ex[over].max(), ex[over].min()) == (500, 0)  # out and back in the kerf
    assert (ex[-1], ey[-1]) == (-1000, 0)


def test_textbook_ends_are_those_that_the_controller_computes():
    from wedmcam.controllers.pointwise.nominal import nominal_end

    program, _ = made(plan_of(*parts.random_part(3)), Rules(ROTATE, textbook=True))
    b = program.blocks[program.blocks["kind"] == Kind.ARC]
    ex, ey = nominal_end(b["x"], b["y"], b["turn"], b["axis"], b["count"])
    # Where the arc steps at all, it passes within a micron or so of the computed end.
    near = [
        arc_end(b["x"], b["y"], b["turn"], ex + i, ey + j).landed
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
    ]
    assert np.any(near, axis=0).all()


def test_best_chain_is_the_cheapest_by_brute_force():
    rng = np.random.default_rng(1)
    for _ in range(50):
        sizes = rng.integers(1, 4, 4)
        costs = [rng.uniform(0, 1, (sizes[k], sizes[k + 1])) for k in range(3)]
        extra = [rng.uniform(0, 0.1, n) for n in sizes]
        best = min(
            sum(costs[k][c[k], c[k + 1]] ** 4 for k in range(3))
            + sum(extra[k][c[k]] for k in range(4))
            for c in np.ndindex(*sizes)
        )
        chain = best_chain(costs, extra)
        got = sum(costs[k][chain[k], chain[k + 1]] ** 4 for k in range(3))
        got += sum(extra[k][chain[k]] for k in range(4))
        assert got == pytest.approx(best)
    assert best_chain([np.full((2, 2), np.inf)], [np.zeros(2), np.zeros(2)]) is None
