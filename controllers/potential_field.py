"""The artificial potential field, Eq. 8 of the paper, and the total force commanded on a robot.

The leader and every robot are centres of a radially symmetric potential with a flat-floored circular well,

    V(r) = alpha (ln s + r0 / s),    s = r up to r0,    s = r0 on the floor r0 .. r0 + eps,    s = r - eps up to r_l,

constant beyond r_l. The force is minus its gradient: repulsive inside r0, zero on the floor, attractive up to r_l, zero
beyond, with a jump at r_l. The total command on a robot adds the dissipation -c v and is limited in norm:

    F = sat(-grad V_leader - sum_j grad V_j - c v,  F_max).

V is singular at r = 0; below `closest` it continues as a straight line, so the force stays finite and conservative.
The paper calls the well's radius h0 and its range h_l for the leader, d0 and d_l for the robots.
"""

import math
from dataclasses import dataclass

import numpy as np

from dynabot_mj.controllers.arrays import Array, BoolArray


@dataclass(frozen=True, kw_only=True)
class Well:
    """One radially symmetric potential."""

    gain: float  # alpha_h or alpha_d [N m]
    radius: float  # h0 or d0, where the floor begins [m]
    width: float  # epsilon, of the floor [m]
    range: float  # h_l or d_l, where the attraction ends [m]
    closest: float = 0.05  # distance below which the force no longer grows [m]


@dataclass(frozen=True, kw_only=True)
class PotentialField:
    """The field that a robot moves in."""

    leader: Well
    neighbour: Well
    dissipation: float  # c [N s/m]
    force_limit: float = np.inf  # F_max, of the norm of the total command [N]


def potential(distance: Array, well: Well) -> Array:
    """Returns V(r), Eq. 8.

    Args:
        distance: r, any shape [m].
        well: The potential's parameters.

    Returns:
        V of the same shape [N m].
    """
    r = np.maximum(distance, well.closest)
    outer = np.minimum(r, well.range) - well.width
    s = np.where(r <= well.radius, r, np.maximum(outer, well.radius))
    below = np.minimum(distance - well.closest, 0.0)
    return well.gain * (np.log(s) + well.radius / s) + below * slope(r, well)


def slope(distance: Array, well: Well) -> Array:
    """Returns dV/dr of Eq. 8, positive where the centre attracts.

    Args:
        distance: r, any shape [m].
        well: The potential's parameters.

    Returns:
        dV/dr of the same shape [N].
    """
    r = np.maximum(distance, well.closest)
    s = np.where(r <= well.radius, r, np.maximum(r - well.width, well.radius))
    # On the floor s = radius, where the bracket is zero by itself.
    return np.where(r <= well.range, well.gain * (1.0 / s - well.radius / (s * s)), 0.0)


def attraction(offset_w: Array, well: Well) -> Array:
    """Returns -grad V, the force of one centre on a robot.

    Args:
        offset_w: Robot's position minus the centre's, (..., 2) [m].
        well: The potential's parameters.

    Returns:
        Force on the robot, (..., 2) [N]; zero where the two coincide, since no direction is given there.
    """
    x, y = offset_w[..., 0], offset_w[..., 1]
    distance = np.sqrt(x * x + y * y)
    with np.errstate(invalid="ignore", divide="ignore"):
        per_metre = np.where(distance > 0.0, -slope(distance, well) / distance, 0.0)
    return per_metre[..., None] * offset_w


def saturate(force_w: Array, limit: float) -> Array:
    """Returns the force with its norm limited and its direction kept, (..., 2) [N]."""
    if not math.isfinite(limit):
        return force_w
    squares = force_w * force_w
    norm = np.sqrt(squares[..., 0] + squares[..., 1])
    return force_w * (limit / np.maximum(norm, limit))[..., None]


def total_force(
    position_w: Array,
    velocity_w: Array,
    leader_w: Array,
    neighbours_w: Array,
    known: BoolArray,
    field: PotentialField,
) -> Array:
    """Returns the total command on each robot: field and dissipation, limited in norm.

    Args:
        position_w: Each robot's belief of its own position, (..., n, 2) [m].
        velocity_w: Each robot's belief of its own velocity, (..., n, 2) [m/s].
        leader_w: Position of the leader, (2,) [m].
        neighbours_w: What robot i believes of the position of robot j at [..., i, j, :], (..., n, n, 2) [m].
        known: Whether robot i knows anything of robot j, (..., n, n). One that it never heard of, and itself, exerts no
            force; the corresponding positions are ignored.
        field: The field's parameters.

    Returns:
        Forces, (..., n, 2) [N].
    """
    from_neighbours = attraction(position_w[..., :, None, :] - neighbours_w, field.neighbour)
    from_neighbours = np.where(known[..., None], from_neighbours, 0.0)
    force_w = attraction(position_w - leader_w, field.leader) - field.dissipation * velocity_w
    for sender in range(neighbours_w.shape[-2]):
        force_w = force_w + from_neighbours[..., sender, :]
    return saturate(force_w, field.force_limit)


def polygon_circumradius(side: float, robots: int) -> float:
    """Returns the radius of the circle through the corners of a regular polygon: h0 = d0 / (2 sin(pi / n)) [m].

    Args:
        side: d0, between neighbouring corners [m].
        robots: n, number of corners, at least 2.
    """
    return float(side / (2.0 * np.sin(np.pi / robots)))
