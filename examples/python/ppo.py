"""PPO in one file, in the style of CleanRL, on the native vector environment.

    pip install ./python torch tensorboard tqdm
    python examples/python/ppo.py --task stand --minutes 10
    python examples/python/ppo.py --resume runs/stand/checkpoint.pt --minutes 10

TensorBoard (`tensorboard --logdir runs`) shows the return of each term, success, lengths and losses. A checkpoint holds
networks, optimizer, normaliser, random generators and the environments with their episodes, so that a resumed run goes on
with the same numbers as one that was never interrupted.
"""

from __future__ import annotations

import argparse
import pickle
import time
from collections import deque
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msk
import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.tensorboard import SummaryWriter
from tqdm import tqdm


@dataclass(frozen=True)
class Settings:
    """What a run depends on."""

    task: str = "stand"
    seed: int = 0
    num_envs: int = 32
    #: Control steps per environment between two updates.
    rollout: int = 64
    epochs: int = 4
    minibatches: int = 8
    learning_rate: float = 3e-4
    discount: float = 0.99
    #: Of generalised advantage estimation.
    trace: float = 0.95
    clip: float = 0.2
    entropy: float = 0.0
    #: Standard deviation of the first actions.
    first_deviation: float = 0.2
    #: Rewards are multiplied by it.
    reward_scale: float = 0.1
    #: Threads of PyTorch: another number gives other bits.
    torch_threads: int = 1


class Normaliser:
    """Mean and variance of everything seen so far, by Chan's update."""

    def __init__(self, size: int) -> None:
        self.count, self.mean, self.squares = 1e-4, np.zeros(size), np.full(size, 1e-4)

    def update(self, batch: np.ndarray) -> None:
        """Takes a batch of shape (n, size) into account."""
        count, mean = len(batch), batch.mean(axis=0, dtype=np.float64)
        total, change = self.count + count, mean - self.mean
        self.squares += batch.var(axis=0, dtype=np.float64) * count + change**2 * (
            self.count * count / total
        )
        self.mean, self.count = self.mean + change * (count / total), total

    def __call__(self, batch: np.ndarray) -> Tensor:
        """The batch with mean 0 and variance 1, clipped to 10 deviations."""
        normal = (batch - self.mean) / np.sqrt(self.squares / self.count + 1e-8)
        return torch.as_tensor(np.clip(normal, -10, 10), dtype=torch.float32)


class Agent(nn.Module):
    """Two networks of two hidden layers: the mean of a Gaussian policy, and the value."""

    def __init__(self, observation: int, action: int, first_deviation: float) -> None:
        super().__init__()

        def network(out: int, scale: float) -> nn.Sequential:
            layers = [
                nn.Linear(observation, 256),
                nn.Tanh(),
                nn.Linear(256, 256),
                nn.Tanh(),
                nn.Linear(256, out),
            ]
            for layer in layers[::2]:
                nn.init.orthogonal_(layer.weight, 2**0.5)
                nn.init.zeros_(layer.bias)
            with torch.no_grad():
                layers[-1].weight.mul_(scale)
            return nn.Sequential(*layers)

        self.mean, self.value = network(action, 0.01), network(1, 0.7)
        self.log_deviation = nn.Parameter(
            torch.full((action,), float(np.log(first_deviation)))
        )

    def policy(self, observations: Tensor) -> torch.distributions.Normal:
        """The distribution of actions."""
        return torch.distributions.Normal(
            self.mean(observations), self.log_deviation.exp()
        )


