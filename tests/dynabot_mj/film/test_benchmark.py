"""What is told of a film's cost; it is measured in the test of the command."""

import json

from dynabot_mj.film import benchmark
from dynabot_mj.film.shot import OVERLAYS

ROWS = [
    benchmark.DrawingRate(
        width=width,
        height=height,
        frames_per_second=25.4,
        bare_per_second=60.0,
        overlays_ms={name: index - 0.04 for index, name in enumerate(OVERLAYS)},
        smooth_ms=7.25,
        encoded_per_second=120.0,
    )
    for width, height in ((1280, 720), (640, 480))
]


def test_the_table_has_a_column_for_each_size_and_a_line_for_each_overlay():
    lines = [line for line in benchmark.markdown(ROWS, 3, 2).splitlines() if line.startswith("| ")]
    cells = {line.split("|")[1].strip(): [cell.strip() for cell in line.split("|")[2:-1]] for line in lines}
    assert cells[""] == ["1280x720", "640x480"]
    assert cells["frames/s, everything on"] == ["25", "25"]
    assert set(cells) >= {f"{name} [ms]" for name in OVERLAYS}
    assert cells[f"{OVERLAYS[0]} [ms]"] == ["0.0", "0.0"]  # and not -0.0
    assert cells[f"{OVERLAYS[2]} [ms]"] == ["2.0", "2.0"]


def test_the_document_is_plain():
    document = json.loads(json.dumps(benchmark.document(ROWS, 3, 2), allow_nan=False))
    assert (document["video"]["robots"], document["video"]["pictures"]) == (3, 2)
    assert document["video"]["rows"][1]["overlays_ms"] == ROWS[1].overlays_ms
