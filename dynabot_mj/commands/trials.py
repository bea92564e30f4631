"""What commands about one trial of one case share: the options that choose it, and its configuration."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from dynabot_mj.commands import studies
from dynabot_mj.errors import InputError

_CHOICES = {"plants": "plant", "estimators": "estimator", "perception": "perception"}  # key and option


def parser() -> argparse.ArgumentParser:
    """Returns the options that choose the trial, beside those of `parsers.science`."""
    from dynabot_mj.estimation.build import IMPLEMENTATIONS
    from dynabot_mj.scenario import ESTIMATORS, PERCEPTIONS, PLANTS

    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--plant", choices=PLANTS, help="default rigid")
    parser.add_argument("--estimator", choices=ESTIMATORS, help="default decoupled")
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


def saved_study(place: Path) -> tuple[Any, Path]:
    """Reads a saved study.

    Args:
        place: Its file, or the folder of its results.

    Returns:
        The Dataset and its file.

    Raises:
        InputError: If there is none, or it cannot be read.
    """
    from dynabot_mj import configuration, control_laws, scenario, study

    path = place / "study.nc" if place.is_dir() else place
    if not path.is_file():
        raise InputError(f"there is no study at {path}")
    try:
        saved = study.load(path)
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the study {path}: {error}") from error
    for name in ("configuration", "case", "trial"):
        if name not in saved.attrs and name not in saved.coords:
            raise InputError(f"the study {path} is not as it was saved: it has no {name}")
    control_laws.look_in(_folder(path))  # of a law of the user's
    labels = [case.label for case in scenario.cases(configuration.load(saved.attrs["configuration"], str(path)))]
    if labels != saved.case.values.tolist():
        raise InputError(f"the study {path} is not as it was saved: configured are the cases {', '.join(labels)}")
    return saved, path


def _folder(path: Path) -> Path | None:
    """Returns the working directory that a saved study was run in; None where nothing says it."""
    try:
        return Path(json.loads(path.with_name("execution.json").read_text(encoding="utf-8"))["folder"])
    except (OSError, ValueError, TypeError, KeyError):
        return None


def changed_input(saved: Any) -> str | None:
    """Returns which of the files that a saved study read has changed since; None where its trials can be repeated."""
    from dynabot_mj import configuration, scenario

    was = json.loads(saved.attrs.get("inputs", "{}"))  # older studies do not say
    setup = configuration.load(saved.attrs["configuration"], "the study's configuration")
    return next((name for name, digest in scenario.inputs(setup).items() if was.get(name) != digest), None)


def _single(options: argparse.Namespace) -> Any:
    """Builds the configuration of one trial of one case."""
    setup = studies.build(
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
    from dynabot_mj import configuration, execution, scenario

    others = {name: name for name in ("config", "plant", "estimator", "perception", "trial", *studies.SCIENCE)}
    others["implementation"] = "filters"
    if given := [option for name, option in others.items() if getattr(options, name, None) is not None]:
        raise InputError(f"--{given[0]} given with --reproduce, which takes everything from the saved study")
    try:
        folder, label, trial = options.reproduce.rsplit(":", 2)
        number = int(trial)
    except ValueError:
        raise InputError(f"--reproduce {options.reproduce!r} given, it must be STUDY:CASE:TRIAL") from None
    saved, path = saved_study(Path(folder))
    labels = [str(one) for one in saved.case.values]
    if label not in labels:
        raise InputError(f"case {label!r} given, the study has: {', '.join(labels)}")
    if number not in saved.trial.values:
        raise InputError(f"trial {number} given, the study has {saved.trial.values[0]} to {saved.trial.values[-1]}")
    setup = configuration.load(saved.attrs["configuration"], str(path))
    if name := changed_input(saved):
        raise InputError(
            f"the {name} {getattr(setup.vehicle, name, setup.controller)!r} of {path} has changed since that study"
        )
    if (then := saved.attrs.get("versions")) != (now := execution.versions()):
        print(f"dynabot: that study was run by {then}, this is {now}: the trial may differ", file=sys.stderr)
    return scenario.one_trial(setup, label, number)
