import numpy as np

from dynabot_mj.formation.metrics import Formation

FORMATION = Formation(
    well_radius=3.0,
    spacing=np.sqrt(27.0),
    width=1.0,
    settling_band=0.5,
    tolerance=1.1,
    collision_distance=0.4,
    length=0.5,
    breadth=0.49,
)
