import matplotlib.pyplot as plt
import numpy as np

from dynabot_mj.experiments.formation import compare, compare_tables, measures, sensitivity
from dynabot_mj.experiments.formation.measure import FACTORS, PairedMeasure
from dynabot_mj.figures import bars, distributions
from dynabot_mj.report import csv_tables


def test_every_measure_has_a_value_per_trial_of_a_short_study(dataset):
    for index in range(dataset.sizes["case"]):
        case = dataset.isel(case=index)
        for one in measures.PAIRED:
            values = one.values(case)
            assert values.shape == (3,)
            if one.rate:
                assert np.isin(values[np.isfinite(values)], (0.0, 1.0)).all()


def test_names_are_unique_and_only_tested_ones_compare_plants():
    names = [one.name for one in measures.MEASURES]
    assert len(set(names)) == len(names)
    assert all(one.factors == FACTORS for one in measures.TESTED)


def test_the_order_of_estimators_is_of_tested_measures():
    tested = {one.name for one in measures.TESTED}
    assert set(sensitivity.RANKED) <= tested
    assert all(one.published is not None for one in measures.MEASURES if one.paper_columns)


def test_whatever_stands_in_the_table_is_told(dataset):
    """An entry is enough: rows, tables, explanations, CSV, tests and panels are made from it."""
    comparison = compare.compared(dataset)
    document = compare.document(comparison)
    cases, paper = compare_tables.table(comparison), compare_tables.reproduction(comparison)
    tables = csv_tables.of_study(comparison)
    flat = {
        name: " ".join(one.note.format(horizon="14 s").split()) for name, one in (("cases", cases), ("paper", paper))
    }
    for one in measures.MEASURES:
        assert one.name in document["rows"][0]
        assert one.name in tables["cases.csv"].splitlines()[0]
        headers = [column.header for column in one.columns if "cases" in column.tables]
        assert set(headers) <= set(cases.header)
        assert {column.header for column in one.paper_columns} <= set(paper.header)
        assert one.note.format(horizon="14 s") in flat["cases" if headers else "paper"]
        compared = isinstance(one, PairedMeasure)
        assert (one.name in {pair["metric"] for pair in document["paired"]}) == compared
        assert (one.name in tables["differences.csv"]) == compared
    drawn = (
        ("outcomes", bars.outcomes(comparison)),
        ("table_iii", bars.table_iii(comparison)),
        ("differences", distributions.differences(comparison)),
    )
    for name, figure in drawn:
        titles = {title.format(horizon="14 s") for _, title in measures.panels(name)}
        assert titles == {axis.get_title() for axis in figure.axes}
        plt.close(figure)


def test_columns_stand_as_in_the_table_but_for_their_rank():
    headers = [column.header for _, column in measures.columns("readings")]
    assert headers[:3] == ["arrival [s]", "not arrived", "formation [s]"]
    assert headers[-1] == "own sigma"
