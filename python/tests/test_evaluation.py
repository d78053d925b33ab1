"""Evaluations from Python, and on a cluster."""

import json
import signal
import sys
import threading
from pathlib import Path

import pytest

import msk
from conftest import SHORT

#: What does not depend on where it is played.
SAME = ("run.json", "episodes.jsonl", "summary.json", "report.md")


def contents(folder: Path) -> list[bytes]:
    return [(folder / name).read_bytes() for name in SAME]


def test_results_are_kept_and_resumed(file: Path, tmp_path: Path):
    summary = msk.evaluate(file, policy="random", episodes=5, seed=3, out=tmp_path / "out")
    [task] = summary["tasks"]
    assert (task["task"], task["episodes"], summary["policy"]) == ("balance", 5, "random")
    assert summary == json.loads((tmp_path / "out" / "summary.json").read_text())
    before = contents(tmp_path / "out")
    assert msk.evaluate(file, policy="random", episodes=5, seed=3, out=tmp_path / "out", threads=1) == summary
    assert contents(tmp_path / "out") == before
    with pytest.raises(ValueError, match="contains another run: its seed is 3, not 4"):
        msk.evaluate(file, policy="random", episodes=5, seed=4, out=tmp_path / "out")


def test_shards_become_one_run(file: Path, tmp_path: Path):
    settings = {"policy": "random", "episodes": 5}
    msk.evaluate(file, out=tmp_path / "whole", **settings)
    shards = [tmp_path / str(number) for number in (1, 2, 3)]
    for number, shard in enumerate(shards, 1):
        msk.evaluate(file, out=shard, shard=f"{number}/3", **settings)
    msk.merge(shards, tmp_path / "merged")
    assert contents(tmp_path / "merged") == contents(tmp_path / "whole")
    with pytest.raises(OSError, match="cannot make the folder"):
        msk.merge(shards, tmp_path / "merged")
    with pytest.raises(ValueError, match="episodes are missing, such as episode 0 of `balance`"):
        msk.merge(shards[1:], tmp_path / "other")


def test_what_cannot_be_evaluated_is_refused(file: Path, tmp_path: Path):
    out = tmp_path / "out"
    with pytest.raises(ValueError, match="there is no policy `nobody`"):
        msk.evaluate(file, policy="nobody", out=out)
    with pytest.raises(ValueError, match="it imagines hundreds of episodes|there is no policy `plan`"):
        msk.evaluate(file, policy="plan", out=out)
    with pytest.raises(ValueError, match="there is no task `walk`"):
        msk.evaluate(file, task="walk", out=out)
    with pytest.raises(ValueError, match="expected NUMBER/COUNT"):
        msk.evaluate(file, shard="3/2", out=out)
    file.write_text(SHORT.replace("torso.up.z", "torso.z"))
    with pytest.raises(msk.CompileError, match="has no `z`"):
        msk.evaluate(file, out=out)
    assert not out.exists()


def test_an_interrupt_ends_an_evaluation_which_goes_on_later(tmp_path: Path):
    # What runs in the background of a shell begins with the signal ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(1.5, lambda: signal.raise_signal(signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            msk.evaluate("stand", policy="zero", episodes=100_000, out=tmp_path / "out")
    finally:
        signal.signal(signal.SIGINT, before)
    kept = (tmp_path / "out" / "episodes.jsonl").read_text().splitlines()
    assert len(kept) < 100_000 and (tmp_path / "out" / "summary.json").exists()


#: A policy that kills the process which asks it, once.
FATAL = """
import json, os, signal, sys
for line in sys.stdin:
    request = json.loads(line)
    if "task" in request:
        size = len(request["task"]["action"])
        # Several processes come here at the same time: the one that creates the file is killed.
        try:
            open(sys.argv[1], "x").close()
        except FileExistsError:
            pass
        else:
            os.kill(os.getppid(), signal.SIGKILL)
        reply = {"ready": True}
    else:
        reply = {"action": [-1.0] * size}
    print(json.dumps(reply), flush=True)
"""


def test_a_cluster_writes_the_bytes_of_one_machine_although_a_worker_dies(cluster, file: Path, tmp_path: Path):
    import msk.ray

    (tmp_path / "fatal.py").write_text(FATAL)
    settings = {"policy": f"process {sys.executable} {tmp_path / 'fatal.py'} {tmp_path / 'killed'}", "episodes": 6}
    summary, timing = msk.ray.evaluate(file, out=tmp_path / "cluster", shards=3, **settings)
    assert (tmp_path / "killed").exists()
    assert timing.workers == 2 and 0 <= timing.host_share < 1
    assert msk.evaluate(file, out=tmp_path / "here", **settings) == summary
    assert contents(tmp_path / "cluster") == contents(tmp_path / "here")
    assert not (tmp_path / "cluster-shards").exists()
    with pytest.raises(FileExistsError):
        msk.ray.evaluate(file, out=tmp_path / "cluster", **settings)


def test_a_command_evaluates_on_a_cluster(cluster, file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    from msk.ray.command import main

    arguments = ["eval", str(file), "--policy", "random", "--episodes", "4", "--address", cluster.address]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    assert "balance" in capsys.readouterr().out
    assert main([*arguments, "--task", "walk", "--out", str(tmp_path / "other")]) == 1
    assert "there is no task `walk`" in capsys.readouterr().err


def test_what_has_come_back_is_not_played_again(cluster, file: Path, tmp_path: Path):
    import msk.ray

    settings = {"policy": "random", "episodes": 4}
    kept = tmp_path / "out-shards" / "1-of-2"
    kept.parent.mkdir()
    msk.evaluate(file, out=kept, shard="1/2", **settings)
    times = (kept / "wall_times.jsonl").read_text()
    msk.ray.evaluate(file, out=tmp_path / "out", shards=2, **settings)
    assert times in (tmp_path / "out" / "wall_times.jsonl").read_text()
    msk.evaluate(file, out=tmp_path / "here", **settings)
    assert contents(tmp_path / "out") == contents(tmp_path / "here")