class Trainer:
    """A run: everything that a checkpoint keeps."""

    def __init__(self, settings: Settings) -> None:
        torch.set_num_threads(settings.torch_threads)
        torch.manual_seed(settings.seed)
        self.settings = settings
        self.envs = msk.make_vec(settings.task, settings.num_envs, clip_actions=True)
        self.observations, _ = self.envs.reset(seed=settings.seed)
        width = self.observations.shape[1]
        self.normaliser = Normaliser(width)
        self.agent = Agent(width, len(self.envs.task.actions), settings.first_deviation)
        self.optimizer = torch.optim.Adam(
            self.agent.parameters(), settings.learning_rate, eps=1e-5
        )
        self.shuffle = np.random.default_rng(settings.seed)
        self.steps = 0
        #: Episodes of this process: the first that ended, and the last.
        self.first: list[dict[str, float]] = []
        self.last: deque[dict[str, float]] = deque(maxlen=100)

    def update(self) -> dict[str, float]:
        """Collects a rollout and learns from it; gives what is worth logging."""
        rollout, episodes = self.collect()
        losses = self.learn(*rollout)
        self.steps += self.settings.num_envs * self.settings.rollout
        return losses | episodes

    @torch.no_grad()
    def collect(self) -> tuple[tuple[Tensor, ...], dict[str, float]]:
        """Plays: observations, actions, log-probabilities, advantages and returns, flattened, and statistics of ended episodes."""
        kept: list[tuple[Tensor, ...]] = []
        ended: list[dict[str, float]] = []
        for _ in range(self.settings.rollout):
            self.normaliser.update(self.observations)
            seen = self.normaliser(self.observations)
            policy = self.agent.policy(seen)
            action = policy.sample()
            self.observations, rewards, terminated, truncated, infos = self.envs.step(
                action.numpy()
            )
            rewards = rewards * self.settings.reward_scale
            if truncated.any():
                # What would have followed is worth what the critic says of the last observation.
                last = self.agent.value(self.normaliser(infos["final_obs"][truncated]))[
                    :, 0
                ].numpy()
                rewards[truncated] += self.settings.discount * last
            if (terminated | truncated).any():
                own = statistics(infos["final_info"], infos["_final_info"])
                self.first += own[: 100 - len(self.first)]
                self.last.extend(own)
                ended += own
            done = torch.as_tensor(terminated | truncated, dtype=torch.float32)
            value, reward = (
                self.agent.value(seen)[:, 0],
                torch.as_tensor(rewards, dtype=torch.float32),
            )
            kept.append(
                (seen, action, policy.log_prob(action).sum(1), value, reward, done)
            )
        observations, actions, chances, values, rewards, done = (
            torch.stack(part) for part in zip(*kept, strict=True)
        )
        following = self.agent.value(self.normaliser(self.observations))[:, 0]
        advantages = torch.zeros_like(values)
        trace = torch.zeros_like(following)
        for step in reversed(range(self.settings.rollout)):
            goes_on = 1 - done[step]
            error = (
                rewards[step]
                + self.settings.discount * following * goes_on
                - values[step]
            )
            trace = (
                error + self.settings.discount * self.settings.trace * goes_on * trace
            )
            advantages[step], following = trace, values[step]
        parts = (observations, actions, chances, advantages, advantages + values)
        means = (
            {
                key: float(np.mean([episode[key] for episode in ended]))
                for key in ended[0]
            }
            if ended
            else {}
        )
        return tuple(part.flatten(0, 1) for part in parts), means

    def learn(
        self,
        observations: Tensor,
        actions: Tensor,
        chances: Tensor,
        advantages: Tensor,
        returns: Tensor,
    ) -> dict[str, float]:
        """A few epochs of clipped policy gradient."""
        losses: list[tuple[float, ...]] = []
        for _ in range(self.settings.epochs):
            for part in np.array_split(
                self.shuffle.permutation(len(returns)), self.settings.minibatches
            ):
                policy = self.agent.policy(observations[part])
                ratio = (policy.log_prob(actions[part]).sum(1) - chances[part]).exp()
                advantage = (advantages[part] - advantages[part].mean()) / (
                    advantages[part].std() + 1e-8
                )
                clipped = ratio.clamp(1 - self.settings.clip, 1 + self.settings.clip)
                gain = torch.minimum(ratio * advantage, clipped * advantage).mean()
                error = (
                    (self.agent.value(observations[part])[:, 0] - returns[part])
                    .square()
                    .mean()
                )
                entropy = policy.entropy().sum(1).mean()
                self.optimizer.zero_grad()
                (error / 2 - gain - self.settings.entropy * entropy).backward()
                nn.utils.clip_grad_norm_(self.agent.parameters(), 0.5)
                self.optimizer.step()
                losses.append((-gain.item(), error.item(), entropy.item()))
        return dict(
            zip(
                ("loss/policy", "loss/value", "loss/entropy"),
                np.mean(losses, axis=0).tolist(),
                strict=True,
            )
        )

    def summary(self, minutes: float) -> str:
        """What was learned: the means of the first hundred episodes and of the last."""
        lines = [
            f"{self.steps} steps, {minutes:.1f} minutes, {time.process_time():.0f} s of CPU time"
        ]
        for name, episodes in (("first", self.first), ("last", self.last)):
            means = [
                f"{key} {float(np.mean([episode[f'episode/{key}'] for episode in episodes])):.4g}"
                for key in ("return", "success", "steps")
                if episodes
            ]
            lines.append(f"{name} {len(episodes)} episodes: {', '.join(means)}")
        return "\n".join(lines)

    def save(self, path: Path) -> None:
        """Writes a checkpoint, at once or not at all."""
        state = {
            "settings": asdict(self.settings),
            "agent": self.agent.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "normaliser": vars(self.normaliser),
            "shuffle": self.shuffle.bit_generator.state,
            "torch": torch.get_rng_state(),
            "steps": self.steps,
            "environments": pickle.dumps(self.envs.snapshot()),
        }
        torch.save(state, path.with_suffix(".new"))
        path.with_suffix(".new").replace(path)

    @staticmethod
    def load(path: Path) -> Trainer:
        """Goes on from a checkpoint of one's own: it is unpickled."""
        state: dict[str, Any] = torch.load(path, weights_only=False)
        trainer = Trainer(Settings(**state["settings"]))
        trainer.agent.load_state_dict(state["agent"])
        trainer.optimizer.load_state_dict(state["optimizer"])
        vars(trainer.normaliser).update(state["normaliser"])
        trainer.shuffle.bit_generator.state = state["shuffle"]
        trainer.steps = state["steps"]
        trainer.observations = trainer.envs.restore(pickle.loads(state["environments"]))
        torch.set_rng_state(state["torch"])
        return trainer


