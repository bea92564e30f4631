from dynabot_mj.experiments.tables import aligned


def test_columns_line_up():
    assert aligned(["a", "long"], [["wide cell", "1"], ["", "22"]]) == [
        "| a         | long |",
        "|-----------|------|",
        "| wide cell | 1    |",
        "|           | 22   |",
    ]


def test_a_table_may_have_no_rows():
    assert aligned(["a"], []) == ["| a |", "|---|"]
