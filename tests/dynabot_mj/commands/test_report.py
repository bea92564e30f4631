import json

import pytest

from dynabot_mj import study
from dynabot_mj.study import configuration


@pytest.fixture(scope="module")
def tiny():
    """A study of one second, of one case."""
    return study.run(configuration.build({}, trials=1, duration=1.0, estimators=["gps"], plants=["particle"]))


@pytest.fixture
def results(tiny, tmp_path):
    study.save(tiny, tmp_path / "study.nc")
    return tmp_path


def test_the_page_and_its_tables_are_written_beside_the_study(dynabot, results):
    (results / "execution.json").write_text(json.dumps({"command": "dynabot compare --trials 1"}))
    done = dynabot("report", results)
    assert done.returncode == 0
    assert done.stdout.startswith(f"{results / 'report.html'}: ")
    assert len(done.stdout.splitlines()) == 1
    page = (results / "report.html").read_text(encoding="utf-8")
    assert "dynabot compare --trials 1" in page
    # One plant has nothing to be compared with.
    assert sorted(file.name for file in (results / "tables").iterdir()) == ["cases.csv", "circle.csv", "trials.csv"]
    assert "What the body changes" not in page


@pytest.mark.usefixtures("small_report")
def test_another_place_may_be_chosen_and_the_document_says_where(main, results, tmp_path):
    page = tmp_path / "elsewhere" / "page.html"
    told = json.loads(main("report", results, "--out", page, "--json").stdout)
    assert told["page"] == str(page)
    assert told["bytes"] == page.stat().st_size
    assert all((tmp_path / "elsewhere" / "page_tables" / name).is_file() for name in ("cases.csv", "trials.csv"))
    assert not (results / "report.html").exists()


def test_a_page_goes_with_its_study_and_never_over_tables_of_the_user(main, small_report, tmp_path):
    line = ["compare", "--trials", 1, "--duration", 2, "--plants", "particle", "--estimators", "gps"]
    place = tmp_path / "out" / "compare"
    main(*line, cwd=tmp_path)
    (place / "tables").mkdir()
    (place / "tables" / "mine.csv").write_text("mine")
    refused = main("report", "out/compare", cwd=tmp_path)
    assert refused.returncode == 2
    assert "mine.csv is in the place of our results and none of them" in refused.stderr
    (place / "tables" / "mine.csv").rename(tmp_path / "mine.csv")
    assert main("report", "out/compare", cwd=tmp_path).returncode == 0
    assert (place / "tables" / "cases.csv").is_file()
    main(*line, "--seed", 1, cwd=tmp_path)
    assert not (place / "report.html").exists()
    assert not (place / "tables").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["absent"], "there is no study at absent"),
        (["."], "there is no study at study.nc"),
        (["results", "--out", "page.pdf"], "--out page.pdf given, it must be a file whose name ends with .html"),
        (["results", "--out", "folder.html"], "--out folder.html given, it must be a file whose name ends with .html"),
        (["results", "--out", "results/study.nc/page.html"], "cannot write to the folder results/study.nc"),
        (["broken"], "cannot read the study broken/study.nc"),
    ],
)
def test_nonsense_is_one_line_and_code_2(main, tmp_path, results, options, message):
    place = tmp_path / "work"
    for name in ("results", "broken", "folder.html"):
        (place / name).mkdir(parents=True)
    (results / "study.nc").rename(place / "results" / "study.nc")
    (place / "broken" / "study.nc").write_bytes(b"no study")
    done = main("report", *options, cwd=place)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(place.rglob("*.csv"))


def test_an_unreadable_note_of_the_execution_is_told(main, results):
    (results / "execution.json").write_text("{")
    done = main("report", results)
    assert done.returncode == 2
    assert "execution.json" in done.stderr
    assert not (results / "report.html").exists()


@pytest.mark.usefixtures("small_report")
def test_a_study_of_another_vehicle_has_no_figures_over_time(main, results):
    changed = study.load(results / "study.nc").assign_attrs(inputs='{"model": "0", "gains": "0"}')
    study.save(changed, results / "study.nc")
    assert main("report", results).returncode == 0
    assert "the file of its model has changed since the study" in (results / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda saved: saved.drop_attrs(), "is not as it was saved: it has no configuration"),
        (lambda saved: saved.drop_vars("settling"), "has no settling, which a report needs; run it again"),
        (
            lambda saved: saved.isel(case=[0]),
            "not as it was saved: configured are the cases particle/gauss-markov/gps,",
        ),
    ],
)
def test_a_study_that_was_edited_is_told_in_one_line(main, dataset, tmp_path, change, told):
    study.save(change(dataset), tmp_path / "study.nc")
    done = main("report", tmp_path)
    assert done.returncode == 2
    assert told in done.stderr
    assert done.stderr.count("\n") == 1
