"""The examples of learners go on exactly where they were interrupted."""

import sys

import pytest

from conftest import REPOSITORY

torch = pytest.importorskip("torch", reason="PyTorch is not installed")

sys.path.insert(0, str(REPOSITORY / "examples" / "python"))


def test_a_resumed_run_has_the_bits_of_one_that_was_never_interrupted(tmp_path):
    pytest.importorskip("tensorboard", reason="TensorBoard is not installed")
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    import ppo

    settings = ppo.Settings(num_envs=4, rollout=16, minibatches=2)
    whole = ppo.Trainer(settings)
    logged = [whole.update() for _ in range(4)]
    first = ppo.Trainer(settings)
    [first.update() for _ in range(2)]
    first.save(tmp_path / "checkpoint.pt")
    second = ppo.Trainer.load(tmp_path / "checkpoint.pt")
    assert [second.update() for _ in range(2)] == logged[2:]
    assert second.steps == whole.steps == 256
    assert all(torch.equal(one, other) for one, other in zip(whole.agent.parameters(), second.agent.parameters()))


#: Small enough for a test: (settings, steps until the interruption, steps of the whole run).
SMALL = {
    "PPO": ({"n_steps": 40, "batch_size": 32}, 160, 320),
    "SAC": ({"buffer_size": 2000, "gradient_steps": 1, "learning_starts": 100}, 200, 320),
}


@pytest.mark.parametrize("name", SMALL)
def test_a_resumed_run_of_stable_baselines3_has_the_same_bits(name: str, tmp_path):
    baselines = pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 is not installed")
    import sb3

    algorithm = getattr(baselines, name)
    settings, part, whole = SMALL[name]
    folder = tmp_path / "checkpoint"

    def learn(model, steps: int, **more) -> None:
        model.learn(sb3.FOREVER, callback=sb3.Progress(folder, steps=steps), **more)

    def create():
        envs = sb3.VecEnv("stand", 4, clip_actions=True)
        return sb3.create(algorithm, envs, 3, None, **settings)

    undisturbed = create()
    learn(undisturbed, whole)
    learn(create(), part)
    resumed = sb3.load(algorithm, sb3.VecEnv("stand", 4, clip_actions=True), folder)
    learn(resumed, whole, reset_num_timesteps=False)
    one, other = undisturbed.policy.state_dict(), resumed.policy.state_dict()
    assert all(torch.equal(one[key], other[key]) for key in one)
    normalisers = [model.get_vec_normalize_env() for model in (undisturbed, resumed)]
    assert len({normaliser.obs_rms.mean.tobytes() for normaliser in normalisers}) == 1
    assert len({normaliser.ret_rms.var.tobytes() for normaliser in normalisers}) == 1
