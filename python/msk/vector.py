"""Many episodes of a task as one Gymnasium vector environment, stepped in Rust threads and in the lanes of the processor."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import DTypeLike, NDArray

from . import _native
from .environment import CAMERAS, LARGEST_SEED, Describer, Snapshot, checked_seed, prepared, spaces
from .tasks import Parameters, Task, Weights
from .weights import LiveWeights


class VectorEnv(gymnasium.vector.VectorEnv[NDArray[Any], NDArray[Any], NDArray[Any]]):
    """``num_envs`` episodes of a task: the same numbers as so many :class:`Env`, in one array each.

    * Observations: shape ``(num_envs, task.observation_size)``; actions: ``(num_envs, len(task.actions))``; rewards and flags:
      ``(num_envs,)``.
    * ``reset(seed=s)`` begins episode 0 of the seeds s, s + 1, ...; a list gives each slot its own.
    * ``reset(options={"params": {...}})`` sets parameters as in :class:`Env`: numbers, or arrays of shape ``(num_envs,)``.
    * ``infos`` holds the entries of :class:`Env`'s ``info`` as arrays, each with a mask ``_key``.
    * Autoreset, as ``metadata["autoreset_mode"]`` declares: with ``SAME_STEP`` (default) the observation after an end is the first of
      the next episode, ``infos["final_obs"]`` holds the last ones, an array of shape ``(num_envs, task.observation_size)`` with the
      mask ``_final_obs``, and ``infos["final_info"]`` what the last step reported. With ``NEXT_STEP`` the step after an end begins
      the next episode. With ``DISABLED`` an ended episode stays as it is until ``reset(options={"reset_mask": mask})`` chooses it.

    Other Python threads go on during a step. A forked process starts threads of its own.

    Args:
        task, params, weights, clip_actions, dtype: as for :class:`Env`.
        num_envs: number of slots; multiples of 8 fill the lanes.
        threads: number of threads; by default one per processor that this process may use. Results do not depend on it.
        autoreset_mode: see above.
        render_mode: ``rgb_array`` or none.
        width, height, camera: of pictures, as for :class:`Env`.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": ["rgb_array"],
        "render_fps": 50,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        task: Task | str | os.PathLike[str],
        num_envs: int = 1,
        *,
        params: Parameters | None = None,
        weights: Weights | None = None,
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
        clip_actions: bool = False,
        dtype: DTypeLike = np.float32,
        width: int = 640,
        height: int = 480,
        camera: str = CAMERAS[0],
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"there is no render mode `{render_mode}`; there are: {self.metadata['render_modes']}")
        if num_envs < 1 or (threads is not None and threads < 1):
            raise ValueError(f"expected at least one environment and one thread, found {num_envs} and {threads}")
        self.task = prepared(task, params, weights)
        self.num_envs = num_envs
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.render_mode = render_mode
        fps = round(self.task.control_frequency)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode, "render_fps": fps}
        self.single_observation_space, self.single_action_space = spaces(self.task, dtype)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._native = _native.VectorEnvironment(
            self.task._native,
            num_envs,
            threads,
            self.autoreset_mode.value,
            clip_actions,
            self.single_observation_space.dtype == np.float32,
        )
        self._queue = _native.Queue()
        self._camera = None if render_mode is None else _native.Camera(self.task._native, width, height, camera)
        #: Weights in all episodes, by term; assign to change them.
        self.weights = LiveWeights(self._native, self.task)
        self._describe = Describer(self.task)
        self._params: dict[str, tuple[NDArray[Any], NDArray[np.bool_]]] = {}
        self._begun = False

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """Begins an episode in every slot, or in those that ``options["reset_mask"]`` (bool, shape ``(num_envs,)``) chooses.

        Without a seed the next episode of the seed that the slot had begins.

        Raises:
            ValueError: a wrong number of seeds, a mask that chooses nothing, or a parameter that cannot be.
        """
        if seed is None or isinstance(seed, (int, np.integer)):
            super().reset(seed=None if seed is None else int(seed))
        seeds = self._seeds(seed)
        options = dict(options or {})
        mask = self._mask(options.pop("reset_mask", None))
        params = dict(options.pop("params", {}))
        if options:
            raise ValueError(f"unknown options {sorted(options)}: expected `params`, `reset_mask`")
        if params:
            self._set_parameters(params, mask)
        following = self._native.next_keys()
        keys = [(first, 0) if first is not None else after for first, after in zip(seeds, following, strict=True)]
        chosen = [key if begins else None for key, begins in zip(keys, mask, strict=True)]
        observations = self._native.reset(chosen)[0]
        self._begun = True
        for slot, end in enumerate(self._native.endings()):
            if mask[slot] and end is not None:
                first, index = keys[slot]
                raise RuntimeError(f"episode {index} of seed {first} cannot begin in slot {slot}: {end[1]}")
        return observations, self._identities(mask) | self._parameters()

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Takes one control step in every slot.

        Raises:
            TypeError, ValueError: actions that are not in the action space; nothing has been stepped then.
            gymnasium.error.ResetNeeded: no episode has begun.
        """
        self._require_episodes("step")
        return self._described(self._native.step(actions))

    def send(self, actions: NDArray[Any]) -> None:
        """Begins a control step in every slot, in Rust threads, and returns at once: a program does something else until :meth:`recv`,
        which gives what :meth:`step` gives, to the bit. Meanwhile every other method of this environment is an error.

        :class:`Pipeline` does so with several batches of episodes.

        Raises:
            TypeError, ValueError: actions that are not in the action space; nothing is stepped then.
            gymnasium.error.ResetNeeded: no episode has begun.
            RuntimeError: a step is under way already.
        """
        self._require_episodes("send")
        self._native.send(actions, self._queue)

    def recv(self) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Waits for the step that :meth:`send` has begun; gives what :meth:`step` gives.

        Raises:
            RuntimeError: no step is under way, or it was begun before this process was forked.
        """
        return self._described(self._native.recv())

    def _require_episodes(self, method: str) -> None:
        if not self._begun:
            message = f"no episode has begun: call reset() or restore() before {method}()"
            raise gymnasium.error.ResetNeeded(message)

    def _described(
        self, step: _native._Step
    ) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """What Gymnasium wants of a step."""
        observations, rewards, terminated, truncated, ended = step
        infos = self._reports() | self._identities(np.ones(self.num_envs, np.bool_))
        if ended.any():
            endings = self._endings(ended, truncated)
            if self.autoreset_mode == AutoresetMode.SAME_STEP:
                infos |= {"final_obs": self._native.final_observations(), "_final_obs": ended}
                if self.task.critic:
                    infos |= {
                        "final_critic_obs": self._native.final_critic_observations(),
                        "_final_critic_obs": ended.copy(),
                    }
                infos |= {"final_info": endings, "_final_info": ended.copy()}
            else:
                infos |= {name: value for name, value in endings.items() if name.lstrip("_") in _AT_END}
        return observations, rewards, terminated, truncated, infos

    def render(self) -> tuple[Any, ...] | None:
        """With ``render_mode="rgb_array"`` the present step of each slot as a picture, an array of shape ``(height, width, 3)``: see
        :meth:`Env.render`.

        Raises:
            gymnasium.error.ResetNeeded: no episode has begun.
        """
        if self._camera is None:
            return None
        if not self._begun:
            raise gymnasium.error.ResetNeeded("no episode has begun: call reset() or restore() before render()")
        return tuple(self._camera.render(self._native.snapshot()))

    def _reports(self) -> dict[str, Any]:
        """What the present episodes report of their last step."""
        values, metrics, successes, reported = self._native.report()
        if not reported.any():
            return {}
        infos: dict[str, Any] = {"is_success": successes, "_is_success": reported}
        weights = np.array(self._native.weights())
        names = self._describe.terms
        tables = {"terms": (names, values), "contributions": (names, values * weights)}
        for table, (keys, rows) in tables.items():
            columns = {key: rows[:, index] for index, key in enumerate(keys)}
            infos |= {table: _masked(columns, reported), f"_{table}": reported}
        parts = {
            part.name: metrics[:, part.offset] if part.size == 1 else metrics[:, part.slice]
            for part in self.task.metrics
        }
        return infos | {"metrics": _masked(parts, reported), "_metrics": reported}

    def _endings(self, ended: NDArray[np.bool_], truncated: NDArray[np.bool_]) -> dict[str, Any]:
        """The info of the last step of the episodes that have just ended."""
        infos: dict[str, Any] = {}
        weights = self._native.weights()
        for slot, end, key, success, steps, total, totals, values, metrics in self._native.ends():
            info = self._describe.step(weights, values, metrics, success)
            info |= self._describe.end(end, bool(truncated[slot]), steps, total, totals)
            infos = self._add_info(infos, info | {"seed": key[0], "episode_index": key[1]}, slot)
        return infos

    def _identities(self, mask: NDArray[np.bool_]) -> dict[str, Any]:
        seeds, indices = np.array(self._native.keys(), dtype=np.int64).T.copy()
        return _masked({"seed": np.where(mask, seeds, 0), "episode_index": np.where(mask, indices, 0)}, mask)

    def _set_parameters(self, params: dict[str, Any], mask: NDArray[np.bool_]) -> None:
        """Sets parameters in the slots of the mask: a number for all of them, or an array with one for each slot."""
        shape = (self.num_envs,)
        rows = {name: np.broadcast_to(np.asarray(value, np.float64), shape) for name, value in params.items()}
        self._native.set_parameters([(name, row.tolist()) for name, row in rows.items()], mask.tolist())
        for name, row in rows.items():
            before, known = self._params.get(name, (np.zeros(shape), np.zeros(shape, np.bool_)))
            self._params[name] = (np.where(mask, row, before), known | mask)

    def _parameters(self) -> dict[str, Any]:
        """The parameters that were given, with masks of the slots for which they were."""
        if not self._params:
            return {}
        infos: dict[str, Any] = {}
        for name, (row, known) in self._params.items():
            infos |= {name: row.copy(), f"_{name}": known.copy()}
        return {"params": infos, "_params": np.any([known for _, known in self._params.values()], axis=0)}

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None:
            if self._begun:
                return [None] * self.num_envs
            return [int(first) for first in self.np_random.integers(LARGEST_SEED, size=self.num_envs)]
        if isinstance(seed, (int, np.integer)):
            return [checked_seed(seed + slot) for slot in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise ValueError(f"expected one seed per environment, {self.num_envs}, found {len(seed)}")
        return [None if first is None else checked_seed(first) for first in seed]

    def _mask(self, mask: Any) -> NDArray[np.bool_]:
        if mask is None:
            return np.ones(self.num_envs, np.bool_)
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            raise TypeError(f"`reset_mask` must be a NumPy array of bool, found {type(mask).__name__}")
        if mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(f"`reset_mask` must have the shape ({self.num_envs},) and choose a slot, found {mask}")
        return mask

    @property
    def progress(self) -> float:
        """Share of a training that has passed, 0 to 1, which scheduled weights (``10 -> 5 over 30 %``) follow; 1 unless it is set, as
        tasks are judged. It is that of all slots. A learner assigns it: ``env.unwrapped.progress = steps / budget`` holds from the next step on.

        Raises:
            ValueError: assigned what is no number from 0 to 1.
        """
        return self._native.progress()

    @progress.setter
    def progress(self, progress: float) -> None:
        self._native.set_progress(float(progress))

    @property
    def critic_observations(self) -> NDArray[Any]:
        """What only a critic sees at present: see :attr:`Env.critic_observation`. Shape ``(num_envs, width)``; with ``SAME_STEP``
        ``infos["final_critic_obs"]`` has that of the episodes that ended."""
        return self._native.critic_observations()

    def state(self, slot: int) -> dict[str, Any]:
        """The physical state of the episode in a slot: see :attr:`Env.state`."""
        return self._native.state(slot)

    def snapshot(self) -> Snapshot:
        """All that is needed to go on from here bit for bit."""
        generator = self._np_random
        return Snapshot(self._native.snapshot(), None if generator is None else generator.bit_generator.state)

    def restore(self, snapshot: Snapshot) -> NDArray[Any]:
        """Goes back, or forth, to a snapshot of the same task and number of slots; gives its observations. Weights stay as they are.

        Raises:
            ValueError: a snapshot of another task, body or number of slots.
        """
        self._native.restore(snapshot.episodes)
        if snapshot.generator is not None:
            self.np_random.bit_generator.state = snapshot.generator
        self._begun = True
        return self._native.observations()


#: What only the last step of an episode reports.
_AT_END = ("ending", "reason", "bootstrap", "steps", "return", "term_returns")


def _masked(entries: dict[str, Any], mask: NDArray[np.bool_]) -> dict[str, Any]:
    """The entries, each with its mask."""
    return entries | {f"_{key}": mask.copy() for key in entries}
