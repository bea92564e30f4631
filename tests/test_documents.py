"""What the documents give to be typed is read as they say."""

import re
from pathlib import Path

from dynabot_mj.experiments.formation import grid
from dynabot_mj.study import campaign

DOCS = Path(__file__).parents[1] / "docs"


def test_the_campaign_of_its_document_has_twelve_cases(tmp_path):
    text = (DOCS / "campaigns.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)
    file = tmp_path / "campaign.toml"
    file.write_text(example, encoding="utf-8")
    made = campaign.load_file(file)
    labels = [entry.label for entry in made.entries]
    assert len(made.points) == 6
    assert len(labels) == 12
    assert grid.check(made, None, grid.SHOWN, []) == ["robots", "utilisation"]
    # The label that the document gives, and the rows of the table that it shows.
    assert re.search(r"`(particle/\S+)`", text).group(1) in labels
    assert len(re.findall(r"^\| (?:de)?coupled +\| \d", text, flags=re.M)) * 2 == len(labels)


def test_the_zipped_grid_of_its_document_goes_together(tmp_path):
    text = (DOCS / "campaigns.md").read_text(encoding="utf-8")
    file = tmp_path / "zip.toml"
    file.write_text(re.search(r"```\n(\[grid\.zip\].*?)```", text, flags=re.DOTALL).group(1), encoding="utf-8")
    points = [(point.setup.robots, point.setup.duration) for point in campaign.load_file(file).points]
    assert points == [(3, 80.0), (5, 120.0)]
