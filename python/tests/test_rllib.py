"""RLlib steps the native vector environment."""

import numpy as np
import pytest

import msk

pytest.importorskip("torch", reason="PyTorch is not installed")
pytest.importorskip("tree", reason="RLlib is not installed")


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_an_env_runner_plays_what_an_environment_plays():
    ppo = pytest.importorskip("ray.rllib.algorithms.ppo", reason="RLlib is not installed")
    from ray.rllib.env.single_agent_env_runner import SingleAgentEnvRunner

    config = (
        ppo.PPOConfig()
        .environment("msk:msk/Stand-v0", env_config={"autoreset_mode": "NextStep", "clip_actions": True})
        .env_runners(num_env_runners=0, num_envs_per_env_runner=2, gym_env_vectorize_mode="vector_entry_point")
    )
    runner = SingleAgentEnvRunner(config=config)
    assert isinstance(runner.env.unwrapped, msk.VectorEnv)
    ended = [episode for episode in runner.sample(num_timesteps=300, random_actions=True) if episode.is_done]
    assert ended
    env = msk.make("stand", clip_actions=True)
    for episode in ended[:3]:
        last = episode.get_infos(-1)
        observation, _ = env.reset(seed=int(last["seed"]), options={"episode_index": int(last["episode_index"])})
        observations, rewards = [observation], []
        for action in episode.get_actions():
            observation, reward, terminated, *_ = env.step(action)
            observations.append(observation)
            rewards.append(reward)
        assert terminated == episode.is_terminated
        assert np.array_equal(episode.get_observations(), observations)
        assert np.array_equal(episode.get_rewards(), rewards)
