"""A filter of the user's, with what it returns checked: a mistake is one line that names the method."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.estimation.estimator import Filter, Rows
from dynabot_mj.estimation.kalman import Update
from dynabot_mj.estimation.measurements import GpsFix, ImuSample
from dynabot_mj.host import user_code

# Of the protocol `Filter`.
METHODS_OF_A_FILTER = (
    *("begin", "predict", "see_heading", "see_fix"),
    *("believe_heading", "believe_fix", "sound", "beliefs"),
)
_BELIEFS: dict[str, tuple[int, ...]] = {  # fields of `Estimate` that a filter knows, behind the robots' axis
    "position_w": (2,),
    "velocity_w": (2,),
    "heading": (),
    "yaw_rate_bias": (),
    "acceleration_bias_b": (2,),
    "position_covariance": (2, 2),
    "velocity_covariance_b": (2, 2),
    "heading_variance": (),
}


class CheckedFilter:
    """A filter of M robots: an `dynabot_mj.estimation.estimator.Filter`."""

    def __init__(self, method: str, wrapped: Filter, count: int) -> None:
        """Takes a filter.

        Args:
            method: Whose it is, for the messages.
            wrapped: The user's.
            count: M.
        """
        self._wrapped, self._count = wrapped, count
        self._what = f"method {method}: {type(wrapped).__name__}"
        self._begun = np.zeros(count, dtype=bool)

    def __getattr__(self, name: str) -> Any:
        """Hands on what else a filter has, such as `moments`, for whoever asks whether it has."""
        return getattr(self._wrapped, name)

    def begin(self, rows: Rows, fix: GpsFix, magnetic_heading: Array) -> None:
        """Starts with a first fix and magnetic heading."""
        self._call("begin", rows, fix, magnetic_heading)
        self._begun[rows] = True

    def predict(self, rows: Rows, imu: ImuSample) -> None:
        """Carries the state over a sampling period."""
        self._call("predict", rows, imu)

    def see_heading(self, rows: Rows, magnetic_heading: Array) -> Update:
        """Takes a magnetic heading."""
        return self._update("see_heading", self._call("see_heading", rows, magnetic_heading), len(magnetic_heading))

    def see_fix(self, rows: Rows, fix: GpsFix, force_b: Array) -> Sequence[Update]:
        """Takes a fix, in one update or several."""
        found = self._call("see_fix", rows, fix, force_b)
        if not isinstance(found, list | tuple) or not found:
            raise InputError(f"{self._what}.see_fix returned {found!r}, it must be a list of one `Update` or more")
        return [self._update("see_fix", one, len(fix.age)) for one in found]

    def believe_heading(self, rows: Rows, magnetic_heading: Array) -> None:
        """Sets the heading to a magnetic heading."""
        self._call("believe_heading", rows, magnetic_heading)

    def believe_fix(self, rows: Rows, fix: GpsFix) -> None:
        """Sets position and velocity to a fix."""
        self._call("believe_fix", rows, fix)

    def sound(self) -> BoolArray:
        """Tells where all numbers are finite and all variances positive, (M,)."""
        found = self._shaped("sound", "an array", self._call("sound"), (self._count,)).astype(bool)
        self._begun &= found
        return found

    def beliefs(self) -> dict[str, Array]:
        """Returns the fields of `Estimate` that a filter knows, (M, ...)."""
        found = self._call("beliefs")
        given = set(found) if isinstance(found, dict) else set()
        if given != set(_BELIEFS):
            told = ", ".join(sorted(map(str, given))) or "no dict"
            raise InputError(f"{self._what}.beliefs returned {told}; it must be a dict of {', '.join(_BELIEFS)}")
        checked = {}
        for name, tail in _BELIEFS.items():
            values = self._shaped("beliefs", name, found[name], (self._count, *tail)).astype(float, copy=False)
            if not np.isfinite(values[self._begun]).all():
                raise InputError(f"{self._what}.beliefs returned a {name} that is not finite, where sound() is true")
            checked[name] = values
        return checked

    def _call(self, name: str, *arguments: Any) -> Any:
        with user_code.called(f"{self._what}.{name} failed"):
            return getattr(self._wrapped, name)(*arguments)

    def _update(self, name: str, update: Any, count: int) -> Update:
        if not isinstance(update, Update):
            raise InputError(f"{self._what}.{name} returned {type(update).__name__}, it must be an `Update`")
        for field in ("squared", "accepted"):
            self._shaped(name, f"an update's {field}", getattr(update, field), (count,))
        return update

    def _shaped(self, name: str, part: str, value: Any, shape: tuple[int, ...]) -> Array:
        array = np.asarray(value)
        if array.shape != shape:
            raise InputError(f"{self._what}.{name} returned {part} of shape {array.shape}, it must be {shape}")
        return array
