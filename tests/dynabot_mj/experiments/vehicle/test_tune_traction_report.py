from dynabot_mj.controllers.design import design_model
from dynabot_mj.experiments.vehicle import tune_traction_report


def test_a_gain_that_ended_at_its_bound_is_told():
    low, high = design_model.BOUNDS["scrub_torque"]
    assert tune_traction_report._bounds("scrub_torque", 0.5 * (low + high)) == f"{low:g} to {high:g}"
    for value in (low, high - 1e-3):
        assert tune_traction_report._bounds("scrub_torque", value) == f"{low:g} to {high:g}, at its bound"
