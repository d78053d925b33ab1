"""PPO or SAC of Stable-Baselines3 on the native vector environment.

    pip install "./python[sb3]" tensorboard tqdm rich
    python examples/python/sb3.py ppo --task stand --minutes 10
    python examples/python/sb3.py ppo --task stand --minutes 10 --resume runs/stand-ppo/latest

TensorBoard (`tensorboard --logdir runs`) shows the return of each term, success and lengths. A checkpoint holds networks,
optimizers, normaliser, replay buffer, random generators and the environments with their episodes, so that a resumed run
goes on with the same numbers as one that was never interrupted, on as many threads of PyTorch.
"""

from __future__ import annotations

import argparse
import pickle
import random
import time
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import torch
from msk.stable_baselines3 import VecEnv
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecNormalize

#: So large that time ends a run.
FOREVER = 10**12


class Progress(BaseCallback):
    """Logs what ended episodes report, saves once a minute, and stops when the time is over, or after so many steps."""

    def __init__(
        self, folder: Path, minutes: float = float("inf"), steps: int = FOREVER
    ) -> None:
        super().__init__()
        self.folder = folder
        self.end = time.monotonic() + 60 * minutes
        self.steps = steps
        self.saved = time.monotonic()
        self.over = False
        #: The episodes that ended last, and those that ended first.
        self.ended: deque[dict[str, float]] = deque(maxlen=100)
        self.first: list[dict[str, float]] = []

    def _on_rollout_start(self) -> None:
        # Here nothing is half done: the learner has learned from all that it has seen.
        now = time.monotonic()
        self.over = now > self.end or self.num_timesteps >= self.steps
        if self.over or now > self.saved + 60:
            save(self.model, self.folder)
            self.saved = now

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if "term_returns" in info:
                terms = {
                    f"terms/{name}": value
                    for name, value in info["term_returns"].items()
                }
                whole = {
                    "episode/return": info["return"],
                    "episode/success": info["is_success"],
                    "episode/steps": info["steps"],
                }
                self.ended.append(terms | whole)
                if len(self.first) < 100:
                    self.first.append(whole)
        if self.ended and self.n_calls % 64 == 0:
            for key in self.ended[0]:
                self.logger.record(
                    key, float(np.mean([episode[key] for episode in self.ended]))
                )
        return not self.over

    def summary(self, minutes: float) -> str:
        """What was learned: the means of the first hundred episodes and of the last."""
        lines = [
            f"{self.num_timesteps} steps, {minutes:.1f} minutes, {time.process_time():.0f} s of CPU time"
        ]
        for name, episodes in (("first", self.first), ("last", self.ended)):
            means = [
                f"{key} {float(np.mean([episode[f'episode/{key}'] for episode in episodes])):.4g}"
                for key in ("return", "success", "steps")
                if episodes
            ]
            lines.append(f"{name} {len(episodes)} episodes: {', '.join(means)}")
        return "\n".join(lines)


def save(model: BaseAlgorithm, folder: Path) -> None:
    """Writes everything that the next step depends on."""
    folder.mkdir(parents=True, exist_ok=True)
    normaliser = model.get_vec_normalize_env()
    model.save(folder / "model")
    normaliser.save(str(folder / "normaliser.pkl"))
    if isinstance(model, SAC):
        model.save_replay_buffer(folder / "replay.pkl")
    state: dict[str, Any] = {
        "environments": normaliser.venv.snapshot(),
        # The normaliser leaves out what belongs to its environments.
        "returns": normaliser.returns,
        "python": random.getstate(),
        "numpy": np.random.get_state(),
        "torch": torch.get_rng_state(),
    }
    (folder / "state.pkl").write_bytes(pickle.dumps(state))


def load(algorithm: type[BaseAlgorithm], envs: VecEnv, folder: Path) -> BaseAlgorithm:
    """Reads what `save` wrote. It is unpickled: load only files of one's own."""
    envs.reset()
    normaliser = VecNormalize.load(str(folder / "normaliser.pkl"), envs)
    model = algorithm.load(
        folder / "model", normaliser, device="cpu", force_reset=False
    )
    if isinstance(model, SAC):
        model.load_replay_buffer(folder / "replay.pkl")
    # Last: making a model seeds all generators.
    state = pickle.loads((folder / "state.pkl").read_bytes())
    envs.restore(state["environments"])
    normaliser.returns = state["returns"]
    random.setstate(state["python"])
    np.random.set_state(state["numpy"])
    torch.set_rng_state(state["torch"])
    return model


def create(
    algorithm: type[BaseAlgorithm],
    envs: VecEnv,
    seed: int,
    logs: Path | None,
    deviation: float = 0.2,
    **settings: Any,
) -> BaseAlgorithm:
    """A new learner. A small deviation of PPO's first actions suits hundreds of muscles, a larger one a few."""
    normalised = VecNormalize(envs, gamma=0.99)
    shared = {
        "seed": seed,
        "device": "cpu",
        "tensorboard_log": None if logs is None else str(logs),
        "gamma": 0.99,
    }
    if algorithm is PPO:
        policy = {"net_arch": [256, 256], "log_std_init": float(np.log(deviation))}
        return PPO(
            "MlpPolicy",
            normalised,
            **{"n_steps": 64, "batch_size": 256, "n_epochs": 4} | settings,
            policy_kwargs=policy,
            **shared,
        )
    policy = {"net_arch": [256, 256]}
    return SAC(
        "MlpPolicy",
        normalised,
        **{"buffer_size": 100_000, "gradient_steps": 4} | settings,
        policy_kwargs=policy,
        **shared,
    )


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("algorithm", choices=("ppo", "sac"))
    parser.add_argument(
        "--task",
        default="stand",
        help="a task of msk.TASKS, a file, or FILE@TASK",
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--num-envs", type=int, default=32)
    parser.add_argument(
        "--deviation", type=float, default=0.2, help="of PPO's first actions"
    )
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument(
        "--resume",
        type=Path,
        default=None,
        help="folder of a checkpoint: runs/TASK-ALGORITHM/latest",
    )
    parser.add_argument("--quiet", action="store_true", help="no progress bar")
    given = parser.parse_args()
    algorithm = {"ppo": PPO, "sac": SAC}[given.algorithm]
    envs = VecEnv(given.task, given.num_envs, clip_actions=True)
    folder = Path("runs") / f"{envs.task.name}-{given.algorithm}"
    if given.resume:
        model = load(algorithm, envs, given.resume)
    else:
        model = create(algorithm, envs, given.seed, folder, given.deviation)
    callback = Progress(folder / "latest", given.minutes)
    begun = time.monotonic()
    model.learn(
        FOREVER,
        callback=callback,
        progress_bar=not given.quiet,
        reset_num_timesteps=not given.resume,
    )
    print(callback.summary((time.monotonic() - begun) / 60))


if __name__ == "__main__":
    main()
