"""One episode after the other: seeds, ends, actions, snapshots, states."""

import pickle
import re

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded

import msk
from conftest import CALM, REPOSITORY, SHORT, actions, short


def play(env: msk.Env, steps: int, seed: int = 0) -> list[tuple[np.ndarray, float]]:
    played = []
    for action in actions(env.task, steps, seed=seed):
        observation, reward, *_ = env.step(action)
        played.append((observation, reward))
    return played


@pytest.fixture
def long() -> msk.Env:
    """Nothing ends it but the horizon."""
    return msk.make(short(CALM))


def test_a_seed_decides_everything(long: msk.Env):
    first, _ = long.reset(seed=5)
    played = play(long, 5)
    again, info = long.reset(seed=5)
    assert np.array_equal(first, again) and info == {"seed": 5, "episode_index": 0}
    for (observation, reward), (other, other_reward) in zip(played, play(long, 5), strict=True):
        assert np.array_equal(observation, other) and reward == other_reward


#: Their initial state has no noise.
ALWAYS_THE_SAME = {"powerlift", "chin_up"}


@pytest.mark.parametrize("name", msk.TASKS)
def test_resets_spread(name: str):
    """Different seeds, and successive episodes of a seed, begin in different states."""
    env = msk.make(name)
    observations = [env.reset(seed=seed)[0] for seed in range(4)] + [env.reset()[0] for _ in range(3)]
    assert len(np.unique(observations, axis=0)) == (1 if name in ALWAYS_THE_SAME else 7)


def test_without_a_seed_chance_chooses_one(task: msk.Task):
    [first, second] = [msk.make(task).reset()[1]["seed"] for _ in range(2)]
    assert first != second


def test_episodes_of_a_seed_follow_each_other(env: msk.Env):
    env.reset(seed=7)
    following, info = env.reset()
    assert info == {"seed": 7, "episode_index": 1}
    chosen, _ = env.reset(seed=7, options={"episode_index": 1})
    assert np.array_equal(following, chosen)


@pytest.mark.parametrize("seed", [-1, 2**63])
def test_seeds_that_cannot_be(env: msk.Env, seed: int):
    with pytest.raises((ValueError, gymnasium.error.Error), match="[Ss]eed"):
        env.reset(seed=seed)


def test_options_that_do_not_exist(env: msk.Env):
    with pytest.raises(ValueError, match="unknown options .'low'.: expected `episode_index`, `params`, `state`"):
        env.reset(options={"low": 1})


def test_info_holds_terms_metrics_and_success(long: msk.Env):
    long.reset(seed=0)
    _, reward, _, _, info = long.step(np.zeros(416, np.float32))
    assert list(info["terms"]) == ["upright", "change"]
    assert info["contributions"]["upright"] == 2 * info["terms"]["upright"]
    assert sum(info["contributions"].values()) == pytest.approx(reward)
    assert 0.8 < info["metrics"]["height"] < 1.1 and info["metrics"]["velocity"].shape == (3,)
    assert info["is_success"] in (True, False) and "ending" not in info


def test_the_horizon_truncates(long: msk.Env):
    long.reset(seed=0)
    play(long, 11)
    *_, terminated, truncated, info = long.step(np.zeros(416, np.float32))
    assert (terminated, truncated, info["ending"], info["reason"], info["steps"]) == (False, True, "truncated", "", 12)
    assert sum(info["term_returns"].values()) == pytest.approx(info["return"])


def test_a_termination_has_its_reason():
    env = msk.make(short(("com.velocity.z < 0 m/s", "pelvis.height > 0.2 m")))
    env.reset(seed=0)
    *_, terminated, truncated, info = env.step(np.zeros(416, np.float32))
    assert (terminated, truncated, info["ending"], info["reason"]) == (True, False, "terminated", "early")


def test_an_ended_episode_wants_a_reset(long: msk.Env):
    with pytest.raises(ResetNeeded):
        long.step(np.zeros(416, np.float32))
    long.reset(seed=0)
    play(long, 12)
    with pytest.raises(ResetNeeded):
        long.step(np.zeros(416, np.float32))


