"""Agents of `msk train`: those that come with the package, and folders."""

import numpy as np
import pytest

import msk
from conftest import REPOSITORY, short


@pytest.fixture(scope="module")
def stand() -> msk.Task:
    return msk.compile("stand")


def test_a_built_in_agent_stands(stand: msk.Task):
    agent = msk.Agent.built_in(stand)
    assert (agent.task, agent.algorithm, agent.action_repeat) == ("stand", "clone", 1) and "stand" in repr(agent)
    env = msk.make(stand)
    ended = {}
    for name, act in {"agent": agent.act, "rest": lambda _: np.full(416, -1, np.float32)}.items():
        observation, _ = env.reset(seed=3)
        for step in range(150):
            observation, _, terminated, *_ = env.step(act(observation))
            if terminated:
                ended[name] = step
                break
    assert "agent" not in ended and ended["rest"] < 150


def test_a_batch_acts_as_single_observations_do(stand: msk.Task):
    agent = msk.Agent(REPOSITORY / "agents" / "stand", stand)
    envs = msk.make_vec(stand, num_envs=3)
    observations, _ = envs.reset(seed=1)
    actions = agent.act(observations)
    assert actions.shape == (3, 416) and actions.dtype == np.float32 and np.abs(actions).max() <= 1
    for observation, action in zip(observations, actions, strict=True):
        assert np.array_equal(agent.act(observation), action)
    assert np.array_equal(agent.predict(observations, deterministic=True)[0], actions)


def test_what_does_not_fit_is_refused(stand: msk.Task, tmp_path):
    agent = msk.Agent.built_in("stand")
    with pytest.raises(ValueError, match=r"an observation must have the shape \(1928,\), found \(3,\)"):
        agent.act(np.zeros(3, np.float32))
    with pytest.raises(TypeError, match="found list"):
        agent.act([0.0])
    with pytest.raises(ValueError, match="no agent was trained on `walk`, only on"):
        msk.Agent.built_in("walk")
    with pytest.raises(ValueError, match="it was trained to see something else: channel 1"):
        msk.Agent(REPOSITORY / "agents" / "stand", short(), any_task=True)
    with pytest.raises(ValueError, match="holds no `agent.toml`"):
        msk.Agent(tmp_path, stand)
    path = REPOSITORY / "tasks" / "stabilization" / "stand.msk"
    heavier = msk.compile_text(path.read_text().replace("15    (5..30) stillness", "16 (5..30) stillness"), path=path)
    with pytest.raises(ValueError, match="has changed since it was trained; any_task=True uses it nevertheless"):
        msk.Agent(REPOSITORY / "agents" / "stand", heavier)
    msk.Agent(REPOSITORY / "agents" / "stand", heavier, any_task=True)
