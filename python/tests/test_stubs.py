"""The stubs of the native part list what it has, and nothing else."""

import ast
from pathlib import Path

import msk
from msk import _native


def names(of: object) -> set[str]:
    return {name for name in vars(of) if not name.startswith("_")}


def test_the_stubs_agree_with_the_native_part():
    tree = ast.parse((Path(msk.__file__).parent / "_native.pyi").read_text())
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    assert functions | set(classes) | {"provoke_panic"} == names(_native) | {"provoke_panic"}
    for name, node in classes.items():
        stubbed = {
            part.name for part in node.body if isinstance(part, ast.FunctionDef) and not part.name.startswith("_")
        }
        assert stubbed == names(getattr(_native, name)), name


def test_everything_public_is_documented():
    for name in msk.__all__:
        part = getattr(msk, name)
        assert name == "TASKS" or part.__doc__, name
    assert (Path(msk.__file__).parent / "py.typed").exists()
