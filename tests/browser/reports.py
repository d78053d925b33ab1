"""Reports of results in a real browser: complete, without errors, on a phone's width, by day and by night.

Usage: reports.py MSK [FOLDER]: `MSK` is the program; pictures are written to `FOLDER`.
"""

import pathlib
import subprocess
import sys
import tempfile

from driver import Browser, Failure

TASK = """task lean {
    family   stabilization
    body     human
    control  100 Hz
    horizon  20 steps
    init { pose neutral; root { height on ground }; noise joints normal(0, 0.02 rad) }
    observe { pelvis.height }
    reward { 10 pose = exp(-norm(independent.q - independent.neutral) / 1 rad); 5 alive = not terminated }
    success survived
}
"""
WINDOWS = {"screen": (1280, 900), "phone": (390, 844)}


def expect(condition, message):
    if not condition:
        raise Failure(message)


def report(msk, folder):
    """A report of two evaluations and a sweep of a small task."""
    (folder / "lean.msk").write_text(TASK)

    def run(*arguments):
        subprocess.run([msk, *arguments], cwd=folder, check=True, capture_output=True)

    run("eval", "lean.msk", "--policy", "random", "--episodes", "2", "--out", "random", "--trace=activations,terms")
    run("eval", "lean.msk", "--policy", "zero", "--episodes", "2", "--out", "zero")
    run("eval", "lean.msk", "--policy", "random", "--episodes", "2", "--out", "sweep", "--sweep", "latency")
    run("report", "random", "zero", "sweep", "--out", "report")
    return folder / "report" / "report.html"


def check(browser, page, pictures):
    for theme in ("light", "dark"):
        for name, (width, height) in WINDOWS.items():
            browser.prefer(prefers_color_scheme=theme)
            browser.size(width, height)
            browser.command("Page.navigate", {"url": f"file://{page}"})
            browser.until("document.readyState === 'complete' && document.querySelectorAll('section').length > 0")
            browser.settle()
            where = f"{name}, {theme}"
            expect(not browser.errors(), f"{where}: the page complains")
            sections, figures = (browser.evaluate(f"document.querySelectorAll('{what}').length") for what in ("section", "svg"))
            expect(sections >= 6 and figures >= 5, f"{where}: {sections} sections and {figures} figures")
            wide = browser.evaluate("document.documentElement.scrollWidth - innerWidth")
            expect(wide <= 0, f"{where}: the page is {wide} px too wide")
            empty = browser.evaluate("[...document.querySelectorAll('svg')].filter((s) => s.getBoundingClientRect().height < 50).length")
            expect(empty == 0, f"{where}: {empty} figures are not shown")
            light = browser.evaluate("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)[0] > 128")
            expect(light == (theme == "light"), f"{where}: the ground has the wrong brightness")
            links = browser.evaluate("[...document.querySelectorAll('nav a')].every((a) => document.querySelector(a.hash))")
            expect(links, f"{where}: a link leads nowhere")
            if pictures:
                pictures.mkdir(parents=True, exist_ok=True)
                (pictures / f"report-{name}-{theme}.png").write_bytes(browser.screenshot())


def main():
    msk = pathlib.Path(sys.argv[1]).resolve()
    pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        check(browser, report(msk, pathlib.Path(folder).resolve()), pictures)
    print("reports: 4 views without a fault")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"error: {failure}")
