"""Where robots start: at rest in a regular polygon, turned at random, left of the leader."""

from collections.abc import Sequence

import numpy as np

from dynabot_mj.common.arrays import Array
from dynabot_mj.common.streams import Purpose, generators
from dynabot_mj.controllers.potential_field import polygon_circumradius
from dynabot_mj.formation.leader import LEADER_W
from dynabot_mj.formation.options import StartOptions


def starts(options: StartOptions, robots: int, seed: int, trials: Sequence[int]) -> tuple[Array, Array]:
    """Draws the starts of some trials.

    Args:
        options: Size and place of the polygon, and where robots head.
        robots: n.
        seed: Of all random numbers.
        trials: Numbers of the trials, length B.

    Returns:
        Positions, (B, n, 2) [m], and headings, (B, n) [rad].
    """
    turn = np.array([g.random() for g in generators(seed, trials, Purpose.START)]) * 2.0 * np.pi
    corner = turn[:, None] + 2.0 * np.pi * np.arange(robots) / robots
    radius = polygon_circumradius(options.spacing, robots)
    centroid_w = LEADER_W - np.array([options.distance, 0.0])
    position_w = centroid_w + radius * np.stack([np.cos(corner), np.sin(corner)], axis=-1)
    if options.headings == "leader":
        to_leader = LEADER_W - position_w
        return position_w, np.arctan2(to_leader[..., 1], to_leader[..., 0])
    uniform = np.array([g.random(robots) for g in generators(seed, trials, Purpose.HEADING)])
    return position_w, (2.0 * uniform - 1.0) * np.pi
