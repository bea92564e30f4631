import math

import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.experiments.vehicle import manoeuvres
from dynabot_mj.experiments.vehicle.manoeuvres import KINDS, Manoeuvre, field_force, load, random, sampled

PERIOD = 0.04
PURPOSES = (0, 1)


def force(duration=10.0, **given):
    """Returns times and force of one manoeuvre, (K,) and (K, 2)."""
    courses = sampled([Manoeuvre(**given)], duration, PERIOD)
    return PERIOD * np.arange(courses.force_w.shape[1]), courses.force_w[0]


@pytest.mark.parametrize("kind", KINDS)
def test_shapes_of_what_is_sampled(kind):
    courses = sampled([Manoeuvre(kind=kind), Manoeuvre(kind="step"), Manoeuvre(kind="well")], 1.01, PERIOD)
    # 1.01 s are 26 periods of 40 ms, rounded up.
    assert courses.force_w.shape == (3, 26, 2)
    assert courses.gain.shape == courses.neighbour_gain.shape == (3,)
    assert courses.start_w.shape == courses.neighbour_w.shape == (3, 2)
    assert courses.period == PERIOD
    assert all(np.isfinite(getattr(courses, name)).all() for name in ("force_w", "start_w", "neighbour_w"))


def test_a_duration_of_whole_periods_is_kept():
    assert sampled([Manoeuvre(kind="step")], 0.108, 0.036).force_w.shape == (1, 3, 2)


def test_a_step_is_reversed_half_way():
    time, found = force(kind="step", force=20.0, direction=0.5)
    expected = 20.0 * np.array([np.cos(0.5), np.sin(0.5)])
    np.testing.assert_allclose(found[time < 5.0 - 1e-9], np.tile(expected, (125, 1)))
    np.testing.assert_allclose(found[time > 5.0 - 1e-9], np.tile(-expected, (125, 1)))


def test_a_chirp_rises_from_zero_to_its_frequency():
    time, found = force(kind="chirp", force=20.0, direction=1.0, frequency=0.4)
    across = -np.sin(1.0) * found[:, 0] + np.cos(1.0) * found[:, 1]
    np.testing.assert_allclose(across, 0.0, atol=1e-12)
    along = np.cos(1.0) * found[:, 0] + np.sin(1.0) * found[:, 1]
    # Its phase is pi f t^2 / t_end, whose derivative is 2 pi f at the end.
    np.testing.assert_allclose(along, 20.0 * np.cos(np.pi * 0.4 * time**2 / 10.0), atol=1e-9)


def test_a_circle_turns_steadily():
    time, found = force(kind="circle", force=20.0, direction=1.0, frequency=0.2)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 20.0)
    np.testing.assert_allclose(
        np.unwrap(np.arctan2(found[:, 1], found[:, 0])), 1.0 + 2.0 * np.pi * 0.2 * time, atol=1e-9
    )


def test_a_figure_eight_turns_to_both_sides_alike():
    _, found = force(kind="figure-eight", force=20.0, direction=0.0, frequency=0.2)  # two whole periods
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 20.0)
    angle = np.unwrap(np.arctan2(found[:, 1], found[:, 0]))
    assert angle.max() == pytest.approx(-angle.min(), abs=0.01)
    assert angle.max() == pytest.approx(2.4, abs=0.01)
    assert angle.mean() == pytest.approx(0.0, abs=1e-9)


def test_noise_is_white_about_a_constant_force():
    _, found = force(400.0, kind="noise", force=10.0, direction=0.7, seed=4)
    count = len(found)
    mean = 15.0 * np.array([np.cos(0.7), np.sin(0.7)])
    np.testing.assert_allclose(found.mean(axis=0), mean, atol=4.0 * 10.0 / math.sqrt(count))
    np.testing.assert_allclose(found.std(axis=0), 10.0, rtol=4.0 / math.sqrt(2.0 * count))
    centred = (found - mean) / 10.0
    assert abs((centred[1:] * centred[:-1]).mean()) < 4.0 / math.sqrt(2.0 * count)
    np.testing.assert_array_equal(force(400.0, kind="noise", force=10.0, direction=0.7, seed=4)[1], found)
    assert not np.array_equal(force(400.0, kind="noise", force=10.0, direction=0.7, seed=5)[1], found)


def test_a_well_is_a_place_and_no_force_of_its_own():
    one = Manoeuvre(kind="well", gain=650.0, distance=9.0, direction=0.5, neighbour=1.0)
    courses = sampled([one, Manoeuvre(kind="circle")], 2.0, PERIOD)
    np.testing.assert_array_equal(courses.force_w[0], 0.0)
    np.testing.assert_allclose(courses.gain, [650.0, 0.0])
    np.testing.assert_allclose(courses.neighbour_gain, [300.0, 0.0])  # Table III's alpha_d to this alpha_h
    np.testing.assert_allclose(courses.start_w, [-9.0 * np.array([np.cos(0.5), np.sin(0.5)]), [0.0, 0.0]])
    # The other robot stands at its bearing from that of the start.
    start, beside = courses.start_w[0], courses.neighbour_w[0]
    turned = np.arctan2(beside[1], beside[0]) - np.arctan2(start[1], start[0])
    assert (turned + np.pi) % (2.0 * np.pi) - np.pi == pytest.approx(1.0)


