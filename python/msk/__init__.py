"""MSK: typed motor-control tasks on a body with 416 muscles, as Gymnasium environments.

>>> import gymnasium, msk
>>> env = gymnasium.make("msk/Walk-v0")

The tasks are written in the language of ``.msk`` files and run in Rust; :func:`make` opens files of one's own,
:func:`check` reports what is wrong in one, :mod:`msk.physics` is the simulator alone.
"""

from . import physics
from .agents import Agent
from .collection import DataSet, collect, merge_data
from .diagnostics import Diagnostic, Diagnostics, Fix, Place
from .environment import CAMERAS, Env, Page, Picture, Snapshot, show
from .errors import CompileError, InternalError, LintWarning
from .evaluation import evaluate, merge
from .pipeline import Pipeline
from .registration import id_of, make, make_vec, register
from .tasks import TASKS, Channel, Explanation, Parameter, Task, Term, check, compile, compile_text
from .vector import VectorEnv
from .weights import LiveWeights

__all__ = [
    "CAMERAS",
    "TASKS",
    "Agent",
    "Channel",
    "CompileError",
    "DataSet",
    "Diagnostic",
    "Diagnostics",
    "Env",
    "Explanation",
    "Fix",
    "InternalError",
    "LintWarning",
    "LiveWeights",
    "Page",
    "Parameter",
    "Picture",
    "Pipeline",
    "Place",
    "Snapshot",
    "Task",
    "Term",
    "VectorEnv",
    "check",
    "collect",
    "compile",
    "compile_text",
    "evaluate",
    "id_of",
    "make",
    "make_vec",
    "merge",
    "merge_data",
    "physics",
    "register",
    "show",
]

register()
