"""Tasks as modules over MuJoCo: both back ends of the compiler give the same observation, terms and ends in the same states."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import msk

mujoco = pytest.importorskip(
    "mujoco", minversion="4.0", reason="MuJoCo 4 is not installed; older ones wrap tendons otherwise"
)

pytestmark = pytest.mark.filterwarnings("ignore::msk.LintWarning")

CONTACT_FORCES = {"contact", "slide"}
"""What depends on them in the task of every operation."""

STEPS = 25
"""Control steps of an episode."""


def loaded(path: Path) -> ModuleType:
    """An exported module."""
    sys.path.insert(0, str(path.parent))
    try:
        spec = importlib.util.spec_from_file_location(path.stem, path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.pop(0)
    return module


def task_of(module: ModuleType):
    """The task that it defines."""
    [found] = [kind for kind in vars(module).values() if isinstance(kind, type) and kind.__module__ == module.__name__]
    return found()


def put(env: msk.Env, model, data) -> None:
    """Gives MuJoCo the state of an environment, and its forces to convergence."""
    state = env.state
    for name in ("qpos", "qvel", "act", "ctrl", "eq_active"):
        if name in state:
            getattr(data, name)[:] = state[name]
    data.time = state["time"]
    mujoco.mj_forward(model, data)


def compare(env: msk.Env, observation, info, reward, step) -> None:
    def close(name: str) -> dict[str, float]:
        # Forces of contacts are solved for, by either solver up to its own tolerance.
        return dict.fromkeys(("rtol", "atol"), 1e-6 if name in CONTACT_FORCES else 1e-9)

    np.testing.assert_allclose(step.observation, observation, err_msg="observation", **close("observation"))
    if reward is None:
        return
    for name, value in info["terms"].items():
        np.testing.assert_allclose(step.terms[name], value, err_msg=name, **close(name))
    exact = not CONTACT_FORCES & set(info["terms"])
    np.testing.assert_allclose(step.reward, reward, err_msg="reward", **close("reward" if exact else "contact"))
    for name, value in info["metrics"].items():
        np.testing.assert_allclose(step.metrics[name], value, err_msg=name, **close(name))
    assert step.success == info["is_success"]


def play(task: msk.Task, folder: Path, seed: int, scale: float) -> int:
    module = loaded(task.export(folder))
    exported = task_of(module)
    exported.model.opt.tolerance, exported.model.opt.iterations = 0.0, 200
    env, data = msk.make(task, dtype=np.float64), mujoco.MjData(exported.model)
    observation, _ = env.reset(seed=seed)
    put(env, exported.model, data)
    compare(env, observation, None, None, exported.reset(data, seed=seed))
    draws = np.random.default_rng(seed)
    for number in range(STEPS):
        action = draws.uniform(-1, -1 + 2 * scale, len(task.actions))
        observation, reward, terminated, truncated, info = env.step(action)
        put(env, exported.model, data)
        step = exported.step(data, action)
        compare(env, observation, info, reward, step)
        assert bool(step.terminations or step.finishes) == (info.get("ending") in ("terminated", "finished"))
        if terminated or truncated:
            return number + 1
    return STEPS


EVERYTHING = """
task everything {
    body    human
    control 100 Hz
    horizon 40 steps

    params { near: length = 60 cm (2 cm .. 90 cm) }

    init {
        pose neutral
        root { height on ground, velocity [0.4 m/s, 0, 0.3 m/s] }
        noise joints normal(0, 0.01 rad)
    }

    random goal = uniform(0.2 m .. 0.5 m, -0.5 m .. 0.1 m, 0.9 m .. 1.4 m) where norm(goal - [0, 0, 1.2 m]) > 0.3 m redraw when met
    random side = choice(-1, 1)
    random gust = normal([0, 0], 2) redraw when mod(step, 5) == 3
    let way = goal - palm_r.position
    let met = norm(way) < near and mod(step, 4) == 0
    let tilt = angle_difference(pelvis.yaw, torso.yaw) + side * 0.1 rad
    state touches: int = 0 becomes touches + 1 when rising(met)
    clock phase at 1.3 Hz
    let rises = pelvis.velocity.z > 0.1 m/s

    observe {
        way in heading(pelvis)
        torso.orientation
        joints.q delay 3 steps
        hinges.qd history 2
        height = pelvis.height noise normal(0, 1 cm) scale 2 m clip -1 .. 1
        touches
        gust
        sin(phase)
        action
        phase
    }

    critic { soleus_{l,r}.force; com.acceleration }

    reward {
        1 close     = tolerance(norm(way), 0 m, 10 cm, 50 cm)
        2 smoothed  = smooth(torso.pitch, 50 ms) / 1 rad + smooth(tilt, 30 ms) / 1 rad
        3 held      = held(rises, 2 steps) and not terminated
        4 once      = once(met)
        5 counted   = count(rises) / 10 + (0.5 when falling(rises))
        6 extremes  = (running_max(pelvis.height) - running_min(pelvis.height)) / 1 m
        7 kept      = sample_hold(com.velocity.x, met) / 1 m/s
        8 since     = exp(-since(met) / 1 s) + timer(rises) / 1 s
        9 delayed   = delay(com.height, 4 steps) / 1 m
        1 hysteretic = hysteresis(pelvis.velocity.z, -5 cm/s, 5 cm/s)
        1 integral  = integral(angular_momentum.y) / 1 kg*m^2
        1 best      = argmax([sole_l.height, sole_r.height]) + std(legs.q) / 1 rad + mod(step, 3)
        1 chosen    = if rises then sign(tilt) else floor(touches / 2)
        1 muscles   = mean(muscles.activation^2) + sum(abs(calves.velocity)) / 1 m/s
        1 contact   = (2 when touching(robot, ground)) + norm(contact_force(sole_l, ground)) / body_weight
        1 low       = min(feet.clearance) / 1 m
    }

    metrics { spin = pelvis.angular_velocity; slide = slip(sole_r, ground); wrapped = mean([torso.yaw, pelvis.yaw]) }

    terminate { fallen when pelvis.height < 0.3 m }
    finish { far when com.position.x > 3 m }
    success ever(met) and survived
}
"""
"""Every kind of operation."""


def test_every_operation_is_the_same_over_mujoco(tmp_path: Path):
    task = msk.compile_text(EVERYTHING)
    assert [play(task, tmp_path, seed, 0.5) for seed in (1, 2)] == [STEPS, STEPS]


def test_what_mujoco_does_not_measure_is_refused(tmp_path: Path):
    task = msk.compile_text(EVERYTHING.replace("min(feet.clearance) / 1 m", "support_margin / 1 m"))
    with pytest.raises(ValueError, match="`support_margin`: MuJoCo's data do not have it"):
        task.export(tmp_path)


@pytest.mark.parametrize("name", msk.TASKS)
def test_every_task_is_the_same_over_mujoco(name: str, tmp_path: Path):
    steps = [play(msk.compile(name), tmp_path, seed, scale) for seed, scale in ((0, 0.2), (3, 1.0))]
    assert min(steps) > 3, steps
