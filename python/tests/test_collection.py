"""Data sets from Python, and on a cluster."""

import json
from pathlib import Path

import numpy as np
import pytest

import msk
from conftest import SHORT

#: What does not depend on where it is played.
SAME = ("run.json", "data.json", "episodes.jsonl")


def contents(folder: Path) -> dict[str, bytes]:
    """The files of a data set, wall times aside."""
    return {path.name: path.read_bytes() for path in sorted([*folder.glob("*.npz"), *(folder / name for name in SAME)])}


def test_every_step_is_kept(file: Path, tmp_path: Path):
    data = msk.collect(file, policy="random", episodes=3, seed=3, out=tmp_path / "out")
    columns = json.loads((tmp_path / "out" / "data.json").read_text())
    lines = [json.loads(line) for line in (tmp_path / "out" / "episodes.jsonl").read_text().splitlines()]
    archives = [np.load(tmp_path / "out" / f"{episode:04}.npz") for episode in range(3)]
    assert data == msk.DataSet(
        episodes=3,
        steps=sum(len(archive["rewards"]) for archive in archives),
        successes=sum(int(archive["success"][0]) for archive in archives),
        mean_return=pytest.approx(sum(archive["rewards"].sum() for archive in archives) / 3, rel=1e-12),
    )
    task = msk.compile(file)
    assert [channel["name"] for channel in columns["observations"]] == [channel.name for channel in task.channels]
    # They are the steps of the same episodes in an environment.
    env = msk.make(file)
    for episode, archive in enumerate(archives):
        observation, _ = env.reset(seed=3, options={"episode_index": episode})
        seen, rewards = [observation], []
        for action in archive["actions"]:
            observation, reward, *_ = env.step(action)
            seen.append(observation)
            rewards.append(reward)
        assert np.array_equal(archive["observations"], seen) and np.array_equal(archive["rewards"], rewards)
        assert lines[episode]["return"] == pytest.approx(sum(rewards), rel=1e-12)


def test_shards_become_one_data_set(file: Path, tmp_path: Path):
    settings = {"policy": "random", "episodes": 4}
    whole = msk.collect(file, out=tmp_path / "whole", **settings)
    # More shards than episodes: the last one has none, and no columns.
    shards = [tmp_path / str(number) for number in range(1, 6)]
    for number, shard in enumerate(shards, 1):
        msk.collect(file, out=shard, shard=f"{number}/5", **settings)
    assert msk.merge_data(shards, tmp_path / "merged") == whole
    assert contents(tmp_path / "merged") == contents(tmp_path / "whole")
    with pytest.raises(OSError, match="cannot make the folder"):
        msk.merge_data(shards, tmp_path / "merged")
    with pytest.raises(ValueError, match="episodes are missing, such as episode 0 of `balance`"):
        msk.merge_data(shards[1:], tmp_path / "other")


def test_what_cannot_be_collected_is_refused(file: Path, tmp_path: Path):
    out = tmp_path / "out"
    with pytest.raises(ValueError, match="there is no policy `nobody`"):
        msk.collect(file, policy="nobody", out=out)
    with pytest.raises(ValueError, match="there is no task `walk`"):
        msk.collect(file, task="walk", out=out)
    file.write_text(SHORT + SHORT.replace("balance", "other"))
    with pytest.raises(ValueError, match="contains 2 tasks: balance, other; select one with `task=`"):
        msk.collect(file, out=out)
    file.write_text(SHORT.replace("torso.up.z", "torso.z"))
    with pytest.raises(msk.CompileError, match="has no `z`"):
        msk.collect(file, out=out)
    assert not out.exists()


def test_a_cluster_collects_the_bytes_of_one_machine(cluster, file: Path, tmp_path: Path, capsys):
    from msk.ray.command import main

    arguments = ["collect", str(file), "--policy", "random", "--episodes", "5", "--address", cluster.address]
    assert main([*arguments, "--out", str(tmp_path / "cluster")]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("5 episodes, ") and "% of their time outside of Rust" in printed
    msk.collect(file, policy="random", episodes=5, out=tmp_path / "here")
    assert contents(tmp_path / "cluster") == contents(tmp_path / "here")
    assert not (tmp_path / "cluster-shards").exists()
    assert main([*arguments, "--task", "walk", "--out", str(tmp_path / "other")]) == 1
    assert "there is no task `walk`" in capsys.readouterr().err