BAD_ACTIONS = [
    (np.zeros(5, np.float32), ValueError, r"must have the shape \(416,\), found \(5,\)"),
    (np.zeros((1, 416), np.float32), ValueError, r"must have the shape \(416,\), found \(1, 416\)"),
    (np.zeros(416, np.int64), TypeError, "dtype float32 or float64, found int64"),
    (np.zeros(416, np.float16), TypeError, "dtype float32 or float64, found float16"),
    ([0.0] * 416, TypeError, "must be a NumPy array of shape .416,., found list"),
    (None, TypeError, "found NoneType"),
    (np.full(416, np.nan), ValueError, r"action\[0\], of `.*`, is NaN"),
    (np.full(416, np.inf), ValueError, r"is inf, not in \[-1, 1\]"),
    (np.full(416, 1.5), ValueError, r"is 1.5, not in \[-1, 1\]: clip it .*clip_actions=True"),
]


@pytest.mark.parametrize(("action", "error", "message"), BAD_ACTIONS)
def test_wrong_actions(long: msk.Env, action: object, error: type[Exception], message: str):
    first, _ = long.reset(seed=0)
    with pytest.raises(error, match=message):
        long.step(action)
    # Nothing has been stepped.
    assert np.array_equal(long._native.observation(), first) and long._native.steps() == 0


def test_actions_may_be_clipped():
    task = short(CALM)
    clipping, plain = msk.make(task, clip_actions=True), msk.make(task)
    for env in (clipping, plain):
        env.reset(seed=0)
    far = 3 * actions(task, 1)[0]
    [[one, *_], [other, *_]] = clipping.step(far), plain.step(np.clip(far, -1, 1))
    assert np.array_equal(one, other)
    with pytest.raises(ValueError, match="NaN"):
        clipping.step(np.full(416, np.nan))


def test_any_layout_of_an_action_will_do(long: msk.Env):
    action = actions(long.task, 1)[0]
    spread = np.zeros(832, np.float32)[::2]
    spread[:] = action
    read_only = action.astype(np.float64)
    read_only.flags.writeable = False
    observations = []
    for given in (action, spread, read_only):
        long.reset(seed=0)
        observations.append(long.step(given)[0])
    assert all(np.array_equal(observations[0], other) for other in observations)


def test_an_observation_is_the_callers_own(long: msk.Env):
    first, _ = long.reset(seed=0)
    kept = first.copy()
    play(long, 2)
    assert np.array_equal(first, kept) and first.flags.writeable


def test_observations_in_double_precision(task: msk.Task):
    env = msk.make(task, dtype=np.float64)
    double, _ = env.reset(seed=0)
    single, _ = msk.make(task).reset(seed=0)
    assert double.dtype == np.float64 and double in env.observation_space
    assert np.array_equal(double.astype(np.float32), single)
    with pytest.raises(ValueError, match="float32 or float64, not int64"):
        msk.make(task, dtype=np.int64)


def test_a_snapshot_goes_on_bit_for_bit(long: msk.Env):
    long.reset(seed=3)
    play(long, 4)
    snapshot = long.snapshot()
    played = play(long, 4, seed=1)
    observation = long.restore(snapshot)
    assert np.array_equal(observation, long._native.observation()) and long.snapshot().episodes == snapshot.episodes
    for (one, reward), (other, other_reward) in zip(played, play(long, 4, seed=1), strict=True):
        assert np.array_equal(one, other) and reward == other_reward


def test_a_snapshot_goes_on_in_another_environment(task: msk.Task, env: msk.Env):
    env.reset(seed=3)
    other = msk.make(task)
    other.restore(env.snapshot())
    assert np.array_equal(other.reset()[0], env.reset()[0])
    with pytest.raises(ValueError, match="snapshot is of another task or body than `stand`"):
        msk.make("stand").restore(env.snapshot())


