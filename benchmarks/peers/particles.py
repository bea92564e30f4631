"""Our point masses against VMAS: `python benchmarks/peers/particles.py`.

An env-step is one control period of all robots of one trial; CPU time of one thread, medians of repetitions in turn.
Two loops of ours: `whole` is what a study runs (gauss-markov error, radio, scores), `bare` has perfect information and
no scores, which is as much as VMAS does.
"""

import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
from common import versions

import dynabot_mj as dy
from dynabot_mj.common import tables
from dynabot_mj.study import assembly, fleet, scenario
from dynabot_mj.trial import loop

try:
    import torch
    import vmas
    from vmas_formation import Formation, command
except ImportError as error:
    sys.exit(f"particles.py: {error}; `make peers` installs what is missing")

ROBOTS, PERIOD, EVENTS, REPETITIONS = 3, 0.036, 256, 3
TRIALS = (1, 100, 1000, 10_000)


def ours(trials: int, *, whole: bool) -> tuple[float, float]:
    """Returns the CPU time of our loop [s], and the robots' mean distance from the leader at the end [m]."""
    decoupled = scenario.method(dy.Scenario(), "decoupled")
    setup = dy.build_scenario(
        {
            "plants": ["particle"],
            "estimators": ["decoupled" if whole else "perfect"],
            "robots": ROBOTS,
            "duration": PERIOD * EVENTS,
            "method": {
                "perfect": {
                    "sample_period": PERIOD,
                    "alpha_h": decoupled.alpha_h,
                    "alpha_d": decoupled.alpha_d,
                    "force_limit": decoupled.force_limit,
                }
            },
        }
    )
    case = dy.cases(setup)[0]
    parts = dy.make_parts(setup, case, trials=range(trials))
    assert abs(parts.clocks.sample_period - PERIOD) < 1e-9
    judges = [assembly.judge(setup, case, parts)] if whole else []
    begin = time.process_time()
    loop.simulate(parts, judges)
    spent = time.process_time() - begin
    return spent, float(np.linalg.norm(parts.plant.state.position_w, axis=-1).mean())


def theirs(trials: int) -> tuple[float, float]:
    """Returns the same of VMAS."""
    setup = dy.build_scenario({"plants": ["particle"], "estimators": ["decoupled"], "robots": ROBOTS})
    field = assembly.field(setup, "decoupled")
    start_w = dy.make_parts(setup, dy.cases(setup)[0], trials=range(trials)).plant.state.position_w
    made = vmas.make_env(
        Formation(),
        num_envs=trials,
        device="cpu",
        start_w=torch.tensor(start_w, dtype=torch.float32),
        period=PERIOD,
        mass=fleet.mass(setup),
        force_limit=field.force_limit,
    )
    agents = made.world.agents
    begin = time.process_time()
    with torch.no_grad():
        for _ in range(EVENTS):
            position_w = torch.stack([agent.state.pos for agent in agents], dim=1)
            velocity_w = torch.stack([agent.state.vel for agent in agents], dim=1)
            made.step(list(command(position_w, velocity_w, field).unbind(dim=1)))
    spent = time.process_time() - begin
    position_w = torch.stack([agent.state.pos for agent in agents], dim=1)
    return spent, float(torch.linalg.vector_norm(position_w, dim=-1).mean())


def main() -> None:
    """Prints the table."""
    torch.set_num_threads(1)
    runs: dict[str, Callable[[int], tuple[float, float]]] = {
        "whole": lambda trials: ours(trials, whole=True),
        "bare": lambda trials: ours(trials, whole=False),
        "VMAS": theirs,
    }
    body = []
    for trials in TRIALS:
        for run in runs.values():
            run(min(trials, 10))  # warms up
        found = [{name: run(trials) for name, run in runs.items()} for _ in range(REPETITIONS)]
        rate = {name: EVENTS * trials / statistics.median(one[name][0] for one in found) for name in runs}
        ratio = {name: statistics.median(one["VMAS"][0] / one[name][0] for one in found) for name in ("whole", "bare")}
        body.append(
            [
                str(trials),
                *(f"{rate[name]:,.0f}" for name in runs),
                *(f"{ratio[name]:.2f}" for name in ratio),
                f"{found[0]['bare'][1]:.2f}, {found[0]['VMAS'][1]:.2f}",
            ]
        )
    header = ["trials", "whole [1/s]", "bare [1/s]", "VMAS [1/s]", "whole/VMAS", "bare/VMAS", "bare, VMAS end at [m]"]
    print("# Point masses: env-steps per CPU-second\n")
    print("\n".join(tables.aligned(header, body)))
    print(
        f"\n{ROBOTS} robots, {1e3 * PERIOD:.0f} ms; medians of {REPETITIONS} repetitions of {EVENTS} periods, in turn."
    )
    print(f"Above 1 ours does more. Ours has double, VMAS single precision. {versions('numpy', 'torch', 'vmas')}.")


if __name__ == "__main__":
    main()
