"""Ready and relaxed human postures: joint torques of a body at rest, fatigue, and where a tired joint finds relief.

Units are rad, m, kg, N, N m and s. Torques act in the direction of their coordinate; external + passive + active torque is 0 at
every joint of a body at rest.

>>> import contrapposto
>>> model = contrapposto.Model.adult(sex="female", stature=1.65, mass=60)
>>> torques = model.torques(model.default_posture, loads=["hand_r 3kg"])
>>> len(torques.names) == torques.active.size
True
"""

from contrapposto import interop
from contrapposto._native import __version__
from contrapposto.engine import Engine
from contrapposto.errors import ContrappostoError, InputError, InternalError, JobError
from contrapposto.jobs import example, minimize, pose, relax, simulate
from contrapposto.loads import Force, Weight
from contrapposto.model import Model
from contrapposto.motions import assess
from contrapposto.muscle_states import MuscleStates, muscles
from contrapposto._results import Assessment, Equilibria, Pose, Record, Run
from contrapposto.sweeps import Population, Results, population, results, sweep
from contrapposto.torques import Torques

__all__ = [
    "Assessment",
    "ContrappostoError",
    "Engine",
    "Equilibria",
    "Force",
    "InputError",
    "InternalError",
    "JobError",
    "Model",
    "MuscleStates",
    "Population",
    "Pose",
    "Record",
    "Results",
    "Run",
    "Torques",
    "Weight",
    "__version__",
    "assess",
    "example",
    "interop",
    "minimize",
    "muscles",
    "population",
    "pose",
    "relax",
    "results",
    "simulate",
    "sweep",
]
