import pytest


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--trials", 0], "--trials 0 given, it must be at least 1"),
        (["--seed", -1], "--seed -1 given, it must not be negative"),
        (["--workers", 0], "--workers 0 given, it must be at least 1"),
    ],
)
def test_nonsense_is_refused_before_any_work(main, tmp_path, options, told):
    done = main("track", *options, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"dynabot: {told}\n")
    assert not list(tmp_path.iterdir())
