from dynabot_mj.common.tables import Table, aligned


def test_columns_line_up():
    assert aligned(["a", "long"], [["wide cell", "1"], ["", "22"]]) == [
        "| a         | long |",
        "|-----------|------|",
        "| wide cell | 1    |",
        "|           | 22   |",
    ]


def test_a_table_may_have_no_rows():
    assert aligned(["a"], []) == ["| a |", "|---|"]


def test_a_table_is_a_heading_its_lines_and_its_note():
    table = Table(title="T", header=["a"], body=[["1"]], note="n")
    assert table.markdown(3).split("\n") == ["### T", "", "| a |", "|---|", "| 1 |", "", "n"]
    assert Table(title="T", header=["a"], body=[["1"]]).markdown().endswith("| 1 |")
