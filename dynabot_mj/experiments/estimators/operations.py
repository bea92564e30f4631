"""Counts the floating-point operations of NumPy code by running it on arrays that count.

One operation is an addition, subtraction, multiplication, division, remainder, power, or elementary function of one
element. A product of (m, k) and (k, n) has m n (2 k - 1), zeros included: that is how dense code computes it. An
inverse of (n, n) has 2 n^3 (LU factors, then the inverse from them). Moving, comparing and changing signs is free.

What is computed from counting arrays counts too; arrays built of single numbers (`np.array`, `np.diag` of a list) do
not, so that the few operations on constants and on periods alone, such as the square of a decay, are missing. SciPy's
functions take counting arrays for ordinary ones; what they do has to be added.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Self

import numpy as np
import numpy.typing as npt

_COSTING = {
    *(np.add, np.subtract, np.multiply, np.divide, np.remainder, np.power, np.square, np.sqrt),
    *(np.exp, np.sin, np.cos),
}
_FREE = {
    *(np.negative, np.positive, np.maximum, np.minimum, np.isfinite, np.logical_and, np.logical_not),
    *(np.less, np.less_equal, np.greater, np.greater_equal, np.equal),
    *(np.concatenate, np.stack, np.diag, np.diagonal, np.swapaxes, np.copy, np.empty_like, np.zeros_like),
    *(np.where, np.reshape, np.transpose, np.atleast_2d),
}


class Tally:
    """How many operations there have been."""

    def __init__(self) -> None:
        """Starts at none."""
        self.count = 0


class Counted(np.ndarray[Any, np.dtype[np.float64]]):
    """An array whose operations are added to a tally; numbers taken from it are 0-d arrays that count as well."""

    _tally: Tally

    def __new__(cls, values: npt.ArrayLike, tally: Tally) -> Self:
        """Takes values, not copied.

        Args:
            values: Any shape.
            tally: Where operations are counted.
        """
        found = np.asarray(values).view(cls)
        found._tally = tally
        return found

    def __array_finalize__(self, source: Any) -> None:
        """Gives a view its source's tally."""
        if isinstance(source, Counted):
            self._tally = source._tally

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, out: Any = (), **options: Any) -> Any:
        """Computes and counts."""
        plain = [_plain(one) for one in inputs]
        if out:
            options["out"] = tuple(_plain(one) for one in out)
        result = getattr(ufunc, method)(*plain, **options)
        self._tally.count += _cost(ufunc, method, plain, result)
        return out[0] if out else self._counting(result)

    def __array_function__(
        self, func: Callable[..., Any], types: Any, args: Iterable[Any], kwargs: Mapping[str, Any]
    ) -> Any:
        """Computes and counts."""
        plain = [_plain(one) for one in args]
        result = func(*plain, **{name: _plain(one) for name, one in kwargs.items()})
        self._tally.count += _function_cost(func, plain, result)
        return self._counting(result)

    def __getitem__(self, index: Any) -> Any:
        """Returns a part, a single number too, that counts."""
        return self._counting(self.view(np.ndarray)[index])

    def dot(self, other: Any, out: Any = None) -> Any:
        """Returns the product; the method of an array is not a function that arrays can override otherwise."""
        return np.dot(self, other, out)

    def _counting(self, result: Any) -> Any:
        return Counted(result, self._tally)


def inverse(size: int) -> int:
    """Returns the operations of inverting a matrix of so many rows."""
    return 2 * size**3


def _plain(value: Any) -> Any:
    if isinstance(value, Counted):
        return value.view(np.ndarray)
    if isinstance(value, list | tuple):
        return type(value)(_plain(one) for one in value)
    return value


def _cost(ufunc: np.ufunc, method: str, inputs: Sequence[Any], result: Any) -> int:
    if ufunc is np.matmul:
        return _product(inputs[0], result)
    if ufunc in _FREE:
        return 0
    if ufunc in _COSTING and method == "__call__":
        return int(np.size(result))
    if ufunc in _COSTING and method == "reduce":
        return int(np.size(inputs[0]) - np.size(result))
    raise NotImplementedError(f"cost of {ufunc.__name__}.{method}")


def _function_cost(func: Callable[..., Any], inputs: Sequence[Any], result: Any) -> int:
    if func is np.dot:
        # By a number it is an ordinary multiplication.
        return _product(inputs[0], result) if np.ndim(inputs[0]) and np.ndim(inputs[1]) else int(np.size(result))
    if func is np.outer:
        return int(np.size(result))
    if func is np.linalg.inv:
        return inverse(inputs[0].shape[-1]) * int(np.prod(inputs[0].shape[:-2]))
    if func in _FREE:
        return 0
    raise NotImplementedError(f"cost of {func.__name__}")


def _product(first: Any, result: Any) -> int:
    """Returns m n (2 k - 1), times the number of products in a batch."""
    return int(np.size(result)) * (2 * np.shape(first)[-1] - 1)
