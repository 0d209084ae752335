"""Crowds of people who look happy, angry, sad or neutral, by how they walk and where they look.

>>> import gaitway as gw
>>> sim = gw.Simulation("crossing", agents=60, seed=7, backend="cpu")
>>> sim.step(30)                      # one second
>>> sim.positions[sim.present].shape  # (x, z), m
(60, 2)

Units are metres, seconds and radians. The ground plane is (x, z), right-handed with y up; PedPy's plane is (x, y = -z), and
only ``positions_xy``, ``walkable_area`` and ``to_pedpy`` are in it.
"""

from . import gaits, scenario, statistics, study
from ._errors import BadValue, Error
from ._gaitway import Table, __version__, scenes
from ._perceiver import Perceiver
from ._pictures import Picture, Video
from ._simulation import Mask, Simulation
from ._trajectories import Trajectories

#: The emotions, in the order of every array and table.
EMOTIONS = ("happy", "angry", "sad", "neutral")

__all__ = [
    "EMOTIONS",
    "BadValue",
    "Error",
    "Mask",
    "Perceiver",
    "Picture",
    "Simulation",
    "Table",
    "Trajectories",
    "Video",
    "__version__",
    "gaits",
    "scenario",
    "scenes",
    "statistics",
    "study",
]
