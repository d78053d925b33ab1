"""Pages of episodes in a real browser: what they show, how they are used, and that they agree with the simulator.

Usage: checks.py MSK [--update]: `MSK` is the program; `--update` writes the reference pictures anew.
"""

import base64
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time
import zlib

import picture
from driver import Browser, Failure

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
WINDOW = (1280, 800)
# Task, policy, seed, and the time and view of the reference picture.
PAGES = {
    "stand": ("stand", "cmc", "t=0.5&view=three-quarter&only"),
    "squat": ("squat", "demonstration", "t=1&view=right&theme=dark&only"),
    "walk": ("walk", "cmc", "t=0.6&view=front&only"),
}
# Draws four pictures of different moments, and waits for the last pixel: pictures per second.
DRAW = """(() => {
    const { gl } = viewer.renderer;
    const start = performance.now();
    for (let picture = 0; picture < 4; picture++) {
        viewer.player.time = 0.05 * picture;
        viewer.drawNow();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    return 4000 / (performance.now() - start);
})()"""
# Software rendering is the same everywhere but for the edges of shapes.
MEAN, SHARE = 2.5, 0.01


def expect(what, found, wanted):
    if found != wanted:
        raise Failure(f"{what}: expected {wanted!r}, found {found!r}")


def near(what, found, wanted, tolerance):
    if not abs(found - wanted) <= tolerance:
        raise Failure(f"{what}: expected {wanted:.6g} within {tolerance:.2g}, found {found:.6g}")


def make(program, folder):
    """Plays the episodes; gives their pages, and the last state of the first."""
    pages = {}
    for name, (task, policy, _) in PAGES.items():
        pages[name] = folder / f"{name}.html"
        state = folder / f"{name}.json"
        command = [program, "run", task, "--policy", policy, "--html", pages[name], "--state", state]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    forward = [program, "physics", "forward", "--state", folder / "stand.json", "--moment-arms"]
    report = subprocess.run(forward, cwd=ROOT, check=True, stdout=subprocess.PIPE)
    return pages, json.loads(report.stdout)


def opens_quickly(browser, pages):
    for name, page in pages.items():
        browser.open(page, "t=0")
        first = int(browser.evaluate("document.documentElement.dataset.ready"))
        pictures = browser.evaluate(DRAW)
        print(f"  {name}: {page.stat().st_size / 1000:.0f} kB, {rate(page) / 1000:.1f} kB per second, first picture after {first} ms, then {pictures:.0f} in a second")


def rate(page):
    """Bytes of a page per second of motion: what is left without the program and the description of the model."""
    text = page.read_text().rsplit('id="recording">', 1)[1].split("<", 1)[0]
    contents = zlib.decompress(base64.b64decode(text), -15)
    length = int.from_bytes(contents[:4], "little")
    recording = json.loads(contents[4 : 4 + length])["recordings"][0]
    seconds = max(recording["frames"] - 1, 1) * recording["period"] * max(1, math.ceil(1 / recording["period"] / 60))
    return (len(text) - len(zlib.compress(contents[: 4 + length], 9)) * 4 / 3) / seconds


def reference_pictures(browser, pages, update):
    browser.size(640, 640)
    for name, (_, _, fragment) in PAGES.items():
        browser.open(pages[name], fragment)
        found, path = browser.screenshot(0.5), HERE / f"{name}.png"
        if update:
            path.write_bytes(found)
            continue
        mean, share = picture.differences(found, path.read_bytes())
        print(f"  {name}: mean difference {mean:.2f} of 255, {100 * share:.2f} % of the bytes differ")
        if mean > MEAN or share > SHARE:
            other = pathlib.Path(tempfile.gettempdir()) / f"msk-{name}.png"
            other.write_bytes(found)
            raise Failure(f"the picture of {name} is another: see {other}; `.ci/browser --update` accepts it")
    browser.size(*WINDOW)


def agrees_with_the_simulator(browser, pages, report):
    """Bodies, lengths of muscles and moment arms in the last frame are those of the simulator."""
    browser.open(pages["stand"], "t=1000")
    place = "viewer.stages[0].pose.position.flat()"
    worst = max(abs(a - b) for a, b in zip(browser.evaluate(place), report["xpos"]))
    near("largest error of a body's position, m", worst, 0, 2e-4)
    lengths = browser.evaluate("Array.from(viewer.stages[0].tubes.lengths)")
    worst = max(abs(a - b) for a, b in zip(lengths, report["actuator_length"]))
    near("largest error of a muscle's length, m", worst, 0, 1e-3)
    script = """viewer.recordings[0].anatomy.muscles.map((_, muscle) => {
        const stage = viewer.stages[0];
        const { branches } = pathOf(stage.recording, stage.pose, muscle, stage.moment);
        return momentArms(stage.recording, stage.pose, branches).map(({ at, arm }) => [at, arm]);
    })"""
    dofs = dict(zip(report["names"]["jnt_qposadr"], report["names"]["jnt_dofadr"]))
    width, worst = report["model"]["nv"], 0.0
    for muscle, arms in enumerate(browser.evaluate(module(script))):
        for at, arm in arms:
            worst = max(worst, abs(arm + report["actuator_moment"][muscle * width + dofs[at]]))
    near("largest error of a moment arm, m", worst, 0, 1e-3)


