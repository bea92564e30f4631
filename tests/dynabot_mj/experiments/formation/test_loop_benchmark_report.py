import json

from dynabot_mj.experiments.formation import loop_benchmark, loop_benchmark_report
from dynabot_mj.experiments.formation.loop_benchmark import LoopReport, ParticleRow, RigidRow, ShareRow
from dynabot_mj.experiments.formation.stages import STAGES

REPORT = LoopReport(
    robots=3,
    repetitions=2,
    control_period_ms=36.0,
    seconds={"rigid": 2.88, "particle": 9.216},
    rigid=tuple(
        RigidRow(
            perception="gauss-markov",
            trials=trials,
            threads=threads,
            loop_us=300.0,
            raw_us=250.0,
            overhead_ratio=1.2 + 0.01 * threads,
            wall_ratio=1.5,
        )
        for trials in (10, 100)
        for threads in (1, 2)
    ),
    particle=(ParticleRow(trials=1000, env_steps_per_second=512_345.6),),
    shares=(ShareRow(plant="rigid", perception="filter", trials=100, shares=dict.fromkeys(STAGES, 1.0 / len(STAGES))),),
)


def test_the_document_is_plain_and_has_the_headline():
    document = loop_benchmark_report.document(REPORT)
    assert json.loads(json.dumps(document, allow_nan=False))["loop"]["overhead_ratio"] == 1.21
    assert loop_benchmark.HEADLINE == ("gauss-markov", 100, 1)
    assert document["loop"]["rigid"][2]["trials"] == 100


def test_the_tables_have_all_rows_and_every_stage_is_explained():
    text = loop_benchmark_report.markdown(REPORT)
    assert "overhead_ratio 1.21: rigid robots, gauss-markov, 100 trials, 1 thread." in text
    assert text.count("| gauss-markov |") == 4
    assert "512,346" in text
    assert text.count("| 16.7 ") == len(STAGES)
    for stage, what in STAGES.items():
        assert f"- {stage}: {what}" in text
