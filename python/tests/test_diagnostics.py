"""Compiling: diagnostics as data, as text, as HTML; parameters; weights; tasks by name and file."""

import re
import warnings
from pathlib import Path

import pytest

import msk
from conftest import REPOSITORY, SHORT, short

CROUCH = REPOSITORY / "examples" / "crouch.msk"
WRONG = SHORT.replace("torso.up.z", "torso.z")


def test_a_sound_text_has_no_diagnostics():
    diagnostics = msk.check(SHORT)
    assert len(diagnostics) == 0 and repr(diagnostics) == "no errors, no warnings"
    assert "no errors" in diagnostics._repr_html_()


def test_diagnostics_are_data():
    [diagnostic] = diagnostics = msk.check(WRONG)
    assert (diagnostic.code, diagnostic.severity) == ("E0202", "error")
    assert "has no `z`" in diagnostic.message and "position" in diagnostic.help[0]
    line = WRONG.splitlines()[diagnostic.line - 1]
    assert line[diagnostic.column - 1] == "z"
    assert diagnostics.errors == [diagnostic] and diagnostics.warnings == []


def test_fixes_are_data():
    [diagnostic] = msk.check(SHORT.replace("torso.up.z", "torsoo.up.z"))
    text = SHORT.replace("torso.up.z", "torsoo.up.z").encode()
    [fix, *_] = diagnostic.fixes
    [(place, replacement)] = fix.edits
    assert text[: place.byte] + replacement.encode() + text[place.end_byte :] == SHORT.encode()


def test_diagnostics_are_shown_in_colour_where_there_is_colour():
    diagnostics = msk.check(WRONG)
    assert "\x1b[" in diagnostics.render(coloured=True) and "\x1b[" not in str(diagnostics)
    page = diagnostics._repr_html_()
    assert page.startswith("<pre>") and "\x1b" not in page and page.count("<span") == page.count("</span>") > 0
    assert "&lt;" in msk.check("task <").__class__._repr_html_(msk.check("task <"))


def test_an_error_carries_its_diagnostics():
    with pytest.raises(msk.CompileError) as caught:
        msk.compile_text(WRONG)
    assert caught.value.diagnostics[0].code == "E0202"
    assert "text.msk:14" in str(caught.value) and "^" in str(caught.value)
    assert any("\x1b[" in line for line in caught.value._render_traceback_())


def test_warnings_are_python_warnings():
    text = SHORT.replace("com.velocity.z < 0 m/s", "step > 100")
    with pytest.warns(msk.LintWarning, match="can never hold"):
        msk.compile_text(text)
    [diagnostic] = msk.check(text)
    assert (diagnostic.severity, diagnostic.lint) == ("warning", "decided")


def test_poses_are_probed():
    text = SHORT.replace("com.velocity.z < 0 m/s", "pelvis.height > 0.2 m")
    assert len(msk.check(text)) < len(msk.check(text, probe=True))


@pytest.mark.parametrize("text", ["", "\0", "task", "task { " * 500, "é" * 1000, 'use "../../x.msk"'])
def test_any_text_is_checked(text: str):
    assert all(diagnostic.message for diagnostic in msk.check(text))


def test_files_are_compiled_with_their_imports():
    task = msk.compile(CROUCH)
    assert (task.name, task.horizon, task.control_frequency, task.family) == ("crouch", 300, 100.0, "stabilization")
    assert len(msk.check(CROUCH)) == 0
    env = msk.make(str(CROUCH), weights={"bent": 12})
    assert env.weights["bent"] == 12.0


def test_tasks_that_do_not_exist():
    with pytest.raises(ValueError, match="there is no task `wlak`; .* built in are: .*walk"):
        msk.make("wlak")
    with pytest.raises(msk.CompileError, match="there is no file"):
        msk.make("nowhere.msk")
    with pytest.raises(ValueError, match="2 tasks: balance, other; select one with `task=`"):
        msk.compile_text(SHORT + SHORT.replace("task balance", "task other"))
    with pytest.raises(ValueError, match="no task `third`"):
        msk.compile_text(SHORT, task="third")
    with pytest.raises(ValueError, match="contains no task"):
        msk.compile_text("const x = 1")


def test_parameters_are_set():
    assert [(parameter.name, parameter.unit) for parameter in msk.compile("powerlift").parameters] == [("load", "kg")]
    assert msk.compile("powerlift", params={"load": 30}).parameters[0].value == 30.0
    assert msk.compile("powerlift", params={"load": "25 kg"}).parameters[0].value == 25.0
    with pytest.raises(msk.CompileError, match="lode"):
        msk.compile("powerlift", params={"lode": 1})
    with pytest.raises(msk.CompileError):
        msk.compile("powerlift", params={"load": "1 m"})
    with pytest.raises(ValueError, match="expected a finite number"):
        msk.compile("powerlift", params={"load": float("inf")})
    with pytest.raises(ValueError, match="has its parameters"):
        msk.make(msk.compile("powerlift"), params={"load": 1})


def test_weights_are_laid_over_a_task(tmp_path: Path):
    path = tmp_path / "weights.toml"
    path.write_text("[balance]\nupright = 3.5\n[other]\nx = 1\n")
    assert [term.weight for term in short(weights=path).terms] == [3.5, 3.0]
    assert [term.range for term in short().terms] == [(1.0, 4.0), (3.0, 3.0)]
    with pytest.raises(ValueError, match="upright"):
        short(weights={"upright": 5})
    with pytest.raises(KeyError, match="uprigth"):
        short(weights={"uprigth": 1})
    path.write_text("upright = 1")
    with pytest.raises(ValueError, match="expected a table for each task"):
        short(weights=path)


def test_tasks_are_explained():
    task = short()
    text = task.explain()
    assert "upright" in text and repr(text) == str(text) and text._repr_html_().startswith("<pre>")
    assert (
        "upright" in task.explain("json") and "<html" in task.explain("html") and "longtable" in task.explain("latex")
    )
    with pytest.raises(ValueError, match="there is no format `pdf`"):
        task.explain("pdf")


def test_a_layout_does_not_change_the_hash():
    assert short().hash == short(("    body    human", "body human // the same")).hash


def test_the_names_are_those_of_the_suite():
    suite = (REPOSITORY / "tasks.msk").read_text()
    members = {name for family in re.findall(r"family \w+ *{([^}]*)}", suite) for name in re.findall(r"\w+", family)}
    assert set(msk.TASKS) == members
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name in ("stand", "walk", "pole_walk"):
            assert msk.compile("<built-in>/tasks.msk", task=name).hash == msk.compile(name).hash