def module(script):
    """Functions of the page's module are reached through the viewer."""
    return f"((pathOf, momentArms) => {script})(viewer.parts.pathOf, viewer.parts.momentArms)"


def keyboard(browser, pages):
    browser.open(pages["stand"], "play=0&t=0")
    step = browser.evaluate("viewer.player.frames[1]")
    clock = lambda: browser.evaluate("viewer.player.time")
    for key, shift, wanted in [("ArrowRight", False, step), ("ArrowRight", True, step + 0.5), ("ArrowLeft", False, 0.5), ("Home", False, 0.0)]:
        browser.key(key, shift)
        near(f"time after {key}", clock(), wanted, 1e-6)
    browser.key("End")
    near("time at the end", clock(), browser.evaluate("viewer.player.duration"), 1e-9)
    browser.key(" ")
    browser.until("viewer.player.playing && viewer.player.time > 0 && viewer.player.time < 5")
    browser.key(" ")
    expect("playing after the second space", browser.evaluate("viewer.player.playing"), False)
    for key, state in [("m", "viewer.show.muscles"), ("b", "viewer.show.bones"), ("c", "viewer.show.contacts"), ("f", "viewer.show.follow")]:
        before = browser.evaluate(state)
        browser.key(key)
        expect(f"{state} after {key}", browser.evaluate(state), not before)
    before = browser.evaluate("[viewer.camera.yaw, viewer.camera.distance, viewer.themeName, viewer.by]")
    for key in "a+tg":
        browser.key(key)
    after = browser.evaluate("[viewer.camera.yaw, viewer.camera.distance, viewer.themeName, viewer.by]")
    if any(one == two for one, two in zip(before, after)):
        raise Failure(f"A, +, T and G change view, distance, theme and colouring: {before} became {after}")
    browser.key("n")
    expect("muscle after N", browser.evaluate("viewer.chosen"), 0)
    facts = browser.evaluate("document.getElementById('muscle-facts').textContent")
    if "Moment arm" not in facts or "Fibre" not in facts:
        raise Failure(f"the facts of a muscle have no moment arms: {facts!r}")
    browser.key("x")
    expect("rows of the first family", browser.evaluate("viewer.panels.rows.every(({ muscles }) => muscles.length === 1)"), True)
    browser.key("Escape")
    expect("chosen after Escape", browser.evaluate("[viewer.chosen, viewer.family]"), [-1, -1])
    browser.key("?")
    expect("list of keys", browser.evaluate("document.getElementById('keys').open"), True)
    browser.key("Escape")
    expect("list of keys after Escape", browser.evaluate("document.getElementById('keys').open"), False)


def pointer(browser, pages):
    """Scrubbing on the slider and on a chart, turning, choosing a muscle."""
    browser.open(pages["stand"], "play=0&t=0")
    duration = browser.evaluate("viewer.player.duration")
    for name, left in [("time", 0), ("terms", 0), ("families", 128)]:
        box = browser.evaluate(f"(({{ x, y, width, height }}) => [x, y, width, height])(document.getElementById('{name}').getBoundingClientRect())")
        x = lambda share: box[0] + left + share * (box[2] - left)
        browser.mouse((x(0.2), box[1] + box[3] / 2), (x(0.5), box[1] + box[3] / 2))
        near(f"time after half of {name}", browser.evaluate("viewer.player.time"), duration / 2, 0.03 * duration)
    yaw = browser.evaluate("viewer.camera.yaw")
    browser.mouse((300, 300), (360, 300))
    if browser.evaluate("viewer.camera.yaw") == yaw:
        raise Failure("a drag over the picture does not turn the view")
    browser.key("1")
    # The soleus is seen from behind.
    browser.key("4")
    browser.mouse(*[browser.evaluate("viewer.screenPlace('soleus_r')")])
    name = browser.evaluate("viewer.shown[0].anatomy.muscles[viewer.chosen]?.name")
    if not name:
        raise Failure("a click on a muscle chooses none")
    print(f"  a click at the middle of soleus_r chooses {name}")


