"""Pictures of episodes: Gymnasium's ``rgb_array``."""

import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded

import msk


def rest(env: gymnasium.Env, count: int = 1):
    for _ in range(count):
        env.step(np.full(env.action_space.shape, -1, env.action_space.dtype))


def test_an_environment_gives_pictures():
    env = gymnasium.make("msk/Walk-v0", render_mode="rgb_array")
    assert env.metadata["render_fps"] == round(env.unwrapped.task.control_frequency)
    env.reset(seed=3)
    first = env.render()
    assert first.shape == (480, 640, 3) and first.dtype == np.uint8
    assert np.array_equal(first, env.render())
    rest(env, 20)
    later = env.render()
    assert not np.array_equal(first, later)
    env.reset(seed=3)
    assert np.array_equal(first, env.render())
    # The body stands before a light ground.
    assert 150 < first.mean() < 235 and first.min() < 90


def test_size_and_camera_are_chosen():
    pictures = []
    for camera in msk.CAMERAS:
        env = msk.make("stand", render_mode="rgb_array", width=80, height=60, camera=camera)
        env.reset(seed=0)
        pictures.append(env.render())
        assert pictures[-1].shape == (60, 80, 3)
    assert len({picture.tobytes() for picture in pictures}) == len(msk.CAMERAS)
    with pytest.raises(ValueError, match="there is no camera `below`; there are: three-quarter, front"):
        msk.make("stand", render_mode="rgb_array", camera="below")
    with pytest.raises(ValueError, match="1 to 8192 pixels in width and height, found 0 x 480"):
        msk.make("stand", render_mode="rgb_array", width=0)
    with pytest.raises(ResetNeeded):
        msk.make("stand", render_mode="rgb_array").render()


def test_a_picture_changes_nothing():
    totals = []
    for mode in (None, "rgb_array"):
        env = msk.make("stand", render_mode=mode, width=32, height=32)
        env.reset(seed=5)
        total = 0.0
        for _ in range(10):
            total += env.step(np.zeros(416, np.float32))[1]
            env.render()
        totals.append((total, pickle.dumps(env.snapshot().episodes)))
    assert totals[0] == totals[1]


def test_a_vector_environment_gives_a_picture_for_each_slot():
    settings = {"render_mode": "rgb_array", "width": 64, "height": 48}
    envs = gymnasium.make_vec("msk/Stand-v0", num_envs=3, **settings)
    assert envs.render_mode == "rgb_array" and envs.metadata["render_modes"] == ["rgb_array"]
    with pytest.raises(ResetNeeded):
        envs.render()
    envs.reset(seed=7)
    envs.step(np.zeros((3, 416), np.float32))
    pictures = envs.render()
    assert isinstance(pictures, tuple) and len(pictures) == 3
    for slot, picture in enumerate(pictures):
        env = msk.make("stand", **settings)
        env.reset(seed=7 + slot)
        env.step(np.zeros(416, np.float32))
        assert np.array_equal(picture, env.render())
    assert msk.make_vec("stand", 2).render() is None


def test_the_contract_of_gymnasium_holds():
    from gymnasium.utils.env_checker import check_env

    check_env(msk.make("stand", render_mode="rgb_array", width=32, height=32), skip_render_check=True)
    env = gymnasium.wrappers.RenderCollection(msk.make("stand", render_mode="rgb_array", width=32, height=32))
    env.reset(seed=0)
    rest(env, 2)
    assert len(env.render()) == 3


def test_videos_are_recorded(tmp_path):
    pytest.importorskip("moviepy")
    env = msk.make("stand", render_mode="rgb_array", width=64, height=48)
    env = gymnasium.wrappers.RecordVideo(env, str(tmp_path), episode_trigger=lambda _: True, video_length=5)
    env.reset(seed=0)
    rest(env, 6)
    env.close()
    assert list(tmp_path.glob("*.mp4"))
