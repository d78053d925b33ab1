#!/usr/bin/env python3
"""Curves of a reference learner on MuJoCo, beside which those of `msk train` stand.

    pip install "gymnasium[mujoco]==1.4.0" "mujoco==4.0.0" "stable-baselines3==2.9.2"
    python benches/learning/reference.py ppo HalfCheetah-v5 --seed 1 --steps 300000 >> benches/learning/reference.csv

Stable-Baselines3 on Gymnasium's own environment. PPO has the settings of CleanRL's `ppo_continuous_action.py`: one environment, 2048 steps between
updates, minibatches of 64, ten epochs, a rate that falls from 3e-4 to 0, observations and rewards that are normalised and clipped at 10,
layers of 64 and 64 with tanh. SAC has the library's own: layers of 256 and 256 with ReLU, batches of 256, a gradient step for each control step
after 5000 random ones, rates of 3e-4.

Writes the rows of `curves.py`: evaluations of ten episodes without chance in the actions, and the mean return of the training's own episodes
since the evaluation before. Standard error has the speed of training, evaluations left out. One thread.
"""

import argparse
import sys
import time

import gymnasium
import numpy
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

TASKS = {"HalfCheetah-v5": "half_cheetah", "Hopper-v5": "hopper", "Walker2d-v5": "walker2d"}


def environment(name: str, normalize: bool):
    found = DummyVecEnv([lambda: Monitor(gymnasium.make(name))])
    return VecNormalize(found, clip_obs=10.0, clip_reward=10.0, gamma=0.99) if normalize else found


def learner(algorithm: str, training, seed: int):
    shared = {"policy": "MlpPolicy", "env": training, "seed": seed, "device": "cpu"}
    if algorithm == "sac":
        return SAC(**shared, learning_starts=5000)
    return PPO(**shared, learning_rate=lambda left: 3e-4 * left, clip_range_vf=0.2)


class Evaluations(BaseCallback):
    """A row for every so many control steps."""

    def __init__(self, judged, every: int, names: list):
        super().__init__()
        self.judged, self.every, self.names = judged, every, names
        self.returns, self.begin, self.training_time = [], time.process_time(), 0.0

    def _on_step(self) -> bool:
        self.returns += [info["episode"]["r"] for info in self.locals["infos"] if "episode" in info]
        if self.num_timesteps % self.every == 0:
            self.training_time += time.process_time() - self.begin
            self.evaluate()
            self.begin = time.process_time()
        return True

    def evaluate(self) -> None:
        if isinstance(self.judged, VecNormalize):
            self.judged.obs_rms = self.training_env.obs_rms
            self.judged.training = self.judged.norm_reward = False
        found, _ = evaluate_policy(self.model, self.judged, n_eval_episodes=10, return_episode_rewards=True)
        own = numpy.mean(self.returns) if self.returns else numpy.nan
        row = [*self.names, self.num_timesteps, f"{numpy.mean(found):.2f}", "", f"{own:.2f}"]
        print(",".join(map(str, row)), flush=True)
        self.returns = []


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("algorithm", choices=["ppo", "sac"])
    parser.add_argument("environment", choices=sorted(TASKS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--every", type=int, default=50_000, help="control steps between evaluations")
    given = parser.parse_args()
    torch.set_num_threads(1)
    normalize = given.algorithm == "ppo"
    judged = environment(given.environment, normalize)
    judged.seed(given.seed + 1000)
    model = learner(given.algorithm, environment(given.environment, normalize), given.seed)
    names = [TASKS[given.environment], f"{given.algorithm}-reference", given.seed]
    evaluations = Evaluations(judged, given.every, names)
    model.learn(given.steps, callback=evaluations)
    rate = model.num_timesteps / evaluations.training_time
    print(f"{rate:.0f} control steps per second of CPU time", file=sys.stderr)


if __name__ == "__main__":
    main()
