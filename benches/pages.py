"""Sizes of pages: bytes per second of motion, beside those of other ways to keep a rollout.

Usage: pages.py MSK [TASK:POLICY ...]

Compares for each rollout, at 60 frames per second or the control frequency if that is lower:

* the page of `msk run --html`, and what of it are program and description of the model;
* MuJoCo's own way: the model as XML, and a dump of its states (time, qpos, qvel, act as float64; also as float32, compressed by NumPy),
  if the package `msk` and NumPy can be imported: of an episode of the same task and length under random actions;
* a page of `brax.io.html`, if brax can be imported: of its humanoid, as long, because it shows capsules and no muscles.
"""

import base64
import io
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import zlib


def page(program, task, policy, folder):
    """Bytes of a page, of its program, of its model, and seconds of motion."""
    file = folder / f"{task}.html"
    subprocess.run([program, "run", task, "--policy", policy, "--html", file], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    text = file.read_text()
    data = text.rsplit('id="recording">', 1)[1].split("<", 1)[0]
    contents = zlib.decompress(base64.b64decode(data), -15)
    length = int.from_bytes(contents[:4], "little")
    recording = json.loads(contents[4 : 4 + length])["recordings"][0]
    stride = max(1, math.ceil(1 / recording["period"] / 60))
    seconds = max(recording["frames"] - 1, 1) * stride * recording["period"]
    model = len(zlib.compress(contents[: 4 + length], 9)) * 4 // 3
    return len(text), len(text) - len(data), model, seconds, recording["frames"]


def dump(program, task, frames, folder):
    """Bytes of the XML, and per frame of its states, raw and compressed."""
    import msk
    import numpy as np

    export = [program, "export", task, "--target", "python", "--out", folder]
    subprocess.run(export, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    xml = sum(file.stat().st_size for file in folder.glob("*.xml"))
    env = msk.make(task)
    env.reset(seed=0)
    rows, generator = [], np.random.default_rng(0)
    for _ in range(frames):
        state = env.state
        rows.append(np.concatenate([np.ravel(state[name]) for name in ("time", "qpos", "qvel", "act")]))
        if env.step(generator.uniform(-1, -0.5, env.action_space.shape).astype(np.float32))[2]:
            env.reset()
    packed = io.BytesIO()
    np.savez_compressed(packed, states=np.array(rows, np.float32))
    return xml, rows[0].size * 8, packed.tell() / len(rows)


def brax_page(seconds):
    """Bytes of a page of brax, and of the same with one frame."""
    import jax
    from brax import envs
    from brax.io import html

    env = envs.get_environment("humanoid", backend="positional")
    step = jax.jit(env.step)
    state = jax.jit(env.reset)(jax.random.PRNGKey(0))
    states = []
    for _ in range(math.ceil(seconds / env.dt)):
        states.append(state.pipeline_state)
        state = step(state, jax.numpy.zeros(env.action_size))
    return [len(html.render(env.sys.tree_replace({"opt.timestep": env.dt}), part)) for part in (states, states[:1])]


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    rollouts = sys.argv[2:] or ["stand:cmc", "squat:demonstration", "walk:cmc"]
    with tempfile.TemporaryDirectory(prefix="msk-pages-") as name:
        for rollout in rollouts:
            task, policy = rollout.split(":")
            whole, shell, model, seconds, frames = page(program, task, policy, pathlib.Path(name))
            motion = whole - shell - model
            print(f"{task}, {policy}: {seconds:.2f} s: page {whole / 1000:.0f} kB: program {shell / 1000:.0f}, model {model / 1000:.0f}, motion {motion / 1000:.0f}, {motion / seconds / 1000:.1f} kB/s")
            try:
                xml, raw, packed = dump(program, task, frames, pathlib.Path(name) / task)
                rate = frames / seconds
                print(f"  XML {xml / 1000:.0f} kB; states {raw * rate / 1000:.0f} kB/s as float64, {packed * rate / 1000:.1f} kB/s as float32, compressed")
            except ImportError as problem:
                print(f"  no dump of states: {problem}")
            try:
                all_frames, first = brax_page(seconds)
                print(f"  brax, humanoid: page {all_frames / 1000:.0f} kB, {(all_frames - first) / seconds / 1000:.1f} kB/s, and three.js from a network")
            except ImportError as problem:
                print(f"  no page of brax: {problem}")


if __name__ == "__main__":
    main()