def statistics(infos: dict[str, Any], ended: np.ndarray) -> list[dict[str, float]]:
    """Return, length, success and the return of each term of the episodes that have just ended."""
    episodes = []
    for slot in np.flatnonzero(ended):
        terms = {
            f"terms/{name}": infos["term_returns"][name][slot]
            for name in infos["term_returns"]
            if name[0] != "_"
        }
        whole = {
            "episode/return": infos["return"][slot],
            "episode/steps": infos["steps"][slot],
            "episode/success": infos["is_success"][slot],
        }
        episodes.append(whole | terms)
    return episodes


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--task",
        default=Settings.task,
        help="a task of msk.TASKS, a file, or FILE@TASK",
    )
    parser.add_argument("--seed", type=int, default=Settings.seed)
    parser.add_argument("--num-envs", type=int, default=Settings.num_envs)
    parser.add_argument(
        "--deviation",
        type=float,
        default=Settings.first_deviation,
        help="standard deviation of the first actions",
    )
    parser.add_argument(
        "--minutes", type=float, default=10.0, help="how long this run takes"
    )
    parser.add_argument(
        "--updates", type=int, default=None, help="stop after so many updates"
    )
    parser.add_argument(
        "--resume", type=Path, default=None, help="go on from this checkpoint"
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=None,
        help="folder of the run; without it, runs/TASK",
    )
    given = parser.parse_args()
    if given.resume:
        trainer = Trainer.load(given.resume)
    else:
        settings = Settings(
            task=given.task,
            seed=given.seed,
            num_envs=given.num_envs,
            first_deviation=given.deviation,
        )
        trainer = Trainer(settings)
    folder = given.out or Path("runs") / trainer.envs.task.name
    folder.mkdir(parents=True, exist_ok=True)
    begun, saved, updates = time.monotonic(), time.monotonic(), 0
    with (
        SummaryWriter(str(folder)) as writer,
        tqdm(total=round(60 * given.minutes), unit="s") as bar,
    ):
        while (
            time.monotonic() < begun + 60 * given.minutes and updates != given.updates
        ):
            logged = trainer.update()
            updates += 1
            for name, value in logged.items():
                writer.add_scalar(name, value, trainer.steps)
            passed = time.monotonic() - begun
            bar.update(round(passed) - bar.n)
            bar.set_postfix(
                steps=trainer.steps,
                per_second=round(
                    updates
                    * trainer.settings.num_envs
                    * trainer.settings.rollout
                    / passed
                ),
                success=logged.get("episode/success"),
                length=logged.get("episode/steps"),
            )
            if time.monotonic() > saved + 60:
                trainer.save(folder / "checkpoint.pt")
                saved = time.monotonic()
    trainer.save(folder / "checkpoint.pt")
    print(trainer.summary((time.monotonic() - begun) / 60))


if __name__ == "__main__":
    main()
