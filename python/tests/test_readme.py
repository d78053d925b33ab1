"""The Python of both READMEs, and the notebook, run as they stand."""

import json
import re

import pytest

from conftest import REPOSITORY


@pytest.mark.parametrize("path", ["README.md", "python/README.md"])
def test_the_blocks_of_a_readme_run(path: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(REPOSITORY)
    run(re.findall(r"^```python\n(.*?)^```", (REPOSITORY / path).read_text(), re.DOTALL | re.MULTILINE), path)


def test_the_notebook_runs():
    path = REPOSITORY / "examples" / "python" / "tour.ipynb"
    cells = json.loads(path.read_text())["cells"]
    run(["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"], path.name)


def run(blocks: list[str], name: str) -> None:
    """Runs blocks one after the other, with the names of those before."""
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, name, "exec"), names)  # noqa: S102
