from dynabot_mj.experiments.formation import grid, grid_tables


def test_tables_line_up_and_have_every_case(gridded, grid_study):
    found = grid.found(
        grid_study, gridded, over=["correlation_time", "estimator"], shown=["arrival_s", "completion_common"]
    )
    text = grid_tables.markdown(found)
    assert "nan" not in text
    lines = text.splitlines()
    assert len({len(line) for line in lines if line.startswith("| 2 ")}) == 1
    assert sum(line.startswith(("| 2 ", "| 3 ")) for line in lines) == 8
    assert "## arrival [s] over correlation_time and estimator" in lines
    assert "## band 1 m [%] over correlation_time and estimator" in lines
    assert any(line.startswith("| robots 3 | 0.3 ") for line in lines)
    assert any("robots 3 - 2" in line for line in lines)