def film_strip(browser, pages):
    """A strip has eight pictures of different moments, and leaves the time as it was."""
    browser.open(pages["squat"], "t=1.5")
    width, height, sums = browser.evaluate("""(() => {
        const film = viewer.parts.strip(viewer);
        const part = (index) => film.getContext("2d").getImageData((index * film.width) / 8, 0, film.width / 8, film.height).data;
        const sum = (data) => data.reduce((total, byte, at) => (total * 31 + byte * (at % 7)) % 1000003, 7);
        return [film.width, film.height, Array.from({ length: 8 }, (_, index) => sum(part(index)))];
    })()""")
    if width < height or len(set(sums)) < 8:
        raise Failure(f"a film strip of {width} x {height} has {len(set(sums))} different pictures, expected 8")
    near("time after a film strip", browser.evaluate("viewer.player.time"), 1.5, 1e-9)


def sizes(browser, pages):
    browser.open(pages["stand"], "t=0.5")
    for width, height in [(390, 780), (1024, 600), WINDOW]:
        browser.size(width, height)
        browser.settle()
        browser.settle()
        found = browser.evaluate("[document.documentElement.scrollWidth, viewer.renderer.canvas.width / viewer.renderer.canvas.clientWidth, viewer.renderer.canvas.clientHeight]")
        if found[0] > width or abs(found[1] - 1) > 0.02 or found[2] < 150:
            raise Failure(f"at {width} x {height}: scroll width, pixels per width, height of the picture are {found}")


def preferences(browser, pages):
    browser.prefer(prefers_color_scheme="dark", prefers_reduced_motion="reduce")
    browser.open(pages["stand"])
    expect("theme where dark is preferred", browser.evaluate("viewer.themeName"), "dark")
    expect("playing where motion is to be reduced", browser.evaluate("viewer.player.playing"), False)
    browser.prefer(prefers_color_scheme="light", prefers_reduced_motion="no-preference")
    browser.open(pages["stand"])
    expect("theme where light is preferred", browser.evaluate("viewer.themeName"), "light")
    browser.until("viewer.player.playing")


def accessible(browser, pages):
    """Every control has a name, and text stands out from what is behind it."""
    browser.open(pages["walk"], "t=0.5&muscle=soleus_r")
    names(browser)
    for theme in ("light", "dark"):
        browser.evaluate(f"viewer.setTheme('{theme}')")
        contrasts(browser, theme, [("ink", "panel"), ("ink", "sky"), ("quiet", "panel"), ("quiet", "sky"), ("accent", "panel")])


def names(browser):
    """Every control has a name."""
    for node in browser.command("Accessibility.getFullAXTree")["nodes"]:
        role = node.get("role", {}).get("value")
        if role in ("button", "slider", "combobox", "checkbox", "image", "region", "table", "Iframe") and not node.get("ignored"):
            if not node.get("name", {}).get("value"):
                raise Failure(f"a {role} has no name: {node.get('properties')}")


# Relative luminance of a colour of the style sheet.
LUMINANCE = """(name) => { const probe = document.createElement("i"); probe.style.color = `var(--${name})`; document.body.append(probe);
    const parts = getComputedStyle(probe).color.match(/[\\d.]+/g).slice(0, 3).map(Number); probe.remove();
    const [r, g, b] = parts.map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b; }"""


def contrasts(browser, theme, pairs):
    """Text stands out from what is behind it (WCAG 2.2, 1.4.3: 4.5 to 1)."""
    for text, behind in pairs:
        one, two = (browser.evaluate(f"({LUMINANCE})('{name}')") for name in (text, behind))
        ratio = (max(one, two) + 0.05) / (min(one, two) + 0.05)
        if ratio < 4.5:
            raise Failure(f"{text} on {behind} in {theme}: contrast {ratio:.2f}, expected 4.5")


def side_by_side(browser, pages):
    """A second page opened from a file stands beside the first, on the same clock."""
    browser.open(pages["walk"], "t=0.5")
    root = browser.command("DOM.getDocument")["root"]["nodeId"]
    node = browser.command("DOM.querySelector", {"nodeId": root, "selector": "#file"})["nodeId"]
    browser.command("DOM.setFileInputFiles", {"nodeId": node, "files": [str(pages["stand"])]})
    browser.until("viewer.stages.length === 2")
    browser.settle()
    expect("titles", browser.evaluate("[...document.querySelectorAll('#captions h1')].map((title) => title.textContent)"), ["walk, cmc", "stand, cmc"])
    near("length of the clock", browser.evaluate("viewer.player.duration"), 10, 1e-6)
    browser.key("End")
    browser.evaluate("document.getElementById('choices').querySelectorAll('select')[1].focus()")


