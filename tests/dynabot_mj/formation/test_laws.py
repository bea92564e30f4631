import json

import numpy as np
import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.controllers import potential_field
from dynabot_mj.controllers.law import Information
from dynabot_mj.formation import laws as control_laws
from dynabot_mj.study import assembly, configuration, provenance

FIELD = assembly.field(configuration.build({}), "decoupled")
OTHERS = ~np.eye(3, dtype=bool)
LAWS = """
import numpy as np


def rest(known):
    return np.zeros_like(known.position_w)


def strong(known):
    return np.full_like(known.position_w, 1000.0)


def short(known):
    return np.zeros(2)


def broken(known):
    return np.full_like(known.position_w, np.nan)


def failing(known):
    raise KeyError("gain")


def words(known):
    return "left"


number = 3
"""


@pytest.fixture
def laws(tmp_path, monkeypatch):
    (tmp_path / "laws_of_a_user.py").write_text(LAWS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def known():
    position_w = np.array([[[-40.0, 0.0], [-41.0, 3.0], [-44.0, -2.0]]])
    return Information(
        time=1.0,
        position_w=position_w,
        velocity_w=0.1 * position_w,
        leader_w=np.zeros(2),
        heard_position_w=np.broadcast_to(position_w[:, None], (1, 3, 3, 2)),
        heard_known=OTHERS[None],
        heard_age=np.zeros((1, 3, 3)),
    )


def test_the_built_in_law_is_the_field():
    given = known()
    np.testing.assert_array_equal(
        control_laws.build(control_laws.BUILT_IN, FIELD)(given),
        potential_field.total_force(
            given.position_w, given.velocity_w, given.leader_w, given.heard_position_w, given.heard_known, FIELD
        ),
    )


def test_a_law_of_the_users_is_limited_like_the_vehicle(laws):
    force_w = control_laws.build("laws_of_a_user:strong", FIELD)(known())
    np.testing.assert_allclose(np.hypot(force_w[..., 0], force_w[..., 1]), FIELD.force_limit)


@pytest.mark.parametrize(("name", "told"), [("short", "shape"), ("broken", "not finite")])
def test_what_is_no_force_is_told(laws, name, told):
    with pytest.raises(InputError, match=told):
        control_laws.build(f"laws_of_a_user:{name}", FIELD)(known())


@pytest.mark.parametrize("name", ["nonsense", "no_such_module:law", "laws_of_a_user:no", "laws_of_a_user:number"])
def test_what_is_no_law_is_bad_input(laws, name):
    with pytest.raises(InputError, match="controller"):
        configuration.build({"controller": name})


def test_its_file_is_an_input_of_the_study(laws):
    assert "controller" in provenance.inputs(configuration.build({"controller": "laws_of_a_user:rest"}))
    assert "controller" not in provenance.inputs(configuration.build({}))


def test_compare_judges_it(dynabot, laws):
    options = ["--estimators", "decoupled", "--trials", "2", "--duration", "3", "--workers", "2"]
    done = dynabot("compare", "--controller", "laws_of_a_user:rest", *options, "--json", cwd=laws)
    assert done.returncode == 0, done.stderr
    # Nobody moves, but that rigid robots settle on their tyres.
    assert all(row["top_speed_mps"]["mean"] < 0.05 for row in json.loads(done.stdout)["rows"])
    assert "laws_of_a_user:rest" in (laws / "out" / "compare" / "table.md").read_text()


@pytest.mark.parametrize(
    ("law", "told"),
    [
        ("failing", r"failed at 1 s: KeyError: 'gain' \(laws_of_a_user\.py, line 22\)"),
        ("words", r"failed at 1 s: ValueError: could not convert string to float: 'left'"),
    ],
)
def test_a_law_that_fails_is_told_in_one_line(laws, law, told):
    with pytest.raises(InputError, match=f"controller 'laws_of_a_user:{law}' {told}") as raised:
        control_laws.build(f"laws_of_a_user:{law}", FIELD)(known())
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("code", "told"), [("def law(", "SyntaxError"), ("1 / 0", "ZeroDivisionError: division by zero")]
)
def test_a_module_that_cannot_be_imported_is_told_in_one_line(tmp_path, monkeypatch, code, told):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    name = f"broken_{told[:4].lower()}"
    (tmp_path / f"{name}.py").write_text(code)
    with pytest.raises(InputError, match=f"controller '{name}:law' cannot be imported: {told}") as raised:
        control_laws.build(f"{name}:law", FIELD)
    assert "\n" not in str(raised.value)
