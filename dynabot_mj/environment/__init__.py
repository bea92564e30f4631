"""The formation task as a `dm_env` environment: `load` makes one, docs/environment.md drives it.

Comes in: what dm_control needs of us. The only room with dm_control.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dynabot_mj.environment.task import information, load

__all__ = ["information", "load"]


def __getattr__(name: str) -> Any:
    """Hands the functions of `task` on when they are asked for: dm_control takes its time."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from dynabot_mj.environment import task

    return getattr(task, name)
