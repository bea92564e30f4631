"""A study: cases x trials -> one Dataset; `run`, `save` and `load` are handed on here.

`scenario` and `configuration` say what is asked, `assembly` makes the parts of its trials, `execution` does the work,
`dataset` holds what comes out.

Comes in: what knows of cases and trials by number. Whoever asks a question of the results belongs to `experiments`.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dynabot_mj.study.dataset import load, missing, run, save

__all__ = ["load", "missing", "run", "save"]


def __getattr__(name: str) -> Any:
    """Hands the functions of `dataset` on when they are asked for: importing them takes its time."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from dynabot_mj.study import dataset

    return getattr(dataset, name)
