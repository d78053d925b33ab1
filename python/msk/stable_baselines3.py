"""Vector environments for Stable-Baselines3: all episodes are stepped together in Rust, in this process.

>>> from stable_baselines3 import PPO
>>> from msk.stable_baselines3 import VecEnv
>>> PPO("MlpPolicy", VecEnv("walk", 16)).learn(100_000)
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv as _VecEnv

from .environment import Snapshot
from .tasks import Task
from .vector import VectorEnv


class VecEnv(_VecEnv):
    """``num_envs`` episodes of a task as Stable-Baselines3 steps them.

    At the end of an episode the ``info`` of its slot holds ``terminal_observation``, ``TimeLimit.truncated``, ``is_success``, ``episode``
    (return ``r``, length ``l``: what a ``Monitor`` would add), and everything that the last step of an :class:`msk.Env` reports.
    Of other steps it holds ``TimeLimit.truncated`` alone.

    ``settings`` are those of :class:`msk.VectorEnv`, apart from the autoreset mode.
    """

    def __init__(self, task: Task | str | os.PathLike[str], num_envs: int, **settings: Any) -> None:
        self.envs = VectorEnv(task, num_envs, autoreset_mode="SameStep", **settings)
        self._actions: NDArray[Any] | None = None
        super().__init__(num_envs, self.envs.single_observation_space, self.envs.single_action_space)

    @property
    def task(self) -> Task:
        """The compiled task."""
        return self.envs.task

    def reset(self) -> NDArray[Any]:
        """Begins an episode in every slot, with the seeds that :meth:`seed` has chosen."""
        observations, infos = self.envs.reset(seed=self._seeds)
        self._reset_seeds()
        self._reset_options()
        self._note_resets(range(self.num_envs), infos)
        return observations

    def step_async(self, actions: NDArray[Any]) -> None:
        """Keeps the actions for :meth:`step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], list[dict[str, Any]]]:
        """Takes one control step in every slot."""
        if self._actions is None:
            raise RuntimeError("step_wait() without step_async()")
        observations, rewards, terminated, truncated, infos = self.envs.step(self._actions)
        self._actions = None
        dones = terminated | truncated
        by_slot: list[dict[str, Any]] = [{"TimeLimit.truncated": False} for _ in range(self.num_envs)]
        ended = np.flatnonzero(dones)
        for slot in ended:
            info = _of_slot(infos["final_info"], int(slot))
            info["TimeLimit.truncated"] = bool(truncated[slot])
            info["terminal_observation"] = infos["final_obs"][slot]
            info["episode"] = {"r": info["return"], "l": info["steps"], "t": 0.0}
            by_slot[slot] = info
        self._note_resets(ended, infos)
        return observations, rewards.astype(np.float32), dones, by_slot

    def snapshot(self) -> Snapshot:
        """All that is needed to go on from here bit for bit: see :meth:`msk.VectorEnv.snapshot`."""
        return self.envs.snapshot()

    def restore(self, snapshot: Snapshot) -> NDArray[Any]:
        """Goes on from a snapshot; gives its observations."""
        return self.envs.restore(snapshot)

    def close(self) -> None:
        """Closes the environments."""
        self.envs.close()

    def get_attr(self, attr_name: str, indices: None | int | Iterable[int] = None) -> list[Any]:
        """An attribute of :class:`msk.VectorEnv`, once per slot."""
        return [getattr(self.envs, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: None | int | Iterable[int] = None) -> None:
        """Is not possible: slots have no attributes of their own."""
        raise AttributeError(f"`{attr_name}` cannot be set slot by slot; change `envs` (as `envs.weights[...] = ...`)")

    def env_method(
        self, method_name: str, *method_args: Any, indices: None | int | Iterable[int] = None, **method_kwargs: Any
    ) -> list[Any]:
        """Is not possible: slots have no methods of their own."""
        raise AttributeError(f"`{method_name}` cannot be called slot by slot; call it on `envs`")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: None | int | Iterable[int] = None) -> list[bool]:
        """Whether ends carry what a ``Monitor`` adds: they do. Nothing else is wrapped."""
        return [wrapper_class.__name__ == "Monitor" for _ in self._get_indices(indices)]

    def _note_resets(self, slots: Iterable[int], infos: dict[str, Any]) -> None:
        for slot in slots:
            self.reset_infos[slot] = {key: int(infos[key][slot]) for key in ("seed", "episode_index")}


def _of_slot(infos: dict[str, Any], slot: int) -> dict[str, Any]:
    """The info of one slot out of those of a vector environment."""
    info: dict[str, Any] = {}
    for key, value in infos.items():
        if not key.startswith("_") and infos[f"_{key}"][slot]:
            if isinstance(value, dict):
                info[key] = _of_slot(value, slot)
            else:
                info[key] = value[slot].item() if isinstance(value[slot], np.generic) else value[slot]
    return info
