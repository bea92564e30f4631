"""The work of a campaign: for each case of each point its trials, in chunks of fixed size."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from dynabot_mj.common import columns
from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.columns import Columns
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.study import assembly, configuration, provenance, scenario
from dynabot_mj.study.campaign import Campaign, Entry
from dynabot_mj.study.chunk import Chunk
from dynabot_mj.study.scenario import Case, Scenario

RECORDED = 1  # trajectories kept of each case, from the study's first trial on
# Keys that tell which cases and trials there are: what comes of one does not depend on the others.
_OTHERS = ("trials", "first_trial", "plants", "estimators", "perception")


def chunks(made: Campaign) -> list[Chunk]:
    """Returns the work of a campaign, whose results are columns of `Outcome`."""
    shared = [_shared(point.setup) for point in made.points]
    return [
        chunk for entry in made.entries for chunk in _of(made.points[entry.point].setup, entry, shared[entry.point])
    ]


def _shared(setup: Scenario) -> dict[str, Any]:
    """Returns what the outcomes of a configuration depend on beside their case and trials."""
    tree = tomllib.loads(configuration.dump(setup))
    return {
        "configuration": {key: value for key, value in tree.items() if key not in _OTHERS},
        "inputs": provenance.inputs(setup),
    }


def _of(setup: Scenario, entry: Entry, shared: Mapping[str, Any]) -> Iterator[Chunk]:
    case, first = entry.case, setup.first_trial
    end, size = first + setup.trials, KINDS[case.plant].chunk
    for start in range(first, end, size):
        trials, recorded = range(start, min(start + size, end)), max(0, RECORDED - (start - first))
        yield Chunk(
            label=entry.label,
            start=start,
            size=len(trials),
            weight=_seconds(setup, case, len(trials)),
            inputs={**shared, "case": asdict(case), "trials": [trials.start, trials.stop], "recorded": recorded},
            work=_simulated,
            arguments=(setup, case, trials, recorded),
        )


def _simulated(
    setup: Scenario, case: Case, trials: range, recorded: int, *, threads: int, progress: Progress
) -> Columns:
    return columns.flatten(
        assembly.simulate(setup, case, trials, recorded=recorded, threads=threads, progress=progress)
    )


def _seconds(setup: Scenario, case: Case, trials: int) -> float:
    """Returns how long trials take, roughly."""
    trial, robot = KINDS[case.plant].work
    per_trial = trial + robot * setup.robots
    events = 1e3 / scenario.periods(setup, case.estimator)[1]
    if case.perception == "filter":
        per_trial += 1e-5 * events * setup.robots
    return scenario.duration(setup) * (trials * per_trial + events * 3e-4)
