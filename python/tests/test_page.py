"""Episodes as pages."""

import gymnasium
import numpy as np
import pytest

import msk


def test_an_episode_becomes_a_page_that_notebooks_show(tmp_path):
    env = gymnasium.make("msk/Stand-v0", record=True)
    env.reset(seed=3)
    for _ in range(5):
        env.step(np.zeros(env.action_space.shape, env.action_space.dtype))
    page = msk.show(env, "at rest")
    assert "<title>stand, at rest</title>" in page
    assert "characters of HTML" in repr(page)
    shown = page._repr_html_()
    assert shown.startswith("<iframe sandbox=") and shown.count('"') == 6
    page.save(tmp_path / "stand.html")
    assert (tmp_path / "stand.html").read_text(encoding="utf-8") == page
    assert msk.show(env, "at rest") == page
    env.reset(seed=3)
    assert len(msk.show(env, "at rest")) < len(page)


def test_what_keeps_no_steps_says_how_to_keep_them():
    env = msk.Env("stand")
    env.reset(seed=0)
    with pytest.raises(RuntimeError, match="record=True"):
        env.page()
    with pytest.raises(RuntimeError, match="reset"):
        msk.Env("stand", record=True).page()
    with pytest.raises(TypeError, match="environment of msk"):
        msk.show(gymnasium.make("CartPole-v1"))