def test_a_snapshot_is_kept_in_bytes(env: msk.Env):
    env.reset(seed=3)
    episodes = env.snapshot().episodes
    written = episodes.to_bytes()
    assert type(episodes).from_bytes(written) == episodes
    for damaged in (b"", b"\x05abc", written[:-1], written[:100]):
        with pytest.raises(ValueError, match="these bytes are no snapshot"):
            type(episodes).from_bytes(damaged)
    with pytest.raises(ValueError, match="the snapshot is of version 9.1.0, this is"):
        type(episodes).from_bytes(b"\x059.1.0" + written[6:])


def test_bytes_that_were_changed_never_crash(task: msk.Task, env: msk.Env):
    env.reset(seed=3)
    env.step(actions(task, 1)[0])
    episodes = env.snapshot().episodes
    written = episodes.to_bytes()
    chance = np.random.default_rng(0)
    for _ in range(200):
        changed = bytearray(written)
        for place in chance.integers(len(written), size=3):
            changed[place] = chance.integers(256)
        other = msk.make(task)
        try:
            other.restore(msk.Snapshot(type(episodes).from_bytes(bytes(changed)), None))
            other.step(actions(task, 1)[0])
        except (ValueError, gymnasium.error.ResetNeeded):
            pass


def test_the_state_has_names_shapes_and_units(env: msk.Env):
    env.reset(seed=0)
    state = env.state
    assert {name: np.shape(state[name]) for name in ("time", "qpos", "qvel", "act", "ctrl")} == {
        "time": (),
        "qpos": (129,),
        "qvel": (128,),
        "act": (416,),
        "ctrl": (416,),
    }


def test_an_episode_begins_in_a_given_state(long: msk.Env):
    long.reset(seed=0)
    play(long, 3)
    state = long.state
    long.reset(seed=1, options={"state": {"qpos": state["qpos"], "act": np.full(416, 0.25)}})
    assert np.array_equal(long.state["qpos"], state["qpos"])
    assert np.all(long.state["act"] == 0.25) and long.state["ctrl"].shape == (416,)
    play(long, 3)


BAD_STATES = [
    ({"qpos": np.zeros(3)}, ValueError, r"the `qpos` of a state must have the shape \(129,\), found \(3,\)"),
    ({"height": np.zeros(3)}, KeyError, "a state has no `height`; it has: time, qpos"),
    ({"qvel": np.full(128, np.nan)}, ValueError, "has NaN at 0: expected a finite number"),
    ({"qpos": np.zeros(129)}, ValueError, "the quaternion of joint `.*` in `qpos` is zero"),
]


@pytest.mark.parametrize(("state", "error", "message"), BAD_STATES)
def test_wrong_states(env: msk.Env, state: dict, error: type[Exception], message: str):
    with pytest.raises(error, match=message):
        env.reset(options={"state": state})


def test_weights_change_while_it_runs(long: msk.Env):
    long.reset(seed=0)
    assert dict(long.weights) == {"upright": 2.0, "change": 3.0}
    long.weights["upright"] = 4
    _, _, _, _, info = long.step(np.zeros(416, np.float32))
    assert info["contributions"]["upright"] == 4 * info["terms"]["upright"]
    with pytest.raises(KeyError, match="the task `balance` has no term `uprigt`; it has: upright, change"):
        long.weights["uprigt"] = 1
    with pytest.raises(ValueError, match="cannot be 9"):
        long.weights["upright"] = 9
    with pytest.raises(ValueError, match="change"):
        long.weights["change"] = 1
    with pytest.raises(ValueError, match="number"):
        long.weights["upright"] = float("nan")
    with pytest.raises(ValueError, match="change"):
        long.weights.update({"upright": 1, "change": 1})
    assert dict(long.weights) == {"upright": 4.0, "change": 3.0}


