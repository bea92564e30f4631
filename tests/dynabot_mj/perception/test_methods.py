import importlib
import itertools

from dynabot_mj.common import legend
from dynabot_mj.perception import methods
from dynabot_mj.perception.methods import METHODS
from dynabot_mj.testbed import paper


def test_a_colour_means_one_robot_one_method_or_one_perception():
    colours = [*legend.ROBOT_COLOURS, *map(methods.colour, METHODS), *legend.PERCEPTION_COLOURS.values()]
    assert len(set(colours)) == len(colours)


def test_those_of_the_users_have_colours_that_are_no_built_in_methods():
    names = ["".join(letters) for letters in itertools.product("abc", repeat=3)]
    spare = {methods.colour(name) for name in names}
    assert len(spare) == 6
    assert not spare & {one.colour for one in METHODS.values()}


def test_a_method_is_named_with_its_perception_where_one_is_given():
    assert methods.label("gps") == "GPS"
    assert methods.label("gps", "filter") == "GPS, filters"
    assert methods.label("mine", "filter") == "mine, filters"


def test_the_papers_methods_have_the_papers_numbers():
    assert [name for name, record in METHODS.items() if record.row] == list(paper.TABLE_III)
    for name, figures in paper.TABLE_II.items():
        record, row = METHODS[name], paper.TABLE_III[name]
        assert (record.uncertainty, record.estimation_time) == (figures.uncertainty, figures.estimation_time)
        assert (record.alpha_h, record.alpha_d, record.row) == (row.alpha_h, row.alpha_d, row)


def test_filters_and_twins_are_where_their_records_say():
    for record in METHODS.values():
        for path in filter(None, (record.filter, record.twin)):
            module, _, name = path.partition(":")
            assert hasattr(importlib.import_module(module), name)
