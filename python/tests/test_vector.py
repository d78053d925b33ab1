"""Many episodes side by side: equal to so many single environments, in every autoreset mode."""

import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import msk
from conftest import CALM, actions, short

SLOTS = 5


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_it_equals_gymnasiums_vector_of_single_environments(task: msk.Task, mode: AutoresetMode):
    """Observations, rewards, flags and infos, through many ends and resets, to the bit."""
    native = msk.make_vec(task, SLOTS, autoreset_mode=mode, threads=2)
    single = SyncVectorEnv([lambda: msk.make(task)] * SLOTS, autoreset_mode=mode)
    assert native.observation_space == single.observation_space and native.action_space == single.action_space
    given = [envs.reset(seed=11) for envs in (native, single)]
    assert np.array_equal(given[0][0], given[1][0]) and data_equivalence(given[0][1], given[1][1])
    ends = 0
    for action in actions(task, 40, SLOTS):
        one, other = native.step(action), single.step(action)
        for name, first, second in zip(("observation", "reward", "terminated", "truncated"), one, other, strict=False):
            assert np.array_equal(first, second), name
        ends += (one[2] | one[3]).sum()
        compare(one[4], other[4])
    assert ends > 2 * SLOTS


def compare(one: dict, other: dict) -> None:
    """Infos: equal where their masks hold; final observations are dense here, and objects there."""
    assert one.keys() == other.keys()
    for key, value in one.items():
        if isinstance(value, dict):
            compare(value, other[key])
        elif key.startswith("_"):
            assert np.array_equal(value, other[key]), key
        else:
            mask = one[f"_{key}"]
            assert all(np.array_equal(value[slot], other[key][slot]) for slot in np.flatnonzero(mask)), key


def test_the_last_observations_are_dense(task: msk.Task):
    envs = msk.make_vec(task, SLOTS, threads=1)
    envs.reset(seed=0)
    for action in actions(task, 12, SLOTS):
        *_, terminated, truncated, infos = envs.step(action)
        ended = terminated | truncated
        if ended.any():
            assert infos["final_obs"].shape == (SLOTS, task.observation_size) and infos["final_obs"].dtype == np.float32
            assert np.array_equal(infos["_final_obs"], ended) and np.array_equal(infos["_final_info"], ended)
            assert not infos["final_obs"][~ended].any()
            assert set(infos["final_info"]["ending"][ended]) <= {"terminated", "truncated"}
            return
    pytest.fail("no episode ended")


def test_without_autoreset_a_mask_chooses(task: msk.Task):
    envs = msk.make_vec(task, SLOTS, autoreset_mode=AutoresetMode.DISABLED, threads=1)
    envs.reset(seed=0)
    for action in actions(task, 12, SLOTS):
        _, _, terminated, truncated, infos = envs.step(action)
    assert (terminated | truncated).all()
    observations, rewards, terminated, truncated, infos = envs.step(actions(task, SLOTS))
    assert (terminated | truncated).all() and not rewards.any()
    mask = np.array([False, True, False, True, False])
    chosen, infos = envs.reset(options={"reset_mask": mask})
    assert np.array_equal(chosen[~mask], observations[~mask]) and (chosen[mask] != observations[mask]).any()
    assert np.array_equal(infos["_seed"], mask) and list(infos["episode_index"][mask]) == [1, 1]
    _, rewards, terminated, truncated, _ = envs.step(actions(task, SLOTS))
    assert np.array_equal(rewards != 0, mask)


def test_seeds_may_be_listed(task: msk.Task):
    envs, env = msk.make_vec(task, 3, threads=1), msk.make(task)
    observations, infos = envs.reset(seed=[4, None, 9])
    assert list(infos["seed"])[::2] == [4, 9]
    assert np.array_equal(observations[2], env.reset(seed=9)[0])
    with pytest.raises(ValueError, match="expected one seed per environment, 3, found 2"):
        envs.reset(seed=[1, 2])


def test_resets_spread(task: msk.Task):
    envs = msk.make_vec(task, 8, threads=1)
    observations = np.concatenate([envs.reset(seed=0)[0], envs.reset()[0], envs.reset(seed=100)[0]])
    assert len(np.unique(observations, axis=0)) == 24
    first, second = (msk.make_vec(task, 2, threads=1).reset()[0] for _ in range(2))
    assert not np.array_equal(first, second)


def test_results_do_not_depend_on_threads(task: msk.Task):
    def play(threads: int) -> np.ndarray:
        envs = msk.make_vec(task, 11, threads=threads)
        envs.reset(seed=2)
        return np.concatenate([envs.step(action)[0] for action in actions(task, 20, 11)])

    assert np.array_equal(play(1), play(3))


