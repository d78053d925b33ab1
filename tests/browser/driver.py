"""A headless Chromium, driven through its DevTools protocol over two pipes: nothing to install but the browser."""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

# Pictures are drawn in software, so that they are the same on every machine.
FLAGS = [
    "--headless=new",
    "--remote-debugging-pipe",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--mute-audio",
]


class Failure(Exception):
    """What was expected, and what was found."""


class Browser:
    """One page of a browser. Use it as a context, so that the browser ends with it."""

    def __init__(self, limit=60.0):
        self.limit = limit
        self.folder = tempfile.mkdtemp(prefix="msk-browser-")
        commands, self.commands = os.pipe()
        self.replies, replies = os.pipe()
        flags = FLAGS + [f"--user-data-dir={self.folder}"]
        if os.geteuid() == 0:
            # Chromium's sandbox does not work as root; the pages are our own and reach nothing.
            flags.append("--no-sandbox")
        program = shutil.which("chromium") or shutil.which("chromium-browser")
        if program is None:
            raise Failure("there is no program `chromium`: install it with `apt-get install chromium`")
        # The browser reads from descriptor 3 and writes to 4.
        script = f'exec "$@" 3<&{commands} 4>&{replies} 2>/dev/null'
        self.process = subprocess.Popen(["sh", "-c", script, "sh", program, *flags], pass_fds=(commands, replies))
        os.close(commands)
        os.close(replies)
        self.buffer = b""
        self.number = 0
        self.events = []
        target = self.command("Target.createTarget", {"url": "about:blank"}, session=None)["targetId"]
        self.session = self.command("Target.attachToTarget", {"targetId": target, "flatten": True}, session=None)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "DOM", "Accessibility"):
            self.command(f"{domain}.enable")

    session = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def command(self, method, parameters=None, session=""):
        """Sends a command and waits for its answer; events that come before it are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters or {}}
        if session is not None:
            message["sessionId"] = self.session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + self.limit
        while True:
            answer = self.receive(deadline, method)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise Failure(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def receive(self, deadline, awaited):
        while b"\0" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.replies], [], [], left)[0]:
                raise Failure(f"no answer to {awaited} within {self.limit:.0f} s")
            part = os.read(self.replies, 1 << 20)
            if not part:
                raise Failure(f"the browser ended before it answered {awaited}")
            self.buffer += part
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def evaluate(self, expression):
        """The value of an expression of the page; promises are awaited."""
        parameters = {"expression": expression, "returnByValue": True, "awaitPromise": True}
        result = self.command("Runtime.evaluate", parameters)
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise Failure(f"{expression}: {details.get('exception', {}).get('description', details['text'])}")
        return result["result"].get("value")

    def until(self, condition, seconds=30.0):
        """Waits until an expression of the page is true."""
        deadline = time.monotonic() + seconds
        while not self.evaluate(condition):
            if time.monotonic() > deadline:
                raise Failure(f"`{condition}` did not become true within {seconds:.0f} s")
            time.sleep(0.05)

    def open(self, path, fragment=""):
        """Opens a page and waits for its first picture. Another address first, or a new fragment would load nothing."""
        self.command("Page.navigate", {"url": "about:blank"})
        self.command("Page.navigate", {"url": f"file://{path}#{fragment}"})
        self.until("document.documentElement?.dataset.ready !== undefined || document.getElementById('message')?.textContent.includes('cannot')")
        self.settle()

    def visit(self, address):
        """Opens a live page and waits for its first numbers."""
        self.command("Page.navigate", {"url": address})
        self.until("document.documentElement?.dataset.ready !== undefined")

    def settle(self):
        """Waits until two pictures have been drawn."""
        self.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def errors(self):
        """What the page complained of since the last call."""
        found = []
        for event in self.events:
            method, parameters = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                details = parameters["exceptionDetails"]
                found.append(details.get("exception", {}).get("description", details["text"]))
            elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert"):
                found.append(" ".join(str(argument.get("value", argument.get("description"))) for argument in parameters["args"]))
            elif method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
                found.append(parameters["entry"]["text"])
        self.events.clear()
        return found

    def key(self, key, shift=False):
        """Presses and releases a key."""
        codes = {" ": 32, "ArrowLeft": 37, "ArrowRight": 39, "Home": 36, "End": 35, "Escape": 27, "Tab": 9, "Enter": 13}
        parameters = {"key": key, "modifiers": 8 if shift else 0, "windowsVirtualKeyCode": codes.get(key, ord(key.upper()[0]))}
        if len(key) == 1:
            parameters["text"] = key
        self.command("Input.dispatchKeyEvent", {"type": "keyDown", **parameters})
        parameters.pop("text", None)
        self.command("Input.dispatchKeyEvent", {"type": "keyUp", **parameters})
        self.settle()

    def mouse(self, *places):
        """Presses at the first place, moves over the others, releases at the last."""
        for index, (x, y) in enumerate(places):
            kind = "mousePressed" if index == 0 else "mouseMoved"
            self.command("Input.dispatchMouseEvent", {"type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1})
        x, y = places[-1]
        self.command("Input.dispatchMouseEvent", {"type": "mouseReleased", "x": x, "y": y, "button": "left", "clickCount": 1})
        self.settle()

    def size(self, width, height):
        """Gives the window another size."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.command("Emulation.setDeviceMetricsOverride", metrics)

    def prefer(self, **features):
        """Sets what the reader prefers: prefers_color_scheme="dark", prefers_reduced_motion="reduce"."""
        wanted = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.command("Emulation.setEmulatedMedia", {"features": wanted})

    def screenshot(self, scale=1.0):
        """The window as PNG."""
        width, height = self.evaluate("[innerWidth, innerHeight]")
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": scale}
        return base64.b64decode(self.command("Page.captureScreenshot", {"format": "png", "clip": clip})["data"])
