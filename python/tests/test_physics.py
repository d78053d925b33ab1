"""The simulator alone."""

import numpy as np
import pytest

from msk import physics

PENDULUM = """<mujoco><worldbody><body>
    <joint name="pivot" type="hinge" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05"/>
</body></worldbody><actuator><motor name="motor" joint="pivot"/></actuator></mujoco>"""


@pytest.fixture
def model() -> physics.Model:
    return physics.Model.from_mjcf(PENDULUM)


def test_a_model_has_sizes_and_names(model: physics.Model):
    assert (model.nq, model.nv, model.na, model.nu, model.timestep) == (1, 1, 0, 1, 0.002)
    assert (model.joints, model.actuators) == (["pivot"], ["motor"])
    human = physics.human()
    assert (human.nq, human.nv, human.na, human.nu) == (129, 128, 416, 416)


def test_a_pendulum_swings(model: physics.Model):
    simulation = physics.Simulation(model)
    simulation.set_state({"qpos": np.array([0.3])})
    angles = []
    for _ in range(100):
        simulation.step(10)
        angles.append(simulation.state()["qpos"][0])
    assert simulation.time == pytest.approx(2.0)
    assert min(angles) == pytest.approx(-0.3, abs=0.01) and max(angles) <= 0.3
    simulation.reset()
    assert simulation.time == 0 and simulation.state()["qpos"][0] == 0


def test_controls_act(model: physics.Model):
    simulation = physics.Simulation(model)
    simulation.set_control(np.array([2.0]))
    simulation.step(50)
    simulation.forward()
    assert simulation.state()["qvel"][0] > 0.01
    for wrong in (np.zeros(2), np.array([np.nan])):
        with pytest.raises(ValueError, match="control"):
            simulation.set_control(wrong)


def test_a_batch_equals_its_simulations(model: physics.Model):
    batch = physics.Batch(model, 10, threads=2)
    controls = np.linspace(-1, 1, 10)[:, None]
    batch.set_control(controls)
    batch.set_state(3, {"qpos": np.array([1.0])})
    batch.step(20)
    for index in range(10):
        simulation = physics.Simulation(model)
        simulation.set_state({"qpos": np.array([1.0 if index == 3 else 0.0])})
        simulation.set_control(controls[index])
        simulation.step(20)
        state = simulation.state()
        assert np.array_equal(batch.positions()[index], state["qpos"])
        assert np.array_equal(batch.velocities()[index], state["qvel"])
        assert np.array_equal(batch.state(index)["qpos"], state["qpos"]) and batch.fault(index) is None
    assert len(batch) == 10
    with pytest.raises(IndexError, match="episode 10 of a batch of 10"):
        batch.state(10)


def test_a_state_that_cannot_go_on_is_a_fault(model: physics.Model):
    simulation = physics.Simulation(model)
    simulation.set_state({"qvel": np.array([1e300])})
    with pytest.raises(RuntimeError):
        simulation.step(1000)


def test_models_that_cannot_be_read(tmp_path):
    with pytest.raises(ValueError, match="nothing"):
        physics.Model.from_mjcf("<mujoco><nothing/></mujoco>")
    with pytest.raises(ValueError, match="none.xml"):
        physics.Model.from_file(tmp_path / "none.xml")
