"""What was measured of the loop, as tables and as a document."""

from dataclasses import asdict
from typing import Any

from dynabot_mj.common import tables
from dynabot_mj.experiments.formation import loop_benchmark
from dynabot_mj.experiments.formation.loop_benchmark import ESTIMATOR, LoopReport
from dynabot_mj.experiments.formation.stages import STAGES


def document(report: LoopReport) -> dict[str, Any]:
    """Returns the JSON document."""
    return {"loop": {"estimator": ESTIMATOR, "overhead_ratio": report.overhead_ratio, **asdict(report)}}


def markdown(report: LoopReport) -> str:
    """Returns the report as tables and what they mean."""
    perception, trials, threads = loop_benchmark.HEADLINE
    repetitions, period = report.repetitions, f"{report.control_period_ms:.0f} ms"
    rigid_s, particle_s = (f"{report.seconds[plant]:.2f} s" for plant in ("rigid", "particle"))
    rigid = [
        [
            row.perception,
            str(row.trials),
            str(row.threads),
            f"{row.loop_us:.0f}",
            f"{row.raw_us:.0f}",
            f"{row.overhead_ratio:.2f}",
            f"{row.wall_ratio:.2f}",
        ]
        for row in report.rigid
    ]
    particle = [[str(row.trials), f"{row.env_steps_per_second:,.0f}"] for row in report.particle]
    shares = [
        [row.plant, row.perception, str(row.trials), *(f"{100.0 * row.shares[stage]:.1f}" for stage in STAGES)]
        for row in report.shares
    ]
    lines = [
        f"# Cost of the loop, {report.robots} robots",
        "",
        f"overhead_ratio {report.overhead_ratio:.2f}: rigid robots, {perception}, {trials} trials, {threads} thread.",
        "",
        "Rigid loop against the raw engine:",
        "",
        *tables.aligned(
            ["perception", "trials", "threads", "loop [us]", "raw [us]", "overhead ratio", "of wall time"], rigid
        ),
        "",
        f"CPU time of an env-step, which is one control period ({period}, estimator {ESTIMATOR}) of all robots of one",
        f"trial; medians of {repetitions} repetitions of {rigid_s}, in which loop and engine take turns. Raw: MuJoCo's",
        "batch sets the motors' recorded commands of the same run again, with one call for each period of the local",
        "laws. A ratio of 1 would be a loop that costs nothing. Of wall time: the same, where threads share the",
        "physics and not the loop.",
        "",
        "Loop of point masses:",
        "",
        *tables.aligned(["trials", "env-steps per CPU-second"], particle),
        "",
        f"With {perception} error, radio and scores; medians of {repetitions} repetitions of {particle_s}.",
        "",
        "Shares of the stages [%]:",
        "",
        *tables.aligned(["plant", "perception", "trials", *STAGES], shares),
        "",
        "Of CPU time, one run each:",
        "",
        *(f"- {stage}: {what}" for stage, what in STAGES.items()),
    ]
    return "\n".join(lines) + "\n"