def live(browser, program, folder):
    """The page of a run that goes on: its numbers grow, the last episode plays, and the server ends with the run."""
    out = folder / "live"
    run = [program, "eval", "tasks.msk", "--task", "walk", "--policy", "zero", "--episodes", "60", "--threads", "1", "--out", out]
    evaluation = subprocess.Popen(run, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while not (out / "run.json").exists():
        time.sleep(0.05)
    server = subprocess.Popen([program, "view", out], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        browser.visit(server.stdout.readline().strip())
        status = "document.getElementById('status').textContent"
        first = browser.evaluate(status)
        browser.until("!document.getElementById('episode').hidden")
        shown = browser.evaluate("document.getElementById('episode').srcdoc.length")
        if shown < 100_000:
            raise Failure(f"the page of the last episode has {shown} characters")
        expect("columns of tasks", browser.evaluate("[...document.querySelectorAll('#tasks thead th')].map((cell) => cell.textContent)"), ["task", "episodes", "success", "return", "steps"])
        # A list has a button for each episode, which the keyboard reaches.
        browser.until("document.querySelectorAll('#list button').length > 1")
        browser.evaluate("[...document.querySelectorAll('#list button')].at(-1).focus()")
        browser.key(" ")
        browser.until("document.getElementById('episode-status').textContent === 'walk, episode 0'")
        live_page_is_accessible(browser)
        browser.until(f"{status}.includes('has ended')", 120)
        print(f"  live: {first}, then {browser.evaluate(status)}")
        expect("exit code of msk view after the run", server.wait(60), 0)
        expect("exit code of msk eval", evaluation.wait(60), 0)
    finally:
        browser.size(*WINDOW)
        for process in (server, evaluation):
            process.kill()
            process.wait()


def live_page_is_accessible(browser):
    """The page of what goes on fits a phone, names its controls, follows the preference for dark colours, and can be read."""
    for width in (390, WINDOW[0]):
        browser.size(width, WINDOW[1])
        browser.settle()
        if browser.evaluate("document.documentElement.scrollWidth") > width:
            raise Failure(f"the live page is wider than {width} px")
    names(browser)
    papers = set()
    for theme in ("light", "dark"):
        browser.prefer(prefers_color_scheme=theme)
        contrasts(browser, theme, [(text, behind) for text in ("ink", "quiet", "accent", "good") for behind in ("paper", "panel")])
        papers.add(browser.evaluate("getComputedStyle(document.body).backgroundColor"))
    browser.prefer(prefers_color_scheme="light")
    expect("colours of the live page", len(papers), 2)


def live_episode(browser, program):
    """While an episode is being played its page shows the first part, and afterwards the whole episode."""
    run = [program, "run", "walk", "--policy", "random", "--live"]
    playing = subprocess.Popen(run, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        browser.visit(playing.stderr.readline().split()[1])
        browser.until("document.getElementById('episode-status').textContent === 'the whole episode'", 120)
        if browser.evaluate("document.getElementById('episode').srcdoc.length") < 100_000:
            raise Failure("the page of the episode is empty")
        if browser.evaluate("document.querySelectorAll('#terms tbody tr').length") < 2:
            raise Failure("the page shows no reward terms")
        live_page_is_accessible(browser)
        expect("exit code of msk run --live after its reader has the episode", playing.wait(60), 0)
    finally:
        browser.size(*WINDOW)
        playing.kill()
        playing.wait()


def main():
    program, update = pathlib.Path(sys.argv[1]).resolve(), "--update" in sys.argv
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="msk-pages-") as folder, Browser() as browser:
        pages, report = make(program, pathlib.Path(folder))
        browser.size(*WINDOW)
        checks = [
            (opens_quickly, pages),
            (reference_pictures, pages, update),
            (agrees_with_the_simulator, pages, report),
            (keyboard, pages),
            (pointer, pages),
            (film_strip, pages),
            (sizes, pages),
            (preferences, pages),
            (accessible, pages),
            (side_by_side, pages),
            (live, program, pathlib.Path(folder)),
            (live_episode, program),
        ]
        for check, *arguments in checks:
            start = time.monotonic()
            check(browser, *arguments)
            print(f"{check.__name__.replace('_', ' ')}: {time.monotonic() - start:.1f} s", flush=True)
            errors = browser.errors()
            if errors:
                raise Failure("the page complains:\n" + "\n".join(errors))
    print(f"{len(checks)} checks of {len(PAGES)} pages in {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"error: {failure}")