def test_scheduled_weights_follow_the_progress_of_a_training():
    task = short(("2 (1..4)  upright", "4 -> 2 over 50 % (1..4) upright"))
    assert (task.terms[0].weight, task.terms[0].schedule, task.terms[1].schedule) == (2.0, (4.0, 0.0, 0.5), None)
    env = gymnasium.wrappers.TimeLimit(msk.make(task), 5)
    assert env.unwrapped.progress == 1.0
    for progress, weight in ((0.0, 4.0), (0.25, 3.0), (0.5, 2.0), (1, 2.0)):
        env.unwrapped.progress = progress
        env.reset(seed=0)
        *_, info = env.step(np.zeros(416, np.float32))
        assert info["contributions"]["upright"] == weight * info["terms"]["upright"]
    env.unwrapped.progress = 0.0
    env.unwrapped.weights["upright"] = 1
    assert env.unwrapped.weights["upright"] == 1.0, "the last weight"
    *_, info = env.step(np.zeros(416, np.float32))
    assert info["contributions"]["upright"] == 4 * info["terms"]["upright"]
    for wrong in (-0.1, 1.1, float("nan")):
        with pytest.raises(ValueError, match="a number from 0 to 1"):
            env.unwrapped.progress = wrong


PARAMS = (
    "    init {",
    "    params { pace = 50 cm/s (10..200 cm/s) per episode; lean = 5 deg (0..20 deg) }\n    init {",
)
"""The change that gives the short task a parameter per episode, and a constant one."""
READ = ("observe {", "observe { pace; lean;")


def test_parameters_change_from_episode_to_episode():
    task = short(PARAMS, READ, CALM)
    pace, lean = task.parameters
    assert (pace.value, pace.unit, pace.range, pace.per_episode) == (0.5, "m/s", (0.1, 2.0), True)
    assert not lean.per_episode
    env = msk.make(task, dtype=np.float64)
    observation, info = env.reset(seed=0)
    assert observation[0] == 0.5
    assert "params" not in info
    observation, info = env.reset(seed=0, options={"params": {"pace": 150}})
    assert observation[0] == 1.5
    assert info["params"] == {"pace": 150.0}
    observation, info = env.reset()
    assert observation[0] == 1.5, "until another is given"
    for params, message in (
        ({"pce": 1}, "no parameter `pce`; did you mean `pace`"),
        ({"lean": 3}, "`lean` is a constant of the compiled task"),
        ({"pace": 300}, "`pace` is 3; expected a number from 0.1 to 2, in SI units"),
        ({"pace": 20, "lean": 1}, "`lean` is a constant"),
    ):
        with pytest.raises(ValueError, match=message):
            env.reset(options={"params": params})
    observation, _ = env.reset()
    assert observation[0] == 1.5, "all of them or none"
    # A task that was compiled with the value plays the same.
    given = msk.make(task, dtype=np.float64)
    given.reset(seed=3, options={"params": {"pace": 120}})
    compiled = msk.make(short(PARAMS, READ, CALM, params={"pace": 120}), dtype=np.float64)
    compiled.reset(seed=3)
    assert all(
        np.array_equal(a[0], b[0]) and a[1] == b[1] for a, b in zip(play(given, 5), play(compiled, 5), strict=True)
    )


@pytest.mark.parametrize(("word", "truncated"), [("", False), ("bootstrap ", True)])
def test_a_learner_bootstraps_where_the_task_says_so(word: str, truncated: bool):
    finish = "    success survived", f"    finish {{ done {word}when step >= 2 }}\n    success survived"
    task = short(CALM, finish)
    assert task.bootstraps == (("done",) if truncated else ())
    env = msk.make(task)
    env.reset(seed=0)
    env.step(np.zeros(416, np.float32))
    *_, ended, cut, info = env.step(np.zeros(416, np.float32))
    assert (ended, cut, info["ending"], info["bootstrap"]) == (not truncated, truncated, "finished", truncated)
    envs = msk.make_vec(task, 2, threads=1)
    envs.reset(seed=0)
    envs.step(np.zeros((2, 416), np.float32))
    *_, ended, cut, infos = envs.step(np.zeros((2, 416), np.float32))
    assert (ended.all(), cut.all()) == (not truncated, truncated)
    assert infos["final_info"]["bootstrap"].tolist() == [truncated] * 2


