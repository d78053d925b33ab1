"""The vector environment for Stable-Baselines3: equal to its own of single environments, and learned on."""

import numpy as np
import pytest

import msk
from conftest import CALM, actions, short

pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 is not installed")

from stable_baselines3 import PPO
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv

from msk.stable_baselines3 import VecEnv


def test_it_equals_the_vector_of_monitored_environments(task: msk.Task):
    native = VecEnv(task, 3, threads=1)
    single = DummyVecEnv([lambda: Monitor(msk.make(task))] * 3)
    assert native.observation_space == single.observation_space and native.action_space == single.action_space
    native.seed(5)
    single.seed(5)
    assert np.array_equal(native.reset(), single.reset())
    ends = 0
    for action in actions(task, 30, 3):
        [*arrays, infos], [*others, other_infos] = native.step(action), single.step(action)
        assert all(np.array_equal(one, other) and one.dtype == other.dtype for one, other in zip(arrays, others))
        for slot in np.flatnonzero(arrays[2]):
            one, other = infos[slot], other_infos[slot]
            assert one.keys() == other.keys()
            assert np.array_equal(one.pop("terminal_observation"), other.pop("terminal_observation"))
            episode, expected = one.pop("episode"), other.pop("episode")
            assert episode["l"] == expected["l"] and episode["r"] == pytest.approx(expected["r"], abs=1e-6)
            assert {key: one[key] for key in one if key != "metrics"} == {
                key: other[key] for key in other if key != "metrics"
            }
            assert native.reset_infos[slot] == single.reset_infos[slot]
            ends += 1
    assert ends > 6


def test_truncations_are_declared():
    envs = VecEnv(short(CALM), 2, threads=1)
    envs.seed(0)
    envs.reset()
    for _ in range(12):
        _, _, dones, infos = envs.step(np.zeros((2, 416), np.float32))
    assert dones.all() and all(info["TimeLimit.truncated"] for info in infos)


def test_an_algorithm_learns_on_it(task: msk.Task):
    model = PPO("MlpPolicy", VecEnv(task, 4, threads=1), n_steps=32, batch_size=32, n_epochs=1, seed=0, device="cpu")
    model.learn(256)
    assert len(model.ep_info_buffer) > 4 and len(model.ep_success_buffer) > 4


def test_slots_have_no_attributes_of_their_own(task: msk.Task):
    envs = VecEnv(task, 2, threads=1)
    assert envs.get_attr("task") == [task, task] and envs.get_attr("render_mode") == [None, None]
    with pytest.raises(AttributeError, match=r"envs.weights"):
        envs.set_attr("x", 1)
    with pytest.raises(AttributeError, match="slot by slot"):
        envs.env_method("render")
