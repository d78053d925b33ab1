"""Rollouts for learners, collected by a cluster."""

import os
import signal
import sys
from pathlib import Path

import numpy as np
import pytest

import msk
from conftest import short

ray = pytest.importorskip("ray")
# Workers cannot import this file.
ray.cloudpickle.register_pickle_by_value(sys.modules[__name__])

#: Slots, those of a group, steps: longer than the episodes, so that some end.
SIZES = {"num_envs": 4, "batch_size": 2, "steps": 20}


class Linear:
    """Actions that depend on what is seen, on the state, and on chance."""

    def __call__(self, observations, state, generator):
        noise = generator.normal(size=(len(observations), 416)).astype(np.float32)
        actions = np.tanh(0 if state is None else state["gain"] * observations[:, :1] + state["noise"] * noise)
        actions = np.broadcast_to(actions, noise.shape).astype(np.float32)
        return actions, {"chance": -(noise**2).sum(axis=1), "noise": noise}


STATE = {"gain": np.float32(0.1), "noise": np.float32(0.3)}

ARRAYS = (
    *("observations", "actions", "rewards", "terminated", "truncated", "last_observations", "ends"),
    *("final_observations", "critic_observations", "slots"),
)


def bits(rollout) -> dict[str, bytes]:
    """All numbers of a rollout."""
    arrays = {name: getattr(rollout, name) for name in ARRAYS} | rollout.extras | rollout.episodes
    return {name: array.tobytes() for name, array in arrays.items()}


def collected(times: int, task: msk.Task, **settings):
    """So many rounds of rollouts, and the collector's last words."""
    import msk.ray

    with msk.ray.Collector(task, Linear(), **SIZES | settings) as collector:
        collector.broadcast(STATE)
        return [collector.collect() for _ in range(times)]


@pytest.fixture(scope="module")
def rounds(cluster, task: msk.Task):
    """Two rounds on two nodes."""
    return collected(2, task)


def test_a_rollout_is_what_an_environment_gives(rounds, task: msk.Task):
    for group, (first, second) in enumerate(zip(*rounds, strict=True)):
        assert first.group == group and (first.number, second.number) == (0, 1)
        assert (first.version, first.restarts, list(first.slots)) == (1, 0, [2 * group, 2 * group + 1])
        envs = msk.make_vec(task, 2, clip_actions=True)
        observations, _ = envs.reset(seed=2 * group)
        for rollout in (first, second):
            ended = 0
            for step in range(20):
                assert np.array_equal(rollout.observations[step], observations)
                observations, rewards, terminated, truncated, infos = envs.step(rollout.actions[step])
                assert np.array_equal(rollout.rewards[step], rewards)
                assert np.array_equal(rollout.terminated[step], terminated)
                assert np.array_equal(rollout.truncated[step], truncated)
                for slot in np.flatnonzero(terminated | truncated):
                    assert rollout.ends[ended].tolist() == [step, slot]
                    assert np.array_equal(rollout.final_observations[ended], infos["final_obs"][slot])
                    final = infos["final_info"]
                    for name in ("return", "steps", "is_success", "seed", "episode_index"):
                        assert rollout.episodes[name][ended] == final[name][slot], name
                    returns = [final["term_returns"][term.name][slot] for term in task.terms]
                    assert rollout.episodes["term_returns"][ended].tolist() == returns
                    ended += 1
            assert np.array_equal(rollout.last_observations, observations)
            assert ended == len(rollout.ends) > 0
            assert rollout.extras["chance"].shape == (20, 2) and rollout.extras["noise"].shape == (20, 2, 416)
            assert rollout.seconds.stepping > 0 and 0 <= rollout.seconds.host_share < 1


def test_numbers_do_not_depend_on_the_number_of_actors(rounds, task: msk.Task):
    one = dict([next(iter(msk.ray.crew.node_processors().items()))])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(msk.ray.crew, "node_processors", lambda: one)
        alone = collected(2, task)
    assert [[bits(rollout) for rollout in one] for one in alone] == [
        [bits(rollout) for rollout in one] for one in rounds
    ]


def test_values_count_where_an_episode_was_truncated(rounds):
    rollout = rounds[0][0]
    assert rollout.truncated.any() and rollout.terminated.any(), "both kinds of ends"
    rewards = rollout.bootstrapped(np.full(len(rollout.ends), 2.0), discount=0.5)
    assert np.array_equal(rewards - rollout.rewards, np.where(rollout.truncated, 1.0, 0.0))
    with pytest.raises(ValueError, match="expected a value for each of"):
        rollout.bootstrapped(np.zeros(len(rollout.ends) + 1), discount=0.5)


def test_arrays_are_views_of_the_object_store(rounds):
    assert not rounds[0][0].observations.flags.writeable and not rounds[0][0].observations.flags.owndata


