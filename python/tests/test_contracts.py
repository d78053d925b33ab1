"""What Gymnasium and Stable-Baselines3 expect of an environment, checked by their own checkers."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import msk

IDS = [msk.id_of(task) for task in msk.TASKS]


def test_the_benchmark_has_22_tasks():
    assert len(IDS) == 22
    assert {"msk/Walk-v0", "msk/Stand-v0", "msk/SingleLegStand-v0"} <= set(IDS)
    assert all(id in gymnasium.registry for id in IDS)


@pytest.mark.parametrize("id", IDS)
def test_gymnasium_accepts_every_environment(id: str):
    env = gymnasium.make(id)
    check_env(env.unwrapped)
    assert env.unwrapped.task.name == env.spec.kwargs["task"]


@pytest.mark.parametrize("id", IDS)
def test_stable_baselines3_accepts_every_environment(id: str):
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="Stable-Baselines3 is not installed")
    checker.check_env(gymnasium.make(id).unwrapped, warn=False)


def test_an_episode_through_gymnasiums_wrappers():
    env = gymnasium.wrappers.RecordEpisodeStatistics(gymnasium.make("msk/Stand-v0", render_mode="ansi"))
    env.reset(seed=1)
    ended = False
    while not ended:
        _, _, terminated, truncated, info = env.step(env.action_space.sample())
        ended = terminated or truncated
    assert info["episode"]["l"] == info["steps"]
    assert info["episode"]["r"] == pytest.approx(info["return"])
    assert "stand: step" in env.render()


def test_vector_environments_are_made_natively():
    envs = gymnasium.make_vec("msk/Walk-v0", num_envs=3, threads=1)
    assert isinstance(envs, msk.VectorEnv)
    assert envs.metadata["autoreset_mode"] is gymnasium.vector.AutoresetMode.SAME_STEP
    observations, _ = envs.reset(seed=0)
    assert observations in envs.observation_space
    observations, rewards, terminated, truncated, _ = envs.step(envs.action_space.sample())
    assert observations in envs.observation_space and observations.dtype == np.float32
    assert rewards.shape == terminated.shape == truncated.shape == (3,)
    assert (rewards.dtype, terminated.dtype, truncated.dtype) == (np.float64, np.bool_, np.bool_)


def test_gymnasiums_vector_wrappers_accept_them():
    envs = gymnasium.wrappers.vector.RecordEpisodeStatistics(gymnasium.make_vec("msk/Stand-v0", num_envs=2, threads=1))
    envs.reset(seed=0)
    for _ in range(3):
        envs.step(envs.action_space.sample())
    assert repr(envs.unwrapped).startswith("VectorEnv(msk/Stand-v0")
