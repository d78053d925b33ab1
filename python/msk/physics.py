"""The simulator alone, without tasks: models in MuJoCo's format, one simulation, many side by side.

>>> model = msk.physics.Model.from_file("humanoid.xml")
>>> simulation = msk.physics.Simulation(model)
>>> simulation.step(100)
>>> simulation.state()["qpos"]
"""

from ._native import Batch, Model, Simulation

__all__ = ["Batch", "Model", "Simulation", "human"]


def human() -> Model:
    """The body of the tasks: 416 muscles."""
    return Model.from_file("<built-in>/bodies/models/human416.xml")
