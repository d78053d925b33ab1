"""How fast pages are in a headless browser that draws in software: time to the first canvas, and frames per second while they play.

Usage: page_speed.py FOLDER PAGE...

The folder is served on the loopback interface, so that pages of other programs find copies of what they load from a network:
`npm install three@0.150.1 lil-gui@0.18.0 es-module-shims@1.6.3 pako@2.1.0` and the folder `visualizer/js` of brax 0.14.2, with the
addresses in its page changed to these.
"""

import functools
import http.server
import pathlib
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests/browser"))
from driver import Browser

WINDOW = (1280, 800)
# Seconds before frames are counted, and for which they are.
WAIT, COUNT = 2, 8
FRAMES = "window.frames_drawn = 0; (function frame() { window.frames_drawn++; requestAnimationFrame(frame); })()"


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def measure(browser, address):
    """Seconds until there is a canvas, and frames per second."""
    start = time.monotonic()
    browser.command("Page.navigate", {"url": address})
    browser.until("document.readyState === 'complete' && document.querySelector('canvas') !== null")
    first = time.monotonic() - start
    browser.evaluate(FRAMES)
    time.sleep(WAIT)
    before, start = browser.evaluate("window.frames_drawn"), time.monotonic()
    time.sleep(COUNT)
    return first, (browser.evaluate("window.frames_drawn") - before) / (time.monotonic() - start)


def main():
    folder, pages = sys.argv[1], sys.argv[2:]
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with Browser() as browser:
        browser.size(*WINDOW)
        for page in pages:
            first, rate = measure(browser, f"http://127.0.0.1:{server.server_port}/{page}")
            print(f"{page}: canvas after {first:.2f} s, {rate:.1f} frames per second")


if __name__ == "__main__":
    main()
