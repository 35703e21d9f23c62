"""Chromium without a window, driven through a pipe, and checks that are counted: what the tests of pages share.

A test is called with PALPATE SOURCE_FOLDER [PICTURES]; importing this ends it with 77 (skipped) where there is no Chromium.
Screenshots go to PICTURES.
"""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
if not chromium:
    print("skipped: there is no Chromium")
    sys.exit(77)

program = sys.argv[1]
pictures = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
failures = []
PATIENCE = 60  # [s] for what takes a second or two: only a page that hangs takes as long


def expect(holds, what):
    if not holds:
        failures.append(what)


def end():
    for failure in failures:
        print("FAILED", failure)
    sys.exit(1 if failures else 0)


def palpate(*arguments):
    return subprocess.run([program, *map(str, arguments), "-q"], check=True, capture_output=True, text=True).stdout


class Browser:
    """Chromium, told what to do through a pipe in its own protocol."""

    def __init__(self, profile, scripted):
        """`scripted`: the page's global whose value, once there, scripts call `p`."""
        self.scripted = scripted
        to_browser, self.write_end = os.pipe()
        self.read_end, from_browser = os.pipe()

        def connect():
            # 3 and 4 are where the browser reads and writes; first out of their way
            read, write = os.dup(to_browser), os.dup(from_browser)
            os.dup2(read, 3)
            os.dup2(write, 4)

        command = [chromium, "--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                   "--remote-debugging-pipe", f"--user-data-dir={profile}", "--host-resolver-rules=MAP * ~NOTFOUND", "about:blank"]
        if os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # Chromium's sandbox does not start as root
        self.process = subprocess.Popen(command, preexec_fn=connect, close_fds=False, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.pending, self.events, self.session = 0, b"", [], None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(domain + ".enable")

    def read(self):
        while b"\0" not in self.pending:
            more = os.read(self.read_end, 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self.pending += more
        message, self.pending = self.pending.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def run(self, script):
        """The value of a script, in which `p` is the page's scripted object."""
        result = self.call("Runtime.evaluate", expression=f"Promise.resolve({self.scripted}).then(async (p) => {{ {script} }})",
                           awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(json.dumps(result["exceptionDetails"])[:2000])
        return result["result"].get("value")

    def open(self, address, width, height, mobile=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=address)
        last = time.monotonic() + PATIENCE
        while not self.call("Runtime.evaluate", expression=f"typeof {self.scripted} !== 'undefined'")["result"].get("value"):
            if time.monotonic() > last:
                raise RuntimeError(f"{address} has no {self.scripted} after {PATIENCE} s")
            time.sleep(0.05)

    def wait(self, condition):
        """Until it holds of `p`, asked at each frame."""
        self.run(f"""
          const last = performance.now() + {1000 * PATIENCE};
          while (!({condition})) {{
            if (performance.now() > last) throw new Error({json.dumps(f"after {PATIENCE} s it is not so: {condition}")});
            await new Promise(requestAnimationFrame);
          }}""")

    def frame(self):
        """The page's next frame."""
        self.run("await new Promise(requestAnimationFrame);")

    def mouse(self, kind, x, y, buttons=1):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons, clickCount=1)

    def touch(self, kind, *fingers):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in fingers])

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key)

    def picture(self, name):
        if pictures:
            data = self.call("Page.captureScreenshot", format="png")["data"]
            (pictures / f"{name}.png").write_bytes(base64.b64decode(data))

    def unnamed_controls(self):
        return self.run("""
          return [...document.querySelectorAll('select, input, button, textarea')].filter((c) => c.offsetParent !== null &&
            !(c.labels?.length || c.getAttribute('aria-label') || c.textContent)).map((c) => c.id);""")

    def errors(self):
        told = []
        for event in self.events:
            entry = event.get("params", {})
            if event.get("method") == "Runtime.exceptionThrown":
                told.append(json.dumps(entry["exceptionDetails"])[:400])
            if event.get("method") == "Runtime.consoleAPICalled" and entry["type"] in ("error", "warning", "assert"):
                told.append(json.dumps(entry["args"])[:400])
            if event.get("method") == "Log.entryAdded" and entry["entry"]["level"] == "error":
                told.append(entry["entry"]["text"])
        return told

    def close(self):
        try:
            self.session = None
            self.call("Browser.close")
        except (RuntimeError, OSError):
            pass
        self.process.wait(20)