def test_the_learner_works_while_groups_are_collected(cluster, task: msk.Task, rounds):
    import msk.ray

    with msk.ray.Collector(task, Linear(), **SIZES) as collector:
        collector.broadcast(STATE)
        seen = []
        for version in range(2, 8):
            rollout = collector.next()
            seen.append(rollout)
            assert 0 <= collector.version - rollout.version <= 4
            assert collector.broadcast(STATE) == version
        with pytest.raises(RuntimeError, match="rollouts are under way"):
            collector.collect()
        for group in (0, 1):
            own = [rollout for rollout in seen if rollout.group == group]
            assert [rollout.number for rollout in own] == list(range(len(own)))
            assert [rollout.version for rollout in own] == sorted(rollout.version for rollout in own)
        assert seen[-1].version > 1
        # The state is the same all the time, so the numbers are, too.
        known = {(rollout.group, rollout.number): bits(rollout) for one in rounds for rollout in one}
        assert all(known.get((one.group, one.number), bits(one)) == bits(one) for one in seen)
        assert 0 <= collector.seconds.host_share < 1 and 0 <= collector.waiting_share <= 1


class Fatal(Linear):
    """Kills its process at the first step of the second rollout of the group that it acts for first, once."""

    def __init__(self, file: Path) -> None:
        self.file, self.calls = file, 0

    def __call__(self, observations, state, generator):
        self.calls += 1
        if self.calls == 21:
            # Two processes come here at the same time: the one that creates the file is killed.
            try:
                self.file.touch(exist_ok=False)
            except FileExistsError:
                pass
            else:
                os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(observations, state, generator)


def test_a_killed_worker_is_replaced_and_its_groups_begin_new_episodes(cluster, task: msk.Task, tmp_path: Path, rounds):
    import msk.ray

    with msk.ray.Collector(task, Fatal(tmp_path / "killed"), **SIZES) as collector:
        collector.broadcast(STATE)
        first, second, third = (collector.collect() for _ in range(3))
    assert (tmp_path / "killed").exists()
    assert [bits(rollout) for rollout in first] == [bits(rollout) for rollout in rounds[0]]
    [lost] = [rollout for rollout in second if rollout.restarts]
    [kept] = [rollout for rollout in second if not rollout.restarts]
    assert bits(kept) == bits(rounds[1][kept.group])
    # The lost group goes on with other episodes of its seeds: those that a fresh environment plays from there on.
    assert lost.restarts == 1 and lost.number == 1
    assert (lost.episodes["episode_index"] >= 2**32).all()
    env = msk.make(task)
    for slot, seed in enumerate(lost.slots):
        observation, _ = env.reset(seed=int(seed), options={"episode_index": 2**32})
        assert np.array_equal(lost.observations[0, slot], observation)
    assert [rollout.restarts for rollout in third] == [rollout.restarts for rollout in second]


class Doomed(Linear):
    """Kills every process that it acts in."""

    def __call__(self, observations, state, generator):
        os.kill(os.getpid(), signal.SIGKILL)


def test_workers_that_always_die_are_an_error_and_no_hang(cluster, task: msk.Task):
    import msk.ray

    with msk.ray.Collector(task, Doomed(), **SIZES) as collector, pytest.raises(ray.exceptions.RayActorError):
        collector.collect()


class Wrong(Linear):
    """Gives actions of a wrong shape when its state says so."""

    def __call__(self, observations, state, generator):
        return np.zeros((1, 1), np.float32) if state == "wrong" else super().__call__(observations, state, generator)


def test_what_a_policy_does_wrong_is_reported_and_the_collector_goes_on(cluster, task: msk.Task):
    import msk.ray

    with msk.ray.Collector(task, Wrong(), **SIZES) as collector:
        collector.broadcast("wrong")
        with pytest.raises(ValueError, match=r"an action must have the shape \(2, 416\), found \(1, 1\)"):
            collector.collect()
        collector.broadcast(STATE)
        assert [rollout.restarts for rollout in collector.collect()] == [1, 1]


@pytest.mark.parametrize("policy", ["zero", "random"])
def test_policies_have_names(cluster, task: msk.Task, policy: str):
    import msk.ray

    with msk.ray.Collector(task, policy, **SIZES) as collector:
        actions = np.concatenate([rollout.actions for rollout in collector.collect()])
    assert actions.dtype == np.float32 and (np.abs(actions) <= 1).all()
    assert (actions == -1).all() if policy == "zero" else actions.std() > 0.5


def test_agents_act_in_rollouts(cluster):
    import msk.ray

    with msk.ray.Collector("stand", "agents", num_envs=2, batch_size=2, steps=3) as collector:
        [rollout] = collector.collect()
    agent = msk.Agent.built_in("stand")
    assert np.array_equal(rollout.actions[0], agent.act(np.array(rollout.observations[0])))


def test_what_cannot_be_collected_is_refused(cluster, task: msk.Task):
    import msk.ray

    with pytest.raises(ValueError, match="a batch size that divides the number of environments, found 3 and 4"):
        msk.ray.Collector(task, "zero", num_envs=4, batch_size=3, steps=1)
    with pytest.raises(ValueError, match="at least one step"):
        msk.ray.Collector(task, "zero", num_envs=4, batch_size=2, steps=0)
    with pytest.raises(TimeoutError, match="no node of the cluster has 1000 processors"):
        msk.ray.Collector(task, "zero", num_envs=4, batch_size=2, steps=1, threads=1000)
    with (
        pytest.raises((ValueError, ray.exceptions.RayError), match="there is no policy `cmc` for rollouts"),
        msk.ray.Collector(short(), "cmc", **SIZES) as collector,
    ):
        collector.collect()