def test_the_wells_force_is_that_of_eq_8():
    one = Manoeuvre(kind="well", gain=650.0, distance=9.0, direction=0.0, neighbour=0.0)
    courses = sampled([one, Manoeuvre(kind="step")], 2.0, PERIOD)
    position = np.array([[-9.0, 0.0], [1.0, 1.0]])
    found = field_force(position, courses, radius=3.0, width=1.0, spacing=5.2)
    # dV/dr = alpha (1 / s - r0 / s^2): of the well at s = 9 - 1, attractive; of the robot 5.7 m away at s = 5.7 - 1,
    # which is its floor, none.
    np.testing.assert_allclose(found[0], [650.0 * (1.0 / 8.0 - 3.0 / 64.0), 0.0], atol=1e-9)
    np.testing.assert_array_equal(found[1], 0.0)
    # Nearer than its spacing the robot repels, away from its place at (-3.3, 0).
    near = field_force(np.array([[-6.3, 0.0], [0.0, 0.0]]), courses, radius=3.0, width=1.0, spacing=5.2)
    expected = 650.0 * (1.0 / 5.3 - 3.0 / 5.3**2) + 300.0 * (1.0 / 3.0 - 5.2 / 9.0)
    assert near[0, 0] == pytest.approx(expected)


def test_random_sets_are_repeatable_and_differ_by_purpose():
    one = random(3, 20, PURPOSES[0])
    assert random(3, 20, PURPOSES[0]) == one
    assert random(3, 30, PURPOSES[0])[:20] == one  # more of them leave the first ones as they are
    other, elsewhere = random(3, 20, PURPOSES[1]), random(4, 20, PURPOSES[0])
    for a, b, c in zip(one, other, elsewhere, strict=True):
        assert a.kind == b.kind == c.kind
        assert len({a.direction, b.direction, c.direction}) == 3
    assert {a.kind for a in one} == set(KINDS)
    assert {a.kind for a in one[:10]} == set(KINDS)


def test_sets_of_each_kind_are_in_the_order_of_the_kinds():
    found = manoeuvres.of_each_kind(3, 2, PURPOSES[0])
    assert [one.kind for one in found] == [kind for kind in KINDS for _ in range(2)]
    assert manoeuvres.of_each_kind(3, 2, PURPOSES[0]) == found
    assert len({one.direction for one in found + manoeuvres.of_each_kind(3, 2, PURPOSES[1])}) == 4 * len(KINDS)


def test_manoeuvres_come_from_a_file(tmp_path):
    file = tmp_path / "courses.toml"
    file.write_text("[[manoeuvre]]\nkind = 'step'\nforce = 30\n\n[[manoeuvre]]\nkind = 'noise'\nseed = 3\n")
    assert load(file) == [Manoeuvre(kind="step", force=30.0), Manoeuvre(kind="noise", seed=3)]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[manoeuvre]]\nkind = 'jump'", "kind = 'jump'"),
        ("[[manoeuvre]]\nforce = 30.0", "kind is missing, it must be given"),
        ("[[manoeuvre]]\nkind = 'step'\nbogus = 1", "unknown key bogus (the keys are kind, force, direction, "),
        ("[[manoeuvre]]\nkind = 'step'\nforce = -1.0", "force = -1"),
        ("[[manoeuvre]]\nkind = 'step'\nforce = nan", "force = nan"),
        ("[[manoeuvre]]\nkind = 'step'\nforce = 'big'", "force = 'big'"),
        ("[[manoeuvre]]\nkind = 'circle'\nfrequency = 0.0", "frequency = 0"),
        ("[[manoeuvre]]\nkind = 'step'\ndirection = inf", "direction = inf"),
        ("[[manoeuvre]]\nkind = 'noise'\nseed = -1", "seed = -1"),
        ("[manoeuvre]\nkind = 'step'", "it must have tables [[manoeuvre]], and nothing else"),
        ("manoeuvre = 3", "it must have tables [[manoeuvre]], and nothing else"),
        ("manoeuvre = [3]", "it must have tables [[manoeuvre]], and nothing else"),
        ("manoeuvre = [{kind = 'step'}, 3]", "it must have tables [[manoeuvre]], and nothing else"),
        ("manoeuvre = []", "it must have tables [[manoeuvre]], and nothing else"),
        ("seed = 1\n[[manoeuvre]]\nkind = 'step'", "it must have tables [[manoeuvre]], and nothing else"),
        ("", "it must have tables [[manoeuvre]], and nothing else"),
        ("[[manoeuvre", "cannot read the manoeuvres"),
    ],
)
def test_nonsense_is_named_in_one_line(text, message, tmp_path):
    file = tmp_path / "courses.toml"
    file.write_text(text)
    with pytest.raises(InputError) as error:
        load(file)
    assert message in str(error.value)
    assert str(file) in str(error.value)
    assert "\n" not in str(error.value)


def test_files_that_cannot_be_read(tmp_path):
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00\x01")
    for name in ("binary.toml", "absent.toml", "."):
        with pytest.raises(InputError, match="cannot read the manoeuvres"):
            load(tmp_path / name)


def test_the_kinds_in_the_module_are_all_described():
    assert all(f"\n{kind} " in manoeuvres.__doc__ for kind in KINDS)
