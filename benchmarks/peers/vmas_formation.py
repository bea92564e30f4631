"""The formation task as a VMAS scenario: the same field, robots and period as those of our point masses.

VMAS integrates velocity, then position, with single precision; ours is exact between two commands. Robots know
themselves and each other exactly and at once: VMAS has no estimators and no radio.
"""

import torch
from vmas.simulator.core import Agent, Sphere, World
from vmas.simulator.scenario import BaseScenario

from dynabot_mj.controllers.potential_field import PotentialField, Well


class Formation(BaseScenario):
    """Point masses that do not collide; `make_env` hands on `start_w`, `mass` and `period`."""

    def make_world(self, batch_dim: int, device: torch.device, **kwargs: object) -> World:
        """Returns the world, without drag: the dissipation is part of the command, as the paper has it."""
        self.start_w = kwargs.pop("start_w")  # (B, n, 2) [m]
        self.force_limit = kwargs.pop("force_limit")  # [N]
        world = World(batch_dim, device, dt=kwargs.pop("period"), drag=0.0)
        mass = kwargs.pop("mass")
        for robot in range(self.start_w.shape[1]):
            world.add_agent(
                Agent(
                    name=f"robot_{robot}",
                    shape=Sphere(radius=0.25),
                    mass=mass,
                    collide=False,
                    rotatable=False,
                    u_range=2.0 * self.force_limit,  # an assertion, not a limit: the law keeps its norm
                )
            )
        return world

    def reset_world_at(self, env_index: int | None = None) -> None:
        """Puts the robots at their starts, at rest."""
        for robot, agent in enumerate(self.world.agents):
            start_w = self.start_w[:, robot]
            agent.set_pos(start_w if env_index is None else start_w[env_index], batch_index=env_index)

    def observation(self, agent: Agent) -> torch.Tensor:
        """Returns where a robot is [m]."""
        return agent.state.pos

    def reward(self, agent: Agent) -> torch.Tensor:
        """Returns nothing: nobody learns here."""
        return torch.zeros(self.world.batch_dim)


def command(position_w: torch.Tensor, velocity_w: torch.Tensor, field: PotentialField) -> torch.Tensor:
    """Returns the force on each robot, (B, n, 2) [N], of `dynabot_mj.controllers.potential_field`; leader at 0."""
    offset_w = position_w[:, :, None] - position_w[:, None]  # a robot exerts no force on itself: the offset is 0
    force_w = _attraction(position_w, field.leader) + _attraction(offset_w, field.neighbour).sum(dim=2)
    force_w = force_w - field.dissipation * velocity_w
    norm = torch.linalg.vector_norm(force_w, dim=-1, keepdim=True)
    return force_w * (field.force_limit / norm.clamp(min=field.force_limit))


def _attraction(offset_w: torch.Tensor, well: Well) -> torch.Tensor:
    distance = torch.linalg.vector_norm(offset_w, dim=-1, keepdim=True)
    r = distance.clamp(min=well.closest)
    s = torch.where(r <= well.radius, r, (r - well.width).clamp(min=well.radius))
    slope = torch.where(r <= well.range, well.gain * (1.0 / s - well.radius / (s * s)), 0.0)
    return -slope / distance.clamp(min=1e-12) * offset_w
