import matplotlib.pyplot as plt
import pytest
from PIL import Image

from dynabot_mj.figures import style


def drawn():
    with plt.rc_context(style.STYLE):
        figure, axis = plt.subplots()
        axis.plot([0.0, 1.0], [0.0, 2.0], label="a line")
        axis.legend()
    return figure


@pytest.mark.parametrize("name", ["a.png", "a.svg"])
def test_a_figure_is_written_as_its_name_says_and_forgotten(tmp_path, name):
    figure = drawn()
    style.save(figure, tmp_path / name)
    assert not plt.fignum_exists(figure.number)
    begin = (tmp_path / name).read_bytes()[:6]
    assert begin == {"a.png": b"\x89PNG\r\n", "a.svg": b"<?xml "}[name]


def test_pictures_have_a_palette_and_the_size_of_the_figure(tmp_path):
    style.save(drawn(), tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.mode == "P"
        assert picture.size == (round(6.4 * 120), round(4.8 * 120))  # Matplotlib's own size at our resolution


def test_a_users_own_settings_are_about_the_users_figures(tmp_path):
    style.save(drawn(), tmp_path / "a.png")
    with plt.rc_context({"font.size": 30.0, "axes.facecolor": "black", "savefig.facecolor": "red"}):
        style.save(drawn(), tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
