"""Tasks of other projects in the language, `examples/peers/`, beside their own environments: the same states, the same actions."""

import ast
import inspect
import os
import re
import textwrap
from pathlib import Path

import numpy as np
import pytest

import msk
from conftest import REPOSITORY

os.environ.setdefault("MUJOCO_GL", "disabled")
pytest.importorskip("mujoco", reason="MuJoCo is not installed")
pytest.importorskip("imageio", reason="what Gymnasium asks for beside MuJoCo is not installed")

import gymnasium

PEERS = REPOSITORY / "examples/peers"

GYMNASIUM = {
    "half_cheetah": ("HalfCheetah-v5", {"forward": "reward_forward", "effort": "reward_ctrl"}),
    "hopper": ("Hopper-v5", {"forward": "reward_forward", "healthy": "reward_survive", "effort": "reward_ctrl"}),
    "walker2d": ("Walker2d-v5", {"forward": "reward_forward", "healthy": "reward_survive", "effort": "reward_ctrl"}),
}
"""Our name: theirs, and of each term the key of its contribution in their `info`."""


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes its warnings to a file where it runs."""
    monkeypatch.chdir(tmp_path)


def equal(ours, theirs, what: str) -> None:
    np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6, err_msg=what)


@pytest.mark.parametrize("name", GYMNASIUM)
def test_gymnasium_takes_the_same_steps(name: str):
    theirs_name, terms = GYMNASIUM[name]
    theirs = gymnasium.make(theirs_name).unwrapped
    ours = msk.make(PEERS / f"{name}.msk", dtype=np.float64)
    assert ours.action_space.shape == theirs.action_space.shape
    assert ours.observation_space.shape == theirs.observation_space.shape
    assert ours.task.control_frequency == pytest.approx(1 / theirs.dt)
    assert ours.task.horizon == gymnasium.spec(theirs_name).max_episode_steps
    draws = np.random.default_rng(0)
    steps = ends = 0
    for seed in range(8):
        theirs.reset(seed=seed)
        ended = False
        # Small actions keep it upright for longer, large ones throw it about.
        size = draws.uniform(0.2, 1)
        for _ in range(100):
            before = {"qpos": theirs.data.qpos.copy(), "qvel": theirs.data.qvel.copy()}
            observation, _ = ours.reset(seed=seed, options={"state": before})
            equal(observation, theirs._get_obs(), "observation of the state")
            action = draws.uniform(-size, size, ours.action_space.shape).astype(np.float32)
            observation, reward, ended, _, info = theirs.step(action)
            own, own_reward, own_ended, _, own_info = ours.step(action)
            equal(own, observation, "observation")
            equal(own_reward, reward, "reward")
            for term, key in terms.items():
                equal(own_info["contributions"][term], info[key], term)
            assert own_ended == ended
            steps, ends = steps + 1, ends + ended
            if ended:
                break
    assert steps > 50 and (ends > 0 or name == "half_cheetah")


DM_CONTROL = {
    "walker_walk": ("walker", "walk"),
    "cheetah_run": ("cheetah", "run"),
    "humanoid_stand": ("humanoid", "stand"),
}
"""Our name: their domain and task."""


def flat(observation: dict[str, np.ndarray]) -> np.ndarray:
    return np.concatenate([np.atleast_1d(part) for part in observation.values()])


@pytest.mark.parametrize("name", DM_CONTROL)
def test_dm_control_takes_the_same_steps(name: str):
    suite = pytest.importorskip("dm_control.suite", reason="dm_control is not installed")
    ours = msk.make(PEERS / f"{name}.msk", dtype=np.float64)
    draws = np.random.default_rng(0)
    for seed in range(4):
        try:
            theirs = suite.load(*DM_CONTROL[name], task_kwargs={"random": seed})
        except AttributeError as missing:
            pytest.skip(f"dm_control does not run on this MuJoCo: {missing}")
        assert ours.task.control_frequency == pytest.approx(1 / theirs.control_timestep())
        assert ours.task.horizon == theirs._step_limit
        theirs.reset()
        for _ in range(60):
            data = theirs.physics.data
            observation, _ = ours.reset(options={"state": {"qpos": data.qpos.copy(), "qvel": data.qvel.copy()}})
            equal(observation, flat(theirs.task.get_observation(theirs.physics)), "observation of the state")
            action = draws.uniform(-1, 1, ours.action_space.shape)
            step = theirs.step(action)
            own, own_reward, own_ended, _, _ = ours.step(action)
            equal(own, flat(step.observation), "observation")
            equal(own_reward, step.reward, "reward")
            assert not own_ended and not step.last()


def test_myosuite_takes_the_same_steps():
    pytest.importorskip("myosuite", minversion="3.0", reason="MyoSuite is not installed")
    theirs = gymnasium.make("myoElbowPoseTaskRandom-v0").unwrapped
    ours = msk.make(PEERS / "elbow_pose.msk", dtype=np.float64)
    assert ours.observation_space.shape == theirs.observation_space.shape
    draws = np.random.default_rng(0)
    for seed in range(4):
        theirs.reset(seed=seed)
        for _ in range(60):
            data = theirs.data
            state = {"qpos": data.qpos.copy(), "qvel": data.qvel.copy(), "act": data.act.copy()}
            observation, _ = ours.reset(seed=seed, options={"state": state})
            # Ours is drawn by the seed; the last channel is target less angle.
            theirs._task_state["target_angles"] = observation[-1:] + observation[:1]
            # Their entries are excitations, ours the same from -1 to 1.
            excitations = draws.uniform(0, 1, ours.action_space.shape).astype(np.float32)
            observation, reward, _, _, info = theirs.step(excitations)
            own, own_reward, _, _, own_info = ours.step(2.0 * excitations - 1.0)
            equal(own, observation, "observation")
            equal(own_reward, reward, "reward")
            for term, key in {"pose": "pose/pose", "bonus": "pose/bonus", "act_reg": "act_reg/act_reg"}.items():
                equal(own_info["contributions"][term], info[key], term)
            assert (abs(own[-1]) < 0.35) == info["solved"]


def lines_of_class(environment: gymnasium.Env) -> int:
    """Lines of its class that are neither empty nor documentation."""
    source = textwrap.dedent(inspect.getsource(type(environment)))
    documented = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ClassDef | ast.FunctionDef)]
    texts = [node.body[0] for node in documented if ast.get_docstring(node) is not None]
    left_out = {line for text in texts for line in range(text.lineno, text.end_lineno + 1)}
    lines = enumerate(source.splitlines(), 1)
    return sum(1 for number, line in lines if number not in left_out and line.strip())


@pytest.mark.parametrize("name", GYMNASIUM)
def test_they_are_shorter(name: str):
    """As the table says."""
    ours = sum(1 for line in (PEERS / f"{name}.msk").read_text().splitlines() if line.strip())
    theirs = lines_of_class(gymnasium.make(GYMNASIUM[name][0]).unwrapped)
    assert ours < theirs / 2
    assert re.search(rf"`{name}\.msk`.*\| {ours} \| {theirs} \|", (PEERS / "README.md").read_text()), (
        f"{ours} and {theirs}"
    )


@pytest.mark.parametrize("name", GYMNASIUM)
def test_gymnasium_begins_in_the_same_states(name: str):
    """Both draw from the same distribution: the same means and deviations of each coordinate. Noise of ours stays within the ranges of
    joints; theirs leaves that of a joint which begins at an end of its range."""
    theirs = gymnasium.make(GYMNASIUM[name][0]).unwrapped
    ours = msk.make(PEERS / f"{name}.msk", dtype=np.float64)
    draws = [[environment.reset(seed=seed)[0] for seed in range(400)] for environment in (ours, theirs)]
    scale = 0.1 if name == "half_cheetah" else 0.005
    means, deviations = np.mean(draws, axis=1), np.std(draws, axis=1)
    ranges = theirs.model.jnt_range[theirs.model.jnt_limited == 1]
    at_an_end = np.concatenate([np.zeros(2, bool), (ranges == 0).any(axis=1), np.zeros(theirs.model.nv, bool)])
    means, deviations = means[:, ~at_an_end], deviations[:, ~at_an_end]
    np.testing.assert_allclose(*means, rtol=0, atol=0.25 * scale)
    np.testing.assert_allclose(*deviations, rtol=0.15)
