"""What commands about one trial of one case share: the options that choose it, and its configuration."""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dynabot_mj.commands import parsers, setups
from dynabot_mj.common.exceptions import InputError

_CHOICES = {"plants": "plant", "estimators": "estimator", "perception": "perception"}  # key and option


def parser() -> argparse.ArgumentParser:
    """Returns the options that choose the trial, beside those of `parsers.science`."""
    from dynabot_mj.perception.estimators import IMPLEMENTATIONS
    from dynabot_mj.plants.kinds import PLANTS
    from dynabot_mj.study.scenario import PERCEPTIONS

    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--plant", choices=PLANTS, help="default rigid")
    parser.add_argument("--estimator", metavar="NAME", help=f"{parsers.methods_help()} (default decoupled)")
    parser.add_argument("--perception", choices=PERCEPTIONS, help="default gauss-markov")
    parser.add_argument(
        "--filters",
        choices=IMPLEMENTATIONS,
        dest="implementation",
        help="of --perception filter: ours, batched, or FilterPy's (default batched)",
    )
    parser.add_argument("--trial", type=int, help="its number (default 0)")
    parser.add_argument(
        "--reproduce",
        metavar="STUDY:CASE:TRIAL",
        help="repeat a trial of a saved study, e.g. out/compare:rigid/perfect:7",
    )
    return parser


def chosen(options: argparse.Namespace) -> Any:
    """Returns the configuration of the one trial of one case that the options name.

    Raises:
        InputError: If they name several cases, or a saved trial that cannot be repeated.
    """
    return _reproduced(options) if options.reproduce else _single(options)


def final(recording: Any) -> dict[str, Any]:
    """Returns what a recorded trial and the study that has it both keep."""
    return {"final_position_w": recording.final_position_w, "final_heading": recording.final_heading}


def _single(options: argparse.Namespace) -> Any:
    """Builds the configuration of one trial of one case."""
    setup = setups.build(
        options,
        {"plants": ["rigid"], "estimators": ["decoupled"]},
        trials=1,
        first_trial=options.trial,
        implementation=options.implementation,
        **{name: [value] if (value := getattr(options, option)) else None for name, option in _CHOICES.items()},
    )
    for name, option in _CHOICES.items():
        choices = dict.fromkeys(getattr(setup, name))
        if len(choices) > 1:
            command = options.function.__name__
            raise InputError(
                f"{', '.join(choices)} given by {options.config}; {command} takes one: choose with --{option}"
            )
    return setup


def _reproduced(options: argparse.Namespace) -> Any:
    """Builds the configuration of one trial of a saved study."""
    from dynabot_mj.study import dataset, provenance, saved, scenario

    others = {name: name for name in ("config", "plant", "estimator", "perception", "trial", *setups.SCIENCE)}
    others["implementation"] = "filters"
    if given := [option for name, option in others.items() if getattr(options, name, None) is not None]:
        raise InputError(f"--{given[0]} given with --reproduce, which takes everything from the saved study")
    try:
        folder, label, trial = options.reproduce.rsplit(":", 2)
        number = int(trial)
    except ValueError:
        raise InputError(f"--reproduce {options.reproduce!r} given, it must be STUDY:CASE:TRIAL") from None
    study, path = saved.load(Path(folder))
    labels = [str(one) for one in study.case.values]
    if label not in labels:
        raise InputError(f"case {label!r} given, the study has: {', '.join(labels)}")
    if number not in study.trial.values:
        raise InputError(f"trial {number} given, the study has {study.trial.values[0]} to {study.trial.values[-1]}")
    made = dataset.campaign_of(study, str(path))
    entry = made.entries[labels.index(label)]
    setup, part = made.points[entry.point].setup, dataset.points(study)[entry.point]
    if name := saved.changed_input(part):
        raise InputError(f"the {name} {provenance.given(setup, name)!r} of {path} has changed since that study")
    if (then := study.attrs.get("versions")) != (now := provenance.versions()):
        print(f"dynabot: that study was run by {then}, this is {now}: the trial may differ", file=sys.stderr)
    options.saved = part.sel(case=entry.case.label, trial=number)
    return scenario.one_trial(setup, entry.case.label, number)


def tell_identical(options: argparse.Namespace, found: Mapping[str, Any]) -> None:
    """Says whether a trial that was repeated is the saved one, bit for bit.

    Args:
        options: With the trial that `chosen` has found.
        found: Values of variables of the Dataset.
    """
    import numpy as np

    if not options.reproduce:
        return
    trial = options.saved
    if int(trial.diverged):
        print("note: the saved trial broke down: nothing of it is there to compare with", file=sys.stderr)
        return
    others = [
        name
        for name, values in found.items()
        if name in trial.variables and not np.array_equal(np.asarray(values), trial[name].values, equal_nan=True)
    ]
    if others:
        print(f"note: not identical to the saved trial: {', '.join(others)} differ", file=sys.stderr)
    else:
        label = options.reproduce.rsplit(":", 2)[1]
        print(f"identical to the saved trial {int(trial.trial)} of {label}", file=sys.stderr)
