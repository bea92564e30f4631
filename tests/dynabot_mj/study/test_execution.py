import subprocess
import sys
from dataclasses import replace

import pytest

from dynabot_mj import study
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.plants import kinds
from dynabot_mj.study import campaign, configuration, execution, provenance
from dynabot_mj.study import dataset as datasets
from dynabot_mj.study.execution import Execution


def chunked(monkeypatch, size):
    for name, kind in kinds.KINDS.items():
        monkeypatch.setitem(kinds.KINDS, name, replace(kind, chunk=size))


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch):
    chunked(monkeypatch, 2)


def work(setup):
    return datasets.chunks(campaign.single(setup))


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


def test_the_same_study_is_the_same_file_whatever_its_execution(dataset, short, saved):
    first = saved(dataset)
    assert saved(study.run(short, Execution(threads=3))) == first
    assert saved(study.run(short, Execution(workers=2))) == first


def test_chunks_do_not_show(dataset, monkeypatch, short, saved):
    whole = saved(dataset)  # made in one chunk a case; two of them make the file above
    chunked(monkeypatch, 1)
    assert saved(study.run(short)) == whole


def test_an_interrupted_study_resumes_where_it_was(dataset, tmp_path, short, saved):
    chunks = tmp_path / "chunks"
    told = []

    def interrupt(share):
        told.append(share)
        if share > 0.6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study.run(short, Execution(chunks=chunks), interrupt)
    kept = {file.name: file.stat().st_mtime_ns for file in chunks.iterdir()}
    assert kept
    assert not any("partial" in name for name in kept)
    resumed = study.run(short, Execution(chunks=chunks, resume=True))
    assert saved(resumed) == saved(dataset)
    assert all((chunks / name).stat().st_mtime_ns == time for name, time in kept.items())
    with pytest.raises(InputError, match="parts of another study"):
        study.run(replace(short, seed=1), Execution(chunks=chunks, resume=True))
    execution.forget(work(short), chunks)
    assert not chunks.exists()


def test_parts_of_another_version_of_the_code_are_not_taken(monkeypatch, short):
    def first(setup):
        return execution._names(work(setup))[0]

    name = first(short)
    assert first(replace(short, seed=1)) != name
    assert first(replace(short, trials=9)) == first(replace(short, plants=("particle",))) == name
    monkeypatch.setattr(provenance, "source_digest", lambda: "another")
    assert first(short) != name


@pytest.fixture
def half(tmp_path, short):
    """A folder with two of four finished chunks."""
    folder = tmp_path / "chunks"
    with pytest.raises(KeyboardInterrupt):
        execution.execute(work(short), Execution(chunks=folder), Interrupting(2))
    assert len(list(folder.iterdir())) == 2
    return folder


def resumed(short, folder):
    """Resumes, and returns the watch and the Dataset."""
    watch = Interrupting(-1)
    results = execution.execute(work(short), Execution(chunks=folder, resume=True), watch)
    return watch, datasets.whole(campaign.single(short), results)


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty"])
def test_a_damaged_chunk_is_reported_and_computed_again(half, short, dataset, saved, damage):
    file = sorted(half.iterdir())[0]
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 4
    file.write_bytes({"cut": file.read_bytes()[:-100], "flipped": bytes(content), "empty": b""}[damage])
    watch, found = resumed(short, half)
    assert len(watch.kept) == 1
    assert watch.notes == [f"{file.name} is damaged (its checksum does not fit); it is computed again"]
    assert saved(found) == saved(dataset)


def test_a_chunk_of_another_study_is_refused_by_name(half, short, dataset, saved):
    one, other = sorted(half.iterdir())
    other.write_bytes(one.read_bytes())  # under a name that is not its own
    watch, found = resumed(short, half)
    assert len(watch.kept) == 1
    (note,) = watch.notes
    assert note.startswith(f"not of this study and not used: {other.name} (trials [0, 2] there and [2, 3] here")
    assert saved(found) == saved(dataset)


def test_a_chunk_of_another_version_is_refused_with_what_differs(half, short, monkeypatch):
    known = provenance.computation()
    monkeypatch.setattr(provenance, "computation", lambda: {**known, "mujoco": "9.9"})
    told = rf"parts of another study .*: particle.*npz \(computation.mujoco {known['mujoco']} there and 9.9 here"
    with pytest.raises(InputError, match=told):
        resumed(short, half)


def test_any_order_of_chunks_gives_the_same_bytes(short, dataset, saved):
    made = campaign.single(short)
    chunks = datasets.chunks(made)
    done = {index: chunks[index].run(1, lambda share: None) for index in reversed(range(len(chunks)))}
    assert saved(datasets.whole(made, done)) == saved(dataset)


def test_progress_rises_to_one(short):
    told = []
    study.run(replace(short, duration=2.0), progress=told.append)
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)


# In a process of its own: distributed leaves sockets to the garbage collector, whose warnings would fail other tests.
DASK = """
import sys
import distributed
from dynabot_mj import study
from dynabot_mj.study import configuration
from dynabot_mj.study.execution import Execution

options = dict(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0")
with distributed.LocalCluster(**options) as cluster:
    setup = configuration.load(sys.stdin.read(), "stdin")
    study.save(study.run(setup, Execution(scheduler=cluster.scheduler_address)), sys.argv[1])
"""


def test_a_dask_cluster_gives_the_same_result(dataset, tmp_path, short, saved):
    pytest.importorskip("distributed")
    text = configuration.dump(short)
    command = [sys.executable, "-c", DASK, tmp_path / "a.nc"]
    subprocess.run(command, input=text, text=True, check=True, capture_output=True, timeout=300)
    assert (tmp_path / "a.nc").read_bytes() == saved(dataset)
