"""One task as a Gymnasium environment."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, SupportsFloat

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from numpy.typing import DTypeLike, NDArray

from . import _native
from .tasks import Channel, Parameters, Task, Weights, compile
from .weights import LiveWeights

#: Greatest seed: NumPy's integers hold it, too.
LARGEST_SEED = 2**63 - 1

#: Where the camera of pictures stands; it follows the body.
CAMERAS = ("three-quarter", "front", "right", "back", "left", "above")


@dataclass(frozen=True)
class Snapshot:
    """An environment as it was: episodes and random generator. It goes on from here bit for bit."""

    episodes: _native.Snapshot
    generator: Mapping[str, Any] | None


class Env(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """A task as a Gymnasium environment.

    * Observation: array of shape ``(task.observation_size,)`` in SI units, in the order of ``task.channels``.
    * Action: array of shape ``(len(task.actions),)``, float32 or float64, from -1 to 1: how each muscle is excited, from rest to fully,
      unless the task has an ``act`` block.
    * Reward: sum over ``task.terms`` of weight times value.
    * ``terminated``: the task ended the episode, and what would follow has no value (``info["ending"]`` is ``terminated`` for failures,
      ``finished`` for other ends); ``truncated``: the horizon, a fault of the computation, or a finish beside which the task says
      ``bootstrap`` did, and a learner values what would have followed.
    * ``info`` of a step: ``terms`` (unweighted values), ``contributions`` (weight times value), ``metrics``, ``is_success``;
      at the end ``ending``, ``reason`` (names of the conditions, or the fault), ``bootstrap`` (whether truncated), ``steps``, ``return`` and ``term_returns``, too.
      Of every step and reset: ``seed`` and ``episode_index``, which are all that chance depends on.

    ``reset(seed=s)`` begins episode 0 of the seed, each ``reset()`` after it the next one. ``options`` may hold ``episode_index``,
    ``state``: arrays as in :attr:`state`, which replace those of the present state, and ``params``: values of parameters that the task
    declares ``per episode``, in the units in which they are written. They hold until others are given, and ``info["params"]`` of a
    reset has all that were.

    An environment starts no thread, and may be forked, or made in a spawned process.

    Args:
        task: a compiled task, the name of one of ``msk.TASKS``, or the path of a file.
        params: values of the task's parameters.
        weights: weights of its terms, or a weights file.
        render_mode: ``ansi``, ``rgb_array`` or none.
        width, height, camera: of pictures: pixels, and where the camera stands, one of :data:`CAMERAS`.
        clip_actions: whether actions outside of [-1, 1] are clipped; else they are errors.
        dtype: of observations, ``float32`` or ``float64``.
        record: whether the steps of the present episode are kept, for :meth:`page`.
    """

    metadata: dict[str, Any] = {"render_modes": ["ansi", "rgb_array"], "render_fps": 50}  # noqa: RUF012 (as Gymnasium declares it)

    def __init__(
        self,
        task: Task | str | os.PathLike[str],
        *,
        params: Parameters | None = None,
        weights: Weights | None = None,
        render_mode: str | None = None,
        clip_actions: bool = False,
        dtype: DTypeLike = np.float32,
        record: bool = False,
        width: int = 640,
        height: int = 480,
        camera: str = CAMERAS[0],
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"there is no render mode `{render_mode}`; there are: {self.metadata['render_modes']}")
        self.task = prepared(task, params, weights)
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": round(self.task.control_frequency)}
        self.observation_space, self.action_space = spaces(self.task, dtype)
        single = self.observation_space.dtype == np.float32
        self._native = _native.Environment(self.task._native, clip_actions, single, record)
        self._camera = None if render_mode != "rgb_array" else _native.Camera(self.task._native, width, height, camera)
        #: Weights, by term; assign to change them.
        self.weights = LiveWeights(self._native, self.task)
        self._describe = Describer(self.task)
        self._params: dict[str, float] = {}
        self._begun = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """Begins an episode: see the class.

        Raises:
            ValueError: a seed, episode, state or parameter that cannot be.
            RuntimeError: the physics cannot start from the initial state.
        """
        super().reset(seed=seed)
        options = dict(options or {})
        state = options.pop("state", None)
        params = {name: float(value) for name, value in dict(options.pop("params", {})).items()}
        if seed is not None:
            key = (checked_seed(seed), 0)
        elif not self._begun:
            key = (int(self.np_random.integers(LARGEST_SEED)), 0)
        else:
            key = (self._native.key()[0], self._native.key()[1] + 1)
        key = (key[0], options.pop("episode_index", key[1]))
        if options:
            raise ValueError(f"unknown options {sorted(options)}: expected `episode_index`, `params`, `state`")
        if params:
            self._native.set_parameters(list(params.items()))
            self._params |= params
        self._begun = True
        if state is None:
            observation = self._native.reset(*key)
        else:
            observation = self._native.reset_to(*key, dict(state))
        return observation, identity(key) | ({"params": dict(self._params)} if self._params else {})

    def step(self, action: NDArray[Any]) -> tuple[NDArray[Any], SupportsFloat, bool, bool, dict[str, Any]]:
        """Takes one control step of ``1 / task.control_frequency`` seconds.

        Raises:
            TypeError, ValueError: an action that is not in the action space.
            gymnasium.error.ResetNeeded: the episode has ended, or none has begun.
        """
        if not self._begun or self._native.end() is not None:
            raise ResetNeeded("the episode has ended, or none has begun: call reset() or restore() before step()")
        observation, reward, terminated, truncated = self._native.step(action)
        info = self._describe.step(self._native.weights(), *self._native.report())
        if terminated or truncated:
            total, totals = self._native.returns()
            info |= self._describe.end(self._native.end(), truncated, self._native.steps(), total, totals)
        return observation, reward, terminated, truncated, info | identity(self._native.key())

    def render(self) -> Any:
        """With ``render_mode="rgb_array"`` the present step as a picture, an array of shape ``(height, width, 3)`` and type uint8: the body
        with its muscles by activation, scene, contact forces and reference motion. It needs no display. With ``ansi`` the step as text: time,
        reward, and a line per term.

        Raises:
            gymnasium.error.ResetNeeded: a picture before an episode has begun.
        """
        if self._camera is not None:
            if not self._begun:
                raise ResetNeeded("no episode has begun: call reset() or restore() before render()")
            return self._camera.render(self._native.snapshot())[0]
        if self.render_mode is None:
            return None
        return self._describe.text(
            self._native.steps(), self._native.weights(), self._native.report()[0], self._native.returns()
        )

    def draw(self, caption: str = "") -> Picture:
        """The present state as a picture, from the side and from in front: SVG, which notebooks show."""
        return Picture(self._native.draw(caption))

    def page(self, title: str = "") -> Page:
        """The present episode so far as a page: the moving body with its muscles, forces, reward terms and signals. Notebooks show it,
        browsers open it; it works without a network.

        Raises:
            RuntimeError: the environment was made without ``record=True``, or no episode has begun.
        """
        return Page(self._native.page(title))

    @property
    def progress(self) -> float:
        """Share of a training that has passed, 0 to 1, which scheduled weights (``10 -> 5 over 30 %``) follow; 1 unless it is set, as
        tasks are judged. A learner assigns it: ``env.unwrapped.progress = steps / budget`` holds from the next step on.

        Raises:
            ValueError: assigned what is no number from 0 to 1.
        """
        return self._native.progress()

    @progress.setter
    def progress(self, progress: float) -> None:
        self._native.set_progress(float(progress))

    @property
    def critic_observation(self) -> NDArray[Any]:
        """What only a critic sees at present, beside the observation: an array in SI units, in the order of ``task.critic``; empty
        without a block ``critic`` in the task. A policy must not use it."""
        return self._native.critic_observation()

    @property
    def state(self) -> dict[str, Any]:
        """The physical state as named arrays, copied, with MuJoCo's names, shapes and units: ``time`` (s), ``qpos``, ``qvel``, ``act``,
        ``ctrl`` (excitations), ``eq_active``, ``strength``, ``mass_scale``, ``friction``, and others. ``reset(options={"state": {...}})`` begins an episode with some of them."""
        return self._native.state()

    def snapshot(self) -> Snapshot:
        """All that is needed to go on from here bit for bit."""
        generator = self._np_random
        return Snapshot(self._native.snapshot(), None if generator is None else generator.bit_generator.state)

    def restore(self, snapshot: Snapshot) -> NDArray[Any]:
        """Goes back, or forth, to a snapshot of the same task; gives its observation. Weights stay as they are.

        Raises:
            ValueError: a snapshot of another task or body.
        """
        self._native.restore(snapshot.episodes)
        if snapshot.generator is not None:
            self.np_random.bit_generator.state = snapshot.generator
        self._begun = True
        return self._native.observation()


class Page(str):
    """An episode as HTML text, which notebooks show."""

    def __repr__(self) -> str:
        return f"<Page: {len(self)} characters of HTML>"

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page to a file, for a browser."""
        Path(path).write_text(self, encoding="utf-8")

    def _repr_html_(self) -> str:
        # A frame of its own: neither styles nor programs of page and notebook meet.
        frame = 'sandbox="allow-scripts allow-downloads" style="width:100%;height:640px;border:0"'
        return f'<iframe {frame} srcdoc="{html.escape(self)}"></iframe>'


