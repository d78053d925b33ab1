"""The Python of both READMEs runs as it stands."""

import re

import pytest
from conftest import REPOSITORY


@pytest.mark.parametrize("path", ["README.md", "python/README.md"])
def test_the_blocks_run(path: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(REPOSITORY)
    blocks = re.findall(r"^```python\n(.*?)^```", (REPOSITORY / path).read_text(), re.DOTALL | re.MULTILINE)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, path, "exec"), names)
