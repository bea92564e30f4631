"""Formation control under limited computation and communication, with point-mass and rigid-body robots.

What a user of the library needs is here, `import dynabot_mj as dy`; the rest is where docs/architecture.md says.
Importing the package imports nothing heavy: a name brings its libraries when it is first asked for.

    scenarios    build_scenario, parse_scenario, load_scenario, dump_scenario, cases; Scenario, Case
    studies      run, save, load; Execution
    their words  compare, comparison_markdown
    trials       simulate; make_parts, run_parts; Parts, Observer
    robots       ParticlePlant, RigidBodyPlant, FleetState, local_laws
    estimators   build_estimator; Estimator, ImuSample, GpsFix
    radio        dynabot_link; Link, Radio
    processor    shortest_period, processor_load, schedule_table
    dm_env       load_environment
    errors       DynabotError, InputError, InfeasibleScheduleError, OutOfFittedRangeError

Shapes: B trials, n robots. World-frame quantities end in `_w`, body-frame ones in `_b`; SI units and radians. Examples
in docstrings take `import dynabot_mj as dy` and `import numpy as np` for granted.

Example:
    >>> setup = dy.build_scenario({"trials": 2, "duration": 1.0, "plants": ["particle"], "estimators": ["gps"]})
    >>> results = dy.run(setup)
    >>> results.arrival.dims
    ('case', 'trial')
"""

from pathlib import Path as _Path
from typing import TYPE_CHECKING

__version__ = "0.1.0"

# In a checkout these are links to folders beside the package; wheels have the folders themselves.
for _leaf in ("models", "controllers", "estimation"):
    if not (_Path(__file__).parent / _leaf).is_dir():
        raise ImportError(
            f"{_Path(__file__).parent / _leaf} is no folder: a checkout of dynabot-mj has symbolic links there, which "
            "this one lacks; check out again with `git config core.symlinks true`, or install a wheel"
        )

__all__ = [
    "Case",
    "DynabotError",
    "Estimator",
    "Execution",
    "FleetState",
    "GpsFix",
    "ImuSample",
    "InfeasibleScheduleError",
    "InputError",
    "Link",
    "Observer",
    "OutOfFittedRangeError",
    "ParticlePlant",
    "Parts",
    "Radio",
    "RigidBodyPlant",
    "Scenario",
    "build_estimator",
    "build_scenario",
    "cases",
    "compare",
    "comparison_markdown",
    "dump_scenario",
    "dynabot_link",
    "load",
    "load_environment",
    "load_scenario",
    "local_laws",
    "make_parts",
    "parse_scenario",
    "processor_load",
    "run",
    "run_parts",
    "save",
    "schedule_table",
    "shortest_period",
    "simulate",
]

if TYPE_CHECKING:
    from dynabot_mj.common.exceptions import DynabotError, InfeasibleScheduleError, InputError, OutOfFittedRangeError
    from dynabot_mj.environment.task import load as load_environment
    from dynabot_mj.estimation.estimator import Estimator
    from dynabot_mj.estimation.measurements import GpsFix, ImuSample
    from dynabot_mj.experiments.formation.compare import compared as compare
    from dynabot_mj.experiments.formation.compare_tables import markdown as comparison_markdown
    from dynabot_mj.perception.estimators import build as build_estimator
    from dynabot_mj.plants.particle import ParticlePlant
    from dynabot_mj.plants.plant import FleetState
    from dynabot_mj.plants.rigid_body import RigidBodyPlant
    from dynabot_mj.study.assembly import parts as make_parts
    from dynabot_mj.study.assembly import simulate
    from dynabot_mj.study.configuration import build as build_scenario
    from dynabot_mj.study.configuration import dump as dump_scenario
    from dynabot_mj.study.configuration import load as parse_scenario
    from dynabot_mj.study.configuration import load_file as load_scenario
    from dynabot_mj.study.dataset import load, run, save
    from dynabot_mj.study.execution import Execution
    from dynabot_mj.study.fleet import local_laws
    from dynabot_mj.study.scenario import Case, Scenario, cases
    from dynabot_mj.testbed.radio import Link, Radio, dynabot_link
    from dynabot_mj.testbed.schedule import period as shortest_period
    from dynabot_mj.testbed.schedule import table as schedule_table
    from dynabot_mj.testbed.schedule import utilisation as processor_load
    from dynabot_mj.trial.loop import Observer, Parts
    from dynabot_mj.trial.loop import simulate as run_parts
else:  # hidden from type checkers, which would believe every name to be here
    # Where each name is, and what it is called there; rooms such as `study` and `environment` stay what they are.
    _HOMES = {
        "Case": "study.scenario:Case",
        "DynabotError": "common.exceptions:DynabotError",
        "Estimator": "estimation.estimator:Estimator",
        "Execution": "study.execution:Execution",
        "FleetState": "plants.plant:FleetState",
        "GpsFix": "estimation.measurements:GpsFix",
        "ImuSample": "estimation.measurements:ImuSample",
        "InfeasibleScheduleError": "common.exceptions:InfeasibleScheduleError",
        "InputError": "common.exceptions:InputError",
        "Link": "testbed.radio:Link",
        "Observer": "trial.loop:Observer",
        "OutOfFittedRangeError": "common.exceptions:OutOfFittedRangeError",
        "ParticlePlant": "plants.particle:ParticlePlant",
        "Parts": "trial.loop:Parts",
        "Radio": "testbed.radio:Radio",
        "RigidBodyPlant": "plants.rigid_body:RigidBodyPlant",
        "Scenario": "study.scenario:Scenario",
        "build_estimator": "perception.estimators:build",
        "build_scenario": "study.configuration:build",
        "cases": "study.scenario:cases",
        "compare": "experiments.formation.compare:compared",
        "comparison_markdown": "experiments.formation.compare_tables:markdown",
        "dump_scenario": "study.configuration:dump",
        "dynabot_link": "testbed.radio:dynabot_link",
        "load": "study.dataset:load",
        "load_environment": "environment.task:load",
        "load_scenario": "study.configuration:load_file",
        "local_laws": "study.fleet:local_laws",
        "make_parts": "study.assembly:parts",
        "parse_scenario": "study.configuration:load",
        "processor_load": "testbed.schedule:utilisation",
        "run": "study.dataset:run",
        "run_parts": "trial.loop:simulate",
        "save": "study.dataset:save",
        "schedule_table": "testbed.schedule:table",
        "shortest_period": "testbed.schedule:period",
        "simulate": "study.assembly:simulate",
    }

    def __getattr__(name: str) -> object:
        """Imports what a public name stands for when it is asked for."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib

        module, _, called = _HOMES[name].partition(":")
        return getattr(importlib.import_module(f"{__name__}.{module}"), called)

    def __dir__() -> list[str]:
        """Lists the public names too, which are not imported yet."""
        return sorted({*globals(), *__all__})
