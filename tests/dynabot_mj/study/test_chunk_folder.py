import pytest

from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import campaign, execution, provenance
from dynabot_mj.study import dataset as datasets
from dynabot_mj.study.execution import Execution

pytestmark = pytest.mark.usefixtures("chunked")


class Interrupting(execution.Watch):
    """Interrupts the work when some chunks are whole."""

    def __init__(self, after):
        self.left, self.notes, self.kept = after, [], None

    def begin(self, chunks, kept):
        self.kept = set(kept)

    def note(self, text):
        self.notes.append(text)

    def done(self, index, columns):
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


@pytest.fixture
def half(tmp_path, short, work):
    """A folder with two of four finished chunks."""
    folder = tmp_path / "chunks"
    with pytest.raises(KeyboardInterrupt):
        execution.execute(work(short), Execution(chunks=folder), Interrupting(2))
    assert len(list(folder.iterdir())) == 2
    return folder


@pytest.fixture
def resumed(work):
    """Resumes, and returns the watch and the Dataset."""

    def run(short, folder):
        watch = Interrupting(-1)
        results = execution.execute(work(short), Execution(chunks=folder, resume=True), watch)
        return watch, datasets.whole(campaign.single(short), results)

    return run


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty"])
def test_a_damaged_chunk_is_reported_and_computed_again(half, resumed, short, dataset, saved, damage):
    file = sorted(half.iterdir())[0]
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 4
    file.write_bytes({"cut": file.read_bytes()[:-100], "flipped": bytes(content), "empty": b""}[damage])
    watch, found = resumed(short, half)
    assert len(watch.kept) == 1
    assert watch.notes == [f"{file.name} is damaged (its checksum does not fit); it is computed again"]
    assert saved(found) == saved(dataset)


def test_a_chunk_of_another_study_is_refused_by_name(half, resumed, short, dataset, saved):
    one, other = sorted(half.iterdir())
    other.write_bytes(one.read_bytes())  # under a name that is not its own
    watch, found = resumed(short, half)
    assert len(watch.kept) == 1
    (note,) = watch.notes
    assert note.startswith(f"not of this study and not used: {other.name} (trials [0, 2] there and [2, 3] here")
    assert saved(found) == saved(dataset)


def test_a_chunk_of_another_version_is_refused_with_what_differs(half, resumed, short, monkeypatch):
    known = provenance.computation()
    monkeypatch.setattr(provenance, "computation", lambda: {**known, "mujoco": "9.9"})
    told = rf"parts of another study .*: particle.*npz \(computation.mujoco {known['mujoco']} there and 9.9 here"
    with pytest.raises(InputError, match=told):
        resumed(short, half)
