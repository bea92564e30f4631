"""What a report needs beside the study: its first trial again, frame by frame, a film of it, and the tether."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from dynabot_mj.common.arrays import Progress
from dynabot_mj.common.exceptions import DynabotError
from dynabot_mj.experiments.estimators import circle
from dynabot_mj.film import encoder, film, take
from dynabot_mj.film.shot import Shot
from dynabot_mj.host import opengl
from dynabot_mj.perception import methods
from dynabot_mj.plants.kinds import KINDS
from dynabot_mj.report.contents import Material
from dynabot_mj.study import configuration, scenario
from dynabot_mj.study.scenario import Scenario
from dynabot_mj.trial.judge import TRAJECTORY_INTERVAL
from dynabot_mj.viewing import recording
from dynabot_mj.viewing.recording import Recording

_CIRCLE_RUNS = 20
_SHOT = Shot(width=640, height=360, rate=20.0, speed=4.0, samples=4)  # smooth edges also make a smaller file
_FILMED = "decoupled"
_ALIKE = 1e-6  # between the path that a study kept and the one of today's recording [m]


def gather(study: xr.Dataset, execution: Mapping[str, Any], changed: str, progress: Progress) -> Material:
    """Collects what a report is made of.

    Args:
        study: Of `study.load`.
        execution: Of execution.json; may be empty.
        changed: What makes it impossible to repeat the study's trials; "" where nothing does.
        progress: Told the share of the work that is done.
    """
    setup = configuration.load(study.attrs["configuration"], "the study's configuration")
    recordings = [] if changed else _recordings(setup, lambda share: progress(0.7 * share))
    clip, clip_note = _clip(recordings, lambda share: progress(0.7 + 0.2 * share))
    # Faults are of robots that are not there, at times that belong to a formation.
    sensors = replace(setup.sensors, faults=())
    own = {name: row for name, row in setup.method.items() if row.filter is not None and name in setup.estimators}
    asked = circle.CircleRequest(
        runs=_CIRCLE_RUNS, seed=setup.seed, sensors=sensors, filter=setup.filter, method=own or None
    )
    return Material(
        study=study,
        execution=execution,
        recordings=recordings,
        recordings_note=f"There are no figures over time: {changed}." if changed else _note(study, recordings),
        clip=clip,
        clip_note=clip_note,
        circle=circle.run(asked, lambda share: progress(0.9 + 0.1 * share)),
    )


def _recordings(setup: Scenario, progress: Progress) -> list[Recording]:
    """Repeats the study's first trial of each case."""
    cases = scenario.cases(setup)
    found = []
    for index, case in enumerate(cases):

        def tell(share: float, index: int = index) -> None:
            progress((index + share) / len(cases))

        one = scenario.one_trial(setup, case.label, setup.first_trial)
        found.append(recording.record(one, TRAJECTORY_INTERVAL, tell))
    return found


def _note(study: xr.Dataset, recordings: Sequence[Recording]) -> str:
    """Says which trial is shown, and whether it is still the study's own."""
    told = f"Trial {recordings[0].trial} of seed {recordings[0].setup.seed}, run again for this page."
    apart = 0.0
    for one in recordings:
        kept_w = study.trajectory_w.sel(case=one.case.label).isel(recorded=0).values
        if kept_w.shape != one.position_w.shape or (np.isfinite(kept_w) != np.isfinite(one.position_w)).any():
            apart = np.inf
        elif np.isfinite(kept_w).any():
            apart = max(apart, float(np.nanmax(np.abs(kept_w - one.position_w))))
    if apart > _ALIKE:
        told += " It is not the study's own any more: paths differ, as they do with other versions of the simulator."
    return told


def _clip(recordings: Sequence[Recording], progress: Progress) -> tuple[bytes | None, str]:
    """Films a rigid fleet, that of the decoupled filter where there is one.

    Returns:
        An mp4 file and what it shows, or None and why there is none.
    """
    bodies = [one for one in recordings if KINDS[one.case.plant].body]
    if not bodies:
        return None, "There is no film: it shows rigid robots, and the study has none that can be run again."
    chosen = next((one for one in bodies if one.case.estimator == _FILMED), bodies[0])
    try:
        opengl.require()
        taken = take.take(chosen.setup, _SHOT, beside=False, progress=lambda share: progress(0.2 * share))
        with film.opened(taken, _SHOT) as drawn, tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "film.mp4"
            encoder.write(path, drawn.frames(lambda share: progress(0.2 + 0.8 * share)), _SHOT.rate)
            content = path.read_bytes()
    except DynabotError as error:
        return None, f"There is no film: {error}."
    case = methods.label(chosen.case.estimator, chosen.case.perception)
    return content, (
        f"Trial {chosen.trial}, {case}, {_SHOT.speed:g} times as fast. Translucent: where each robot believes to be, "
        "and one standard deviation per axis around it."
    )
