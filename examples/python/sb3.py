"""PPO or SAC of Stable-Baselines3 on the native vector environment.

    pip install "./python[sb3]" tensorboard tqdm rich
    python examples/python/sb3.py ppo --task stand --minutes 10
    python examples/python/sb3.py ppo --task stand --minutes 10 --resume runs/stand-ppo/latest

TensorBoard (`tensorboard --logdir runs`) shows the return of each term, success and lengths. A resumed run has the
networks, the optimizer, the normaliser and the replay buffer of the other, and begins new episodes; `ppo.py` goes on with
the very same numbers.
"""

from __future__ import annotations

import argparse
import time
from collections import deque
from pathlib import Path

import numpy as np
from msk.stable_baselines3 import VecEnv
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecNormalize

#: So large that time ends a run.
FOREVER = 10**12


class Progress(BaseCallback):
    """Logs what ended episodes report, saves once a minute, and stops when the time is over."""

    def __init__(self, folder: Path, minutes: float) -> None:
        super().__init__()
        self.folder = folder
        self.end = time.monotonic() + 60 * minutes
        self.saved = time.monotonic()
        self.ended: deque[dict[str, float]] = deque(maxlen=100)

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if "term_returns" in info:
                terms = {
                    f"terms/{name}": value
                    for name, value in info["term_returns"].items()
                }
                self.ended.append(
                    terms
                    | {
                        "episode/success": info["is_success"],
                        "episode/steps": info["steps"],
                    }
                )
        now = time.monotonic()
        if self.ended and self.n_calls % 64 == 0:
            for key in self.ended[0]:
                self.logger.record(
                    key, float(np.mean([episode[key] for episode in self.ended]))
                )
        if now > self.saved + 60:
            save(self.model, self.folder)
            self.saved = now
        return now < self.end

    def _on_training_end(self) -> None:
        save(self.model, self.folder)


def save(model: BaseAlgorithm, folder: Path) -> None:
    """Writes networks, optimizer, normaliser and, if there is one, the replay buffer."""
    folder.mkdir(parents=True, exist_ok=True)
    model.save(folder / "model")
    model.get_vec_normalize_env().save(str(folder / "normaliser.pkl"))
    if isinstance(model, SAC):
        model.save_replay_buffer(folder / "replay.pkl")


def load(algorithm: type[BaseAlgorithm], envs: VecEnv, folder: Path) -> BaseAlgorithm:
    """Reads what `save` wrote. It is unpickled: load only files of one's own."""
    model = algorithm.load(
        folder / "model",
        VecNormalize.load(str(folder / "normaliser.pkl"), envs),
        device="cpu",
    )
    if isinstance(model, SAC):
        model.load_replay_buffer(folder / "replay.pkl")
    return model


def create(
    algorithm: type[BaseAlgorithm], envs: VecEnv, seed: int, logs: Path
) -> BaseAlgorithm:
    """A new learner, with settings that suit hundreds of muscles: small first actions."""
    normalised = VecNormalize(envs, gamma=0.99)
    shared = {
        "seed": seed,
        "device": "cpu",
        "tensorboard_log": str(logs),
        "gamma": 0.99,
    }
    if algorithm is PPO:
        policy = {"net_arch": [256, 256], "log_std_init": float(np.log(0.2))}
        return PPO(
            "MlpPolicy",
            normalised,
            n_steps=64,
            batch_size=256,
            n_epochs=4,
            policy_kwargs=policy,
            **shared,
        )
    policy = {"net_arch": [256, 256]}
    return SAC(
        "MlpPolicy",
        normalised,
        buffer_size=100_000,
        gradient_steps=4,
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
        "--task", default="stand", help="a task of msk.TASKS, or a file"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--num-envs", type=int, default=32)
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
    folder = Path("runs") / f"{Path(given.task).stem}-{given.algorithm}"
    if given.resume:
        model = load(algorithm, envs, given.resume)
    else:
        model = create(algorithm, envs, given.seed, folder)
    callback = Progress(folder / "latest", given.minutes)
    model.learn(
        FOREVER,
        callback=callback,
        progress_bar=not given.quiet,
        reset_num_timesteps=not given.resume,
    )


if __name__ == "__main__":
    main()
