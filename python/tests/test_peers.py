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


MYOSUITE = {"hand_reach": "myoHandReachRandom-v0", "legs_walk": "myoLegWalk-v0"}
"""Our name: theirs, of the tasks that have a class of their own there."""


def theirs_of_myosuite(name: str) -> gymnasium.Env:
    pytest.importorskip("myosuite", minversion="3.0", reason="MyoSuite is not installed")
    return gymnasium.make(name).unwrapped


def put(theirs: gymnasium.Env, state: dict) -> None:
    """Gives their environment the state of ours, so that what differs in a step is of that step."""
    for name in ("qpos", "qvel", "act"):
        getattr(theirs.data, name)[:] = state[name]
    theirs.data.time = state["time"]


def test_myosuites_elbow_takes_the_same_steps():
    theirs = theirs_of_myosuite("myoElbowPoseTaskRandom-v0")
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


@pytest.mark.parametrize(
    "name, theirs_name",
    [("hand_reach", "myoHandReachRandom-v0"), ("hand_reach_fixed", "myoHandReachFixed-v0")],
)
def test_myosuites_hand_takes_the_same_steps(name: str, theirs_name: str):
    theirs = theirs_of_myosuite(theirs_name)
    ours = msk.make(msk.compile(PEERS / "hand_reach.msk", task=name), dtype=np.float64)
    assert ours.action_space == theirs.action_space
    assert ours.observation_space.shape == theirs.observation_space.shape
    assert ours.task.control_frequency == pytest.approx(1 / theirs.dt)
    assert ours.task.horizon == gymnasium.spec(theirs_name).max_episode_steps
    channels = {channel.name: channel.slice for channel in ours.task.channels}
    draws = np.random.default_rng(0)
    solved, endings = set(), set()
    for seed in range(12):
        first, _ = theirs.reset(seed=seed)
        own, _ = ours.reset(seed=seed)
        equal(own[channels["tips"]], first[channels["tips"]], "fingertips at first")
        targets = (own[channels["errors"]] + own[channels["tips"]]).reshape(-1, 3)
        ranges = np.array([theirs.target_reach_range[theirs.model.site(tip).name] for tip in theirs.tip_sids])
        assert np.all((targets >= ranges[:, 0] - 1e-12) & (targets <= ranges[:, 1] + 1e-12)), "drawn from their boxes"
        theirs.model.site_pos[theirs.target_sids] = targets
        # The hand begins open. From the middle of its range it reaches the places; at the ends of it some are too far away.
        low, high = theirs.model.jnt_range.T
        starts = [None, (low + high) / 2, np.where(draws.random(low.size) < 0.5, low, high)]
        if (start := starts[seed % 3]) is not None:
            ours.reset(seed=seed, options={"state": {"qpos": start}})
        bias = draws.uniform(-1, 1, ours.action_space.shape)
        for _ in range(ours.task.horizon):
            put(theirs, ours.state)
            action = np.clip(bias + draws.normal(0, 0.3, bias.shape), -1, 1)
            observation, reward, ended, _, info = theirs.step(action)
            own, own_reward, own_ended, truncated, own_info = ours.step(action)
            equal(own, observation, "observation")
            equal(own_reward, reward, "reward")
            for term, weight in theirs.rwd_keys_wt.items():
                equal(own_info["contributions"][term], weight * info[term], term)
            assert own_ended == ended
            assert (np.linalg.norm(own[channels["errors"]]) < 0.0625) == info["solved"]
            solved.add(bool(info["solved"]))
            if ended or truncated:
                assert own_info["is_success"] == (truncated and info["solved"])
                endings.add(own_info["ending"])
                break
    assert solved == {False, True} and endings == {"terminated", "truncated"}


def test_myosuites_legs_take_the_same_steps():
    theirs = theirs_of_myosuite("myoLegWalk-v0")
    # With the tolerance of 1e-8 the forces of contacts and couplings are worse than 1e-6 in some steps.
    theirs.model.opt.tolerance, theirs.model.opt.iterations = 0.0, 200
    ours = msk.make(PEERS / "legs_walk.msk", dtype=np.float64)
    assert ours.action_space.shape == theirs.action_space.shape
    assert ours.observation_space.shape == theirs.observation_space.shape
    assert ours.task.control_frequency == pytest.approx(1 / theirs.dt)
    assert ours.task.horizon == gymnasium.spec("myoLegWalk-v0").max_episode_steps
    terms = {
        "velocity": "vel_reward",
        "fall": "done",
        "cyclic": "cyclic_hip",
        "upright": "ref_rot",
        "straight": "joint_angle_rew",
    }
    draws = np.random.default_rng(0)
    reasons, solved = set(), set()
    for seed in range(8):
        first, _ = theirs.reset(seed=seed)
        data = theirs.data
        # Half of the episodes begin by turning to the side.
        data.qvel[5] += 4.0 * (seed % 2)
        state = {"qpos": data.qpos.copy(), "qvel": data.qvel.copy(), "act": data.act.copy()}
        own, _ = ours.reset(seed=seed, options={"state": state})
        if seed % 2 == 0:
            equal(own, first, "observation at first")
        size = draws.uniform(0.05, 1)
        for _ in range(120):
            put(theirs, ours.state)
            excitations = draws.uniform(0, size, ours.action_space.shape)
            observation, reward, ended, _, info = theirs.step(excitations)
            own, own_reward, own_ended, _, own_info = ours.step(2.0 * excitations - 1.0)
            equal(own, observation, "observation")
            # Their phase is float32, and terms of opposite signs make up the reward.
            size_of_terms = sum(abs(part) for part in own_info["contributions"].values())
            equal(own_reward / size_of_terms, reward / size_of_terms, "reward")
            for term, key in terms.items():
                equal(own_info["contributions"][term], theirs.rwd_keys_wt[key] * info["rwd_dict"][key], term)
            equal(own_info["metrics"]["act_mag"], info["act_mag"], "act_mag")
            assert own_ended == ended
            assert (own_info["metrics"]["error"] < 0.5 and not own_ended) == info["solved"]
            solved.add(bool(info["solved"]))
            if ended:
                reasons.add(own_info["reason"])
                break
    assert reasons >= {"low", "aside"} and solved == {False, True}


def lines_of_class(environment: gymnasium.Env) -> int:
    """Lines of its class that are neither empty nor documentation."""
    source = textwrap.dedent(inspect.getsource(type(environment)))
    documented = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ClassDef | ast.FunctionDef)]
    texts = [node.body[0] for node in documented if ast.get_docstring(node) is not None]
    left_out = {line for text in texts for line in range(text.lineno, text.end_lineno + 1)}
    lines = enumerate(source.splitlines(), 1)
    return sum(1 for number, line in lines if number not in left_out and line.strip())


@pytest.mark.parametrize("name", [*GYMNASIUM, *MYOSUITE])
def test_they_are_shorter(name: str):
    """As the table says."""
    ours = sum(1 for line in (PEERS / f"{name}.msk").read_text().splitlines() if line.strip())
    theirs = lines_of_class(
        theirs_of_myosuite(MYOSUITE[name]) if name in MYOSUITE else gymnasium.make(GYMNASIUM[name][0]).unwrapped
    )
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