def show(env: gymnasium.Env[Any, Any], title: str = "") -> Page:
    """The present episode of an environment, whatever wraps it, as a page: the last line of a notebook's cell shows it.

    Raises:
        TypeError: an environment of another package.
        RuntimeError: see :meth:`Env.page`.
    """
    inner = env.unwrapped
    if not isinstance(inner, Env):
        raise TypeError(f"expected an environment of msk, found {type(inner).__name__}")
    return inner.page(title)


class Picture(str):
    """A picture as SVG text, which notebooks show."""

    def __repr__(self) -> str:
        return f"<Picture: {len(self)} characters of SVG>"

    def _repr_svg_(self) -> str:
        return str(self)


class Describer:
    """What native numbers mean, as the dictionaries of Gymnasium's info."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.terms = [term.name for term in task.terms]

    def step(self, weights: list[float], values: list[float], metrics: list[float], success: bool) -> dict[str, Any]:
        """Of a step. After a fault there are no numbers: the dictionaries are empty."""
        pairs = zip(weights, values, strict=False)
        return {
            "terms": dict(zip(self.terms, values, strict=False)),
            "contributions": dict(zip(self.terms, (weight * value for weight, value in pairs), strict=False)),
            "metrics": self.metrics(metrics),
            "is_success": success,
        }

    def metrics(self, values: list[float]) -> dict[str, Any]:
        """Metrics by name: a number, or an array if it has several."""
        return {part.name: _part(values, part) for part in self.task.metrics} if values else {}

    def end(
        self, end: tuple[str, str] | None, bootstrap: bool, steps: int, total: float, totals: list[float]
    ) -> dict[str, Any]:
        """Of the last step of an episode."""
        ending, reason = end or ("", "")
        return {
            "ending": ending,
            "reason": reason,
            "bootstrap": bootstrap,
            "steps": steps,
            "return": total,
            "term_returns": dict(zip(self.terms, totals, strict=True)),
        }

    def text(self, steps: int, weights: list[float], values: list[float], returns: tuple[float, list[float]]) -> str:
        """A step as text."""
        time = steps / self.task.control_frequency
        lines = [f"{self.task.name}: step {steps} of {self.task.horizon}, {time:.2f} s, return {returns[0]:.4g}"]
        width = max((len(name) for name in self.terms), default=0)
        if values:
            for name, weight, value in zip(self.terms, weights, values, strict=True):
                lines.append(f"  {name:{width}}  {weight:8.4g} * {value:10.4g} = {weight * value:10.4g}")
        return "\n".join(lines)


def _part(values: list[float], part: Channel) -> Any:
    return values[part.offset] if part.size == 1 else np.array(values[part.slice])


def prepared(task: Task | str | os.PathLike[str], params: Parameters | None, weights: Weights | None) -> Task:
    """A compiled task, whichever way it was named."""
    if not isinstance(task, Task):
        return compile(task, params=params, weights=weights)
    if params is not None:
        raise ValueError("a compiled task has its parameters: give them to `msk.compile`")
    return task if weights is None else task.reweighted(weights)


def spaces(task: Task, dtype: DTypeLike) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Observation space and action space of one episode."""
    if np.dtype(dtype) not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise ValueError(f"observations are float32 or float64, not {np.dtype(dtype)}")
    kind: Any = np.dtype(dtype).type
    observation = gymnasium.spaces.Box(-np.inf, np.inf, (task.observation_size,), kind)
    return observation, gymnasium.spaces.Box(-1.0, 1.0, (len(task.actions),), np.float32)


def checked_batches(num_envs: int, batch_size: int) -> int:
    """How many batches the slots make."""
    if batch_size < 1 or num_envs < batch_size or num_envs % batch_size:
        raise ValueError(
            f"expected a batch size that divides the number of environments, found {batch_size} and {num_envs}"
        )
    return num_envs // batch_size


def checked_seed(seed: Any) -> int:
    """A seed that Rust and NumPy hold."""
    if not 0 <= int(seed) <= LARGEST_SEED:
        raise ValueError(f"a seed is between 0 and 2**63 - 1, found {seed}")
    return int(seed)


def identity(key: tuple[int, int]) -> dict[str, Any]:
    """Which episode of which seed, as info."""
    return {"seed": key[0], "episode_index": key[1]}
