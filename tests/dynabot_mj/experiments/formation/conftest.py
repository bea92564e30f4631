import numpy as np
import pytest
import xarray as xr

from dynabot_mj import study
from dynabot_mj.study import campaign, configuration, execution, trial_chunks
from dynabot_mj.study import dataset as datasets
from dynabot_mj.study.execution import Execution, Watch


@pytest.fixture(scope="session")
def perceptions():
    """Two seconds of every perception, on both plants."""
    return study.run(
        configuration.build(
            {"perception": ["gauss-markov", "filter", "fitted"]},
            trials=2,
            duration=2.0,
            estimators=["perfect", "gps", "decoupled"],
        )
    )


@pytest.fixture
def pilot(dataset):
    """A study of 40 trials, in which 16 pairs are discordant, 12 of them one way, and B arrives a second after A."""
    study = xr.concat([dataset] * 14, "trial", data_vars="minimal").isel(trial=slice(40))
    study = study.assign_coords(trial=np.arange(40))
    first, second = np.repeat([1.0, 0.0], [12, 28]), np.repeat([0.0, 1.0, 0.0], [12, 4, 24])
    study["collision_footprint"] = (("case", "trial"), np.array([first, second]))
    common, own = np.random.default_rng(0).normal(size=(2, 2, 40))
    study["arrival"] = (("case", "trial"), np.array([10.0 + common[0], 11.0 + common[0] + 0.5 * own[0]]))
    study.attrs = dataset.attrs
    return study


@pytest.fixture(scope="session")
def gridded():
    """A campaign of 2 x 2 points and 2 estimators."""
    tree = {
        "trials": 8,
        "duration": 45.0,
        "plants": ["particle"],
        "estimators": ["decoupled", "coupled"],
        "grid": {"robots": [2, 3], "surrogate.correlation_time": [0.3, 3.0]},
    }
    return campaign.load(tree, "grid.toml")


@pytest.fixture(scope="session")
def grid_study(gridded):
    """Its Dataset."""
    return datasets.whole(gridded, execution.execute(trial_chunks.chunks(gridded), Execution(), Watch()))
