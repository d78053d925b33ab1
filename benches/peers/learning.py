"""Time that learning takes: `msk train` against Stable-Baselines3, in turn, on the same tasks.

    cargo build --release
    pip install ./python "stable-baselines3==2.9.2"
    python benches/peers/learning.py ppo half_cheetah hopper walker2d --steps 300000 --every 50000 > ppo.csv
    python benches/peers/learning.py sac half_cheetah --steps 60000 > sac.csv

Both play the same task in our simulator, eight episodes side by side on one thread, so that what differs is the learner. Stable-Baselines3 gets the settings of
our preset `fast`; where it has none of that name (SAC: one rate for all, actors as often as critics), its own. Both evaluate ten episodes without
chance every `--every` control steps.

Writes a row per evaluation: algorithm, task, learner, seed, control steps, seconds from the start until they were reached, mean return. Standard error has, for each
task, the time of all steps scaled to a million, and the time to each threshold that both reach.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecNormalize

from msk.stable_baselines3 import VecEnv

ROOT = Path(__file__).parents[2]
EPISODES = 8
"""Side by side, in training."""
EVALUATED = 10
"""Episodes of an evaluation."""
SHARES = [0.5, 0.8]
"""Of the return that the worse of both ends with: thresholds."""


def ours(task: Path, given: argparse.Namespace, seed: int):
    """Control steps, seconds and return of each evaluation of `msk train`."""
    with tempfile.TemporaryDirectory() as folder:
        settings, out = Path(folder) / "settings.toml", Path(folder) / "out"
        settings.write_text(
            f'algorithm = "{given.algorithm}"\nevaluate_every = {given.every}\nevaluation_episodes = {EVALUATED}\n'
        )
        command = [given.msk, "train", task, "--settings", settings, "--steps", given.steps, "--seed", seed, "--threads", 1]
        subprocess.run([str(word) for word in [*command, "--out", out]], check=True, stdout=subprocess.DEVNULL)
        seconds = 0.0
        for line in map(json.loads, (out / "curve.jsonl").read_text().splitlines()):
            if "evaluation" in line:
                yield line["step"], seconds, line["evaluation"]["return"]
            else:
                seconds = line["seconds"]


class Evaluations(BaseCallback):
    """What `ours` gives, of Stable-Baselines3."""

    def __init__(self, judged: VecNormalize, every: int):
        super().__init__()
        self.judged, self.every, self.next = judged, every, every
        self.begin, self.rows = time.perf_counter(), []

    def _on_step(self) -> bool:
        if self.num_timesteps >= self.next:
            seconds = time.perf_counter() - self.begin
            self.next += self.every
            self.judged.obs_rms = self.training_env.obs_rms
            mean, _ = evaluate_policy(self.model, self.judged, n_eval_episodes=EVALUATED)
            self.rows.append((self.num_timesteps, seconds, mean))
        return True


def environments(task: Path, episodes: int, algorithm: str, training: bool):
    made = VecEnv(task, episodes, threads=1)
    reward = training and algorithm == "ppo"
    return VecNormalize(made, training=training, norm_reward=reward, clip_obs=10.0, clip_reward=10.0, gamma=0.99)


def learner(algorithm: str, training, seed: int):
    shared = {"policy": "MlpPolicy", "env": training, "seed": seed, "device": "cpu"}
    if algorithm == "sac":
        # A gradient step for every fourth transition.
        return SAC(**shared, learning_starts=5000, batch_size=256, train_freq=1, gradient_steps=EPISODES // 4)
    layers = {"net_arch": [64, 64], "activation_fn": torch.nn.Tanh}
    rate = {"learning_rate": lambda left: 3e-4 * left}
    return PPO(**shared, **rate, n_steps=256, batch_size=64, n_epochs=10, clip_range_vf=0.2, policy_kwargs=layers)


def theirs(task: Path, given: argparse.Namespace, seed: int):
    """Control steps, seconds and return of each evaluation of Stable-Baselines3."""
    judged = environments(task, EVALUATED, given.algorithm, training=False)
    judged.seed(seed + 1000)
    model = learner(given.algorithm, environments(task, EPISODES, given.algorithm, training=True), seed)
    evaluations = Evaluations(judged, given.every)
    model.learn(given.steps, callback=evaluations)
    return evaluations.rows


def reached(rows, threshold: float):
    """Seconds until an evaluation returned as much, or none."""
    return next((seconds for _, seconds, mean in rows if mean >= threshold), None)


def summary(task: str, curves: dict) -> str:
    """`curves` holds the evaluations of each seed, of each learner."""
    lines = [f"{task}:"]
    million = {
        name: statistics.median(rows[-1][1] / rows[-1][0] * 1e6 for rows in seeds) for name, seeds in curves.items()
    }
    lines += [f"  a million control steps: {name} {seconds:.0f} s" for name, seconds in million.items()]
    end = min(statistics.median(rows[-1][2] for rows in seeds) for seeds in curves.values())
    for threshold in (share * end for share in SHARES):
        times = {name: [reached(rows, threshold) for rows in seeds] for name, seeds in curves.items()}
        words = [f"{name} {', '.join('never' if at is None else f'{at:.0f} s' for at in of)}" for name, of in times.items()]
        lines.append(f"  return of {threshold:.0f}: {'; '.join(words)}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("algorithm", choices=["ppo", "sac"])
    parser.add_argument("tasks", nargs="+", help="names of files in examples/peers")
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--every", type=int, default=20_000, help="control steps between evaluations")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--msk", type=Path, default=ROOT / "target/release/msk")
    given = parser.parse_args()
    torch.set_num_threads(1)
    print("algorithm,task,learner,seed,step,seconds,return")
    for name in given.tasks:
        task, curves = ROOT / f"examples/peers/{name}.msk", defaultdict(list)
        for seed in range(1, given.seeds + 1):
            for learns, train in [("msk", ours), ("stable-baselines3", theirs)]:
                rows = list(train(task, given, seed))
                curves[learns].append(rows)
                for step, seconds, mean in rows:
                    print(f"{given.algorithm},{name},{learns},{seed},{step},{seconds:.2f},{mean:.2f}", flush=True)
        print(summary(name, curves), file=sys.stderr)


if __name__ == "__main__":
    main()
