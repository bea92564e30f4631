import subprocess
import sys
from dataclasses import replace

import pytest

from dynabot_mj import study
from dynabot_mj.common.exceptions import InputError
from dynabot_mj.study import campaign, chunk_folder, configuration, trial_chunks
from dynabot_mj.study import dataset as datasets
from dynabot_mj.study.execution import Execution

pytestmark = pytest.mark.usefixtures("chunked")


def test_the_same_study_is_the_same_file_whatever_its_execution(dataset, short, saved):
    first = saved(dataset)
    assert saved(study.run(short, Execution(threads=3))) == first
    assert saved(study.run(short, Execution(workers=2))) == first


def test_chunks_do_not_show(dataset, chunked, short, saved):
    whole = saved(dataset)  # made in one chunk a case; two of them make the file above
    chunked(1)
    assert saved(study.run(short)) == whole


def test_an_interrupted_study_resumes_where_it_was(dataset, tmp_path, short, saved, work):
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
    chunk_folder.forget(chunks, work(short))
    assert not chunks.exists()


def test_any_order_of_chunks_gives_the_same_bytes(short, dataset, saved):
    made = campaign.single(short)
    chunks = trial_chunks.chunks(made)
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
