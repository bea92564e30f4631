"""The leader, that robots form around: at rest in the origin, as the paper has it."""

import numpy as np

LEADER_W = np.zeros(2)  # its position, known to every robot exactly and at once [m]