BAD_ACTIONS = [
    (np.zeros(416, np.float32), ValueError, r"must have the shape \(5, 416\), found \(416,\)"),
    (np.zeros((5, 416), np.int32), TypeError, "found int32"),
    (np.full((5, 416), np.nan), ValueError, r"action\[0, 0\], of `"),
    (np.eye(5, 416) * -2, ValueError, r"action\[0, 0\], of `.*`, is -2, not in"),
]


@pytest.mark.parametrize(("action", "error", "message"), BAD_ACTIONS)
def test_wrong_actions(task: msk.Task, action: object, error: type[Exception], message: str):
    envs = msk.make_vec(task, SLOTS, threads=1)
    with pytest.raises(gymnasium.error.ResetNeeded):
        envs.step(np.zeros((SLOTS, 416)))
    envs.reset(seed=0)
    with pytest.raises(error, match=message):
        envs.step(action)


@pytest.mark.parametrize(
    ("mask", "error"),
    [([True] * 5, TypeError), (np.ones(5), TypeError), (np.ones(4, bool), ValueError), (np.zeros(5, bool), ValueError)],
)
def test_wrong_masks(task: msk.Task, mask: object, error: type[Exception]):
    envs = msk.make_vec(task, SLOTS, threads=1)
    with pytest.raises(error, match="reset_mask"):
        envs.reset(options={"reset_mask": mask})


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_snapshot_goes_on_bit_for_bit(task: msk.Task, mode: AutoresetMode):
    envs = msk.make_vec(task, SLOTS, autoreset_mode=mode, threads=1)
    envs.reset(seed=0)
    for action in actions(task, 6, SLOTS):
        envs.step(action)
    snapshot = envs.snapshot()
    first = [envs.step(action)[:4] for action in actions(task, 15, SLOTS, seed=1)]
    other = msk.make_vec(task, SLOTS, autoreset_mode=mode, threads=2)
    # In another process a snapshot is what was pickled here.
    other.restore(pickle.loads(pickle.dumps(snapshot)))
    assert pickle.dumps(other.snapshot()) == pickle.dumps(snapshot)
    second = [other.step(action)[:4] for action in actions(task, 15, SLOTS, seed=1)]
    assert data_equivalence(first, second)
    with pytest.raises(ValueError, match="the snapshot has 5 episodes, the environment 2"):
        msk.make_vec(task, 2, threads=1).restore(snapshot)


def test_weights_are_those_of_all_slots():
    task = short(CALM)
    envs = msk.make_vec(task, SLOTS, weights={"upright": 3}, threads=1)
    envs.reset(seed=0)
    envs.weights["upright"] = 1
    _, rewards, _, _, infos = envs.step(actions(task, SLOTS))
    contributions = infos["contributions"]
    assert np.array_equal(contributions["upright"], infos["terms"]["upright"])
    assert np.allclose(contributions["upright"] + contributions["change"], rewards)


def test_the_progress_of_a_training_is_that_of_all_slots():
    envs = msk.make_vec(short(CALM, ("2 (1..4)  upright", "4 -> 2 over 50 % (1..4) upright")), SLOTS, threads=1)
    envs.reset(seed=0)
    envs.progress = 0.25
    assert envs.progress == 0.25
    *_, infos = envs.step(actions(envs.task, SLOTS))
    assert np.array_equal(infos["contributions"]["upright"], 3 * infos["terms"]["upright"])
    with pytest.raises(ValueError, match="a number from 0 to 1, found 3"):
        envs.progress = 3


def test_slots_have_parameters_of_their_own():
    change = "    params { pace = 50 cm/s (10..200 cm/s) per episode }\n    init {"
    envs = msk.make_vec(
        short(CALM, ("    init {", change), ("observe {", "observe { pace;")), 3, threads=1, dtype=np.float64
    )
    observations, infos = envs.reset(seed=0)
    assert "params" not in infos
    observations, infos = envs.reset(options={"params": {"pace": np.array([20, 60, 180])}})
    assert np.allclose(observations[:, 0], [0.2, 0.6, 1.8])
    assert np.array_equal(infos["params"]["pace"], [20, 60, 180])
    mask = np.array([True, False, False])
    observations, infos = envs.reset(options={"params": {"pace": 100}, "reset_mask": mask})
    assert np.allclose(observations[:, 0], [1.0, 0.6, 1.8])
    assert np.array_equal(infos["params"]["pace"], [100, 60, 180])
    with pytest.raises(ValueError, match="`pace` is 9"):
        envs.reset(options={"params": {"pace": 900}})
    with pytest.raises(ValueError, match="broadcast"):
        envs.reset(options={"params": {"pace": [1, 2]}})


def test_wrong_numbers_of_environments(task: msk.Task):
    for settings in ({"num_envs": 0}, {"num_envs": 2, "threads": 0}):
        with pytest.raises(ValueError, match="at least one environment and one thread"):
            msk.make_vec(task, **settings)
    with pytest.raises(ValueError, match="there is no render mode `ansi`"):
        msk.make_vec(task, 2, render_mode="ansi")
