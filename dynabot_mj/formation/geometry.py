"""The geometry of a formation: how far robots are from a regular polygon, and whether two footprints overlap.

Which polygon fits best is a choice that the paper leaves open. With positions and corners as complex numbers z_i and
R e^{i t} u^{k_i}, u = e^{2 pi i / n}, the polygon is turned by t and corner k_i given to robot i so that

least-squares   the sum of the squared distances is smallest: it is sum |z_i|^2 + n R^2 - 2 R Re(e^{-i t} S) with
                S = sum z_i u^{-k_i}, so the best turn is arg S and the best assignment that of the largest |S|;
largest-error   the largest distance is smallest: each squared distance is a constant less a cosine of t, so the
                lowest point of their maximum is the lowest point of one of them or where two of them meet.
"""

import itertools
from typing import Literal, get_args

import numpy as np

from dynabot_mj.common.arrays import Array, BoolArray

Fit = Literal["least-squares", "largest-error"]
FITS: tuple[Fit, ...] = get_args(Fit)


def polygon_error(position_w: Array, radius: float, fit: Fit = "least-squares") -> Array:
    """Returns the largest distance of a robot from its corner of the best-fitting regular polygon around the origin.

    Args:
        position_w: Relative to the leader, (..., n, 2) [m].
        radius: R of the polygon [m].
        fit: What "best" means, see the module.

    Returns:
        (...) [m].
    """
    n = position_w.shape[-2]
    z = position_w[..., 0] + 1j * position_w[..., 1]
    unit = np.exp(2j * np.pi * np.arange(n) / n)
    # Turning permutes the corners cyclically, so robot 0 may keep corner 0.
    assigned = (unit[[0, *rest]] for rest in itertools.permutations(range(1, n)))
    if fit == "largest-error":
        smallest = np.full(z.shape[:-1], np.inf)
        for corners in assigned:
            smallest = np.minimum(smallest, _smallest_maximum(z * corners.conj(), radius))
        return smallest
    best = np.zeros(z.shape[:-1], dtype=complex)
    corner = np.broadcast_to(unit, z.shape)
    for corners in assigned:
        resultant = (z * corners.conj()).sum(axis=-1)
        better = np.abs(resultant) > np.abs(best)
        best = np.where(better, resultant, best)
        corner = np.where(better[..., None], corners, corner)
    turn = np.exp(1j * np.angle(best))
    return np.abs(z - radius * turn[..., None] * corner).max(axis=-1)


def _smallest_maximum(turned: Array, radius: float) -> Array:
    """Returns the smallest largest distance over all turns of the polygon.

    Args:
        turned: z_i u^{-k_i}, (..., n) complex [m].
        radius: R of the polygon [m].

    Returns:
        (...) [m].
    """
    n = turned.shape[-1]
    square = np.abs(turned) ** 2 + radius**2  # of the distance at turn t: square - 2 R Re(e^{-i t} turned)
    first, second = np.triu_indices(n, 1)
    apart = 2.0 * radius * (turned[..., first] - turned[..., second])
    with np.errstate(divide="ignore", invalid="ignore"):  # two robots on one spot meet everywhere, or nowhere
        reach = np.arccos((square[..., first] - square[..., second]) / np.abs(apart))
    meeting = [np.angle(apart) + sign * reach for sign in (1.0, -1.0)]
    turns = np.concatenate([np.angle(turned), *meeting], axis=-1)
    squared = square[..., None, :] - 2.0 * radius * np.real(np.exp(-1j * turns)[..., None] * turned[..., None, :])
    largest = np.where(np.isfinite(turns), squared.max(axis=-1), np.inf)
    return np.sqrt(np.maximum(largest.min(axis=-1), 0.0))


def footprints_touch(offset_w: Array, heading_a: Array, heading_b: Array, length: float, breadth: float) -> BoolArray:
    """Tells whether two equal oriented rectangles overlap, by the separating-axis theorem.

    Args:
        offset_w: Centre of b minus centre of a, (..., 2) [m].
        heading_a: (...,) [rad].
        heading_b: (...,) [rad].
        length: Along the heading [m].
        breadth: Across it [m].

    Returns:
        (...,).
    """
    cos_ab, sin_ab = np.abs(np.cos(heading_b - heading_a)), np.abs(np.sin(heading_b - heading_a))
    along = (length + length * cos_ab + breadth * sin_ab) / 2.0
    across = (breadth + length * sin_ab + breadth * cos_ab) / 2.0
    touch = np.ones(offset_w.shape[:-1], dtype=bool)
    for heading in (heading_a, heading_b):
        forward = np.cos(heading) * offset_w[..., 0] + np.sin(heading) * offset_w[..., 1]
        left = np.cos(heading) * offset_w[..., 1] - np.sin(heading) * offset_w[..., 0]
        touch &= (np.abs(forward) <= along) & (np.abs(left) <= across)
    return touch


def neighbour_distances(position_w: Array) -> Array:
    """Returns the distances of robots that follow each other in bearing around the leader.

    Args:
        position_w: Relative to the leader, (..., n, 2) [m].

    Returns:
        (..., n) [m]: the sides of the polygon that the robots span.
    """
    bearing = np.arctan2(position_w[..., 1], position_w[..., 0])
    order = np.argsort(bearing, axis=-1, kind="stable")
    around = np.take_along_axis(position_w, order[..., None], axis=-2)
    side = np.roll(around, -1, axis=-2) - around
    return np.hypot(side[..., 0], side[..., 1])