def test_rendering(task: msk.Task):
    env = msk.make(task, render_mode="ansi")
    env.reset(seed=0)
    assert env.render() == "balance: step 0 of 12, 0.00 s, return 0"
    env.step(np.zeros(416, np.float32))
    assert [line.split()[0] for line in env.render().splitlines()] == ["balance:", "upright", "change"]
    assert env.metadata["render_fps"] == 100
    assert msk.make(task).render() is None
    with pytest.raises(ValueError, match="there is no render mode `human`"):
        msk.make(task, render_mode="human")


def test_a_picture_is_svg(env: msk.Env):
    env.reset(seed=0)
    picture = env.draw("Standing")
    assert picture.startswith("<svg") and "Standing" in picture._repr_svg_()


def test_a_task_travels_between_processes(task: msk.Task):
    other = pickle.loads(pickle.dumps(task.reweighted({"upright": 3})))
    assert other.hash == task.hash and [term.weight for term in other.terms] == [3.0, 3.0]


def test_a_task_declares_its_actions():
    """`examples/11_actions.msk` has action spaces of other sizes than the number of muscles."""
    with pytest.raises(ValueError, match="select one with `task=`") as several:
        msk.compile(REPOSITORY / "examples" / "11_actions.msk")
    for name in re.findall(r"tasks: (.*);", str(several.value))[0].split(", "):
        env = msk.make(msk.compile(REPOSITORY / "examples" / "11_actions.msk", task=name))
        assert env.action_space.shape == (len(env.task.actions),)
        env.reset(seed=0)
        observation = env.step(np.zeros(env.action_space.shape, np.float32))[0]
        envs = msk.make_vec(env.task, 2, threads=1)
        envs.reset(seed=0)
        assert np.array_equal(envs.step(np.zeros(envs.action_space.shape, np.float32))[0][0], observation)


def test_what_only_a_critic_sees():
    """It stands beside the observation, alone and in a vector, and at the end of an episode."""
    task = short(("observe {", "critic { height = pelvis.height; com.velocity }\n    observe {"))
    assert [(part.name, part.offset, part.size) for part in task.critic] == [("height", 0, 1), ("com.velocity", 1, 3)]
    env, envs = msk.make(task), msk.make_vec(task, 2)
    observation, _ = env.reset(seed=3)
    envs.reset(seed=3)
    assert observation.shape == (task.observation_size,) and env.critic_observation.shape == (4,)
    assert np.array_equal(envs.critic_observations[0], env.critic_observation)
    ended = np.zeros(2, np.bool_)
    while not ended.any():
        before = envs.critic_observations
        *_, terminated, truncated, infos = envs.step(actions(task, 2))
        ended = terminated | truncated
        assert not np.array_equal(before, envs.critic_observations)
    assert infos["final_critic_obs"].shape == (2, 4) and not infos["final_critic_obs"][~ended].any()
    assert not np.array_equal(infos["final_critic_obs"][ended], envs.critic_observations[ended])


def test_a_state_has_strengths_masses_and_frictions(long: msk.Env):
    long.reset(seed=1)
    state = long.state
    assert np.all(state["strength"] == 1) and state["strength"].shape == (416,) and np.all(state["mass_scale"] == 1)
    weak = {"strength": np.full(416, 0.5), "friction": np.full_like(state["friction"], 0.3)}
    long.reset(seed=1, options={"state": weak})
    assert np.all(long.state["strength"] == 0.5) and np.all(long.state["friction"] == 0.3)
    with pytest.raises(ValueError, match="`mass_scale` has 0 at 0: expected more than 0"):
        long.reset(options={"state": {"mass_scale": np.zeros_like(state["mass_scale"])}})


def test_one_of_several_tasks_of_a_file(tmp_path):
    file = tmp_path / "two.msk"
    file.write_text(SHORT + SHORT.replace("balance", "other"))
    assert msk.compile(f"{file}@other").name == msk.compile(file, task="other").name == "other"
    with pytest.raises(ValueError, match="there is no task `third` in"):
        msk.make(f"{file}@third")
    with pytest.raises(ValueError, match="contains 2 tasks: balance, other"):
        msk.make(file)
