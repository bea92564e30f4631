"""Best-fit paths: an estimated path beside the actual one, of which the shape is known and the place is fitted.

circle        centre c and radius r that minimise  sum_k (|p_k - c| - r)^2        geometric, by Gauss and Newton
line          through the mean, along the direction of the largest spread          total least squares
any path      rotation R and shift t that minimise  sum_k |p_k - (R q_k + t)|^2    Procrustes; q_k is the true place
              at the time of p_k

So no fit sees a shift of the whole estimate, and those of the path and of the line no turn of it either.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import spatial

from dynabot_mj.common.arrays import Array
from dynabot_mj.experiments.estimators.kinematic import PathName

_ITERATIONS = 50
_ENOUGH = 1e-12  # change of centre and radius at which the iteration ends, share of the radius


@dataclass(frozen=True, kw_only=True)
class BestFit:
    """The paths fitted to the estimates of R runs at N times."""

    path_w: Array  # (K, R, 2) points along the fitted path, to draw it [m]
    nearest_w: Array  # (N, R, 2) its points that are nearest to the estimates [m]
    distance: Array  # (N, R) of the estimates from it [m]


@dataclass(frozen=True, kw_only=True)
class Circle:
    """Circles of R runs."""

    centre_w: Array  # (R, 2) [m]
    radius: Array  # (R,) [m]


def fit(shape: PathName, estimate_w: Array, truth_w: Array) -> BestFit:
    """Fits paths of a shape to estimated ones.

    Args:
        shape: Of the actual path.
        estimate_w: Estimated positions, (N, R, 2) [m].
        truth_w: True positions at the same times, (N, R, 2) [m].
    """
    match shape:
        case "circle":
            path_w, nearest_w = _on_circle(estimate_w)
        case "line":
            path_w, nearest_w = _on_line(estimate_w)
        case "figure-eight":
            path_w = moved_rigidly(truth_w, estimate_w)
            nearest_w = _nearest(path_w, estimate_w)
    return BestFit(path_w=path_w, nearest_w=nearest_w, distance=np.linalg.norm(estimate_w - nearest_w, axis=-1))


def circle(position_w: Array) -> Circle:
    """Fits circles to points.

    Args:
        position_w: (N, R, 2) [m].
    """
    mean_w = position_w.mean(axis=0)
    points = position_w - mean_w  # about their mean, where the normal equations are well conditioned
    # Begins with the algebraic fit, |p|^2 = 2 c p + (r^2 - |c|^2).
    design = np.concatenate([2.0 * points, np.ones((*points.shape[:2], 1))], axis=-1)
    solution = _least_squares(design, (points**2).sum(axis=-1))
    centre = solution[:, :2]
    radius = np.sqrt(np.maximum(solution[:, 2] + (centre**2).sum(axis=-1), 0.0))
    for _ in range(_ITERATIONS):
        offset = points - centre
        distance = np.linalg.norm(offset, axis=-1)
        outward = offset / np.maximum(distance, 1e-12)[..., None]
        design = np.concatenate([outward, np.ones((*points.shape[:2], 1))], axis=-1)
        step = _least_squares(design, distance - radius)
        centre, radius = centre + step[:, :2], radius + step[:, 2]
        if (np.abs(step) <= _ENOUGH * np.abs(radius)[:, None]).all():
            break
    return Circle(centre_w=centre + mean_w, radius=radius)


def moved_rigidly(path_w: Array, onto_w: Array) -> Array:
    """Returns paths turned and shifted to where they fit others best, point by point.

    Args:
        path_w: (N, R, 2) [m].
        onto_w: (N, R, 2) [m].
    """
    mean_w, onto_mean_w = path_w.mean(axis=0), onto_w.mean(axis=0)
    # In the plane, points are complex numbers and a rotation is a product.
    path, onto = _complex(path_w - mean_w), _complex(onto_w - onto_mean_w)
    turn = np.exp(1j * np.angle((path.conj() * onto).sum(axis=0)))
    turned = turn * path
    return np.stack([turned.real, turned.imag], axis=-1) + onto_mean_w


def _on_circle(estimate_w: Array) -> tuple[Array, Array]:
    """Returns points around the best-fit circles and those nearest to the estimates."""
    found = circle(estimate_w)
    angle = np.linspace(0.0, 2.0 * math.pi, 361)[:, None]
    around = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    offset = estimate_w - found.centre_w
    outward = offset / np.maximum(np.linalg.norm(offset, axis=-1, keepdims=True), 1e-12)
    radius = found.radius[:, None]
    return found.centre_w + radius * around, found.centre_w + radius * outward


def _on_line(estimate_w: Array) -> tuple[Array, Array]:
    """Returns the ends of the best-fit lines and the points on them that are nearest to the estimates."""
    mean_w = estimate_w.mean(axis=0)
    offset = estimate_w - mean_w
    spread = np.einsum("kri,krj->rij", offset, offset)
    along = np.linalg.eigh(spread).eigenvectors[..., -1]
    way = (offset * along).sum(axis=-1)
    ends = np.stack([way.min(axis=0), way.max(axis=0)])
    return mean_w + ends[..., None] * along, mean_w + way[..., None] * along


def _nearest(path_w: Array, point_w: Array) -> Array:
    """Returns the points of paths, taken as straight between their own points, that are nearest to others."""
    nearest_w = np.empty_like(point_w)
    for run in range(path_w.shape[1]):
        path, points = path_w[:, run], point_w[:, run]
        index = spatial.KDTree(path).query(points)[1]
        near = path[index]
        best = np.linalg.norm(points - near, axis=-1)
        # The nearest place is on one of the two pieces that meet in the nearest corner, or is that corner.
        for neighbour in (np.maximum(index - 1, 0), np.minimum(index + 1, len(path) - 1)):
            piece = path[neighbour] - path[index]
            length = np.maximum((piece**2).sum(axis=-1), 1e-12)
            share = np.clip(((points - path[index]) * piece).sum(axis=-1) / length, 0.0, 1.0)
            candidate = path[index] + share[:, None] * piece
            distance = np.linalg.norm(points - candidate, axis=-1)
            closer = distance < best
            near, best = np.where(closer[:, None], candidate, near), np.where(closer, distance, best)
        nearest_w[:, run] = near
    return nearest_w


def _least_squares(design: Array, values: Array) -> Array:
    """Returns x that minimises |A x - b|^2, (R, m), from A, (N, R, m), and b, (N, R).

    By the pseudo-inverse, so that points which determine no circle (all the same, or on a line) give some answer.
    """
    normal = np.einsum("kri,krj->rij", design, design)
    return (np.linalg.pinv(normal, hermitian=True) @ np.einsum("kri,kr->ri", design, values)[..., None])[..., 0]


def _complex(vector: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    return vector[..., 0] + 1j * vector[..., 1]
