#!/usr/bin/env python3
"""Looks at a page of recorded motion in a headless Chromium: python3 look.py PAGE.html [--out FOLDER]

Opens the page from disk, asks window.player for its facts in every scene, unpacks all recordings, works the controls,
and takes screenshots (light, dark, with contacts, with debug drawing, side by side, on a phone; with WebGL and
without), which must not be blank and must change where something moves. Exits with 1 if anything is wrong, and with 0
and a line that says so where there is no Chromium. Needs nothing but Python; CHROMIUM names another browser.
"""
import argparse
import base64
import fcntl
import json
import os
import pathlib
import select
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

FLAGS = ["--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--remote-debugging-pipe"]
PLAIN = ["--disable-gpu", "--disable-3d-apis"]                         # as where there is no WebGL
WEBGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]        # on the processor: slow, but the same picture
PATIENCE = 60


class Browser:
    """A headless browser with one tab, spoken to over two pipes."""

    def __init__(self, program, flags):
        self.profile = tempfile.mkdtemp(prefix="look-")
        to_read, self.to = os.pipe()
        self.source, to_write = os.pipe()
        # The browser wants its pipes as 3 and 4: take them out of the way of these numbers first.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 20) for end in (to_read, to_write)]

        def place():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [program, *FLAGS, *flags, f"--user-data-dir={self.profile}", "about:blank"], preexec_fn=place,
            close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (to_read, to_write, *ends):
            os.close(end)
        self.rest, self.number, self.session, self.errors, self.requests = b"", 0, None, [], []
        tab = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.ask("Target.attachToTarget", targetId=tab, flatten=True)["sessionId"]
        for domain in ("Runtime", "Page", "Network"):
            self.ask(domain + ".enable")

    def ask(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("method") == "Runtime.exceptionThrown":
                details = answer["params"]["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description", details["text"]))
            elif answer.get("method") == "Network.requestWillBeSent":
                self.requests.append(answer["params"]["request"]["url"])
            elif answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]

    def read(self):
        while b"\0" not in self.rest:
            if not select.select([self.source], [], [], PATIENCE)[0]:
                raise RuntimeError(f"the browser has not answered for {PATIENCE} s")
            piece = os.read(self.source, 1 << 20)
            if not piece:
                raise RuntimeError("the browser has ended")
            self.rest += piece
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def run(self, script):
        answer = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", script))
        return answer["result"].get("value")

    def until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not self.run(condition):
            if self.errors or time.monotonic() > end:
                raise RuntimeError(f"{what} did not happen; errors: {self.errors}")
            time.sleep(0.03)

    def window(self, width, height, scale=1, dark=False):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale,
                 mobile=False)
        self.ask("Emulation.setEmulatedMedia",
                 features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def open(self, page, state):
        """Loads the page anew in the state that the address names."""
        self.ask("Page.navigate", url="about:blank")
        self.ask("Page.navigate", url=page.as_uri() + "#" + state)
        self.until("document.readyState === 'complete' && !!window.player", "loading")
        self.drawn()

    def go(self, state):
        self.run(f"location.hash = {json.dumps(state)}")
        time.sleep(0.05)
        self.drawn()

    def drawn(self):
        self.until("player.errors.length > 0 || player.playing || player.drawnTime === player.time", "drawing")

    def key(self, key):
        for kind in ("keyDown", "keyUp"):
            self.ask("Input.dispatchKeyEvent", type=kind, key=key, **({"text": key} if len(key) == 1 else {}))

    def mouse(self, kind, x, y, **more):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def shot(self, path=None):
        """The pixels of the stage, but for the strip with the legend; a picture of the page goes to the path."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        if path:
            path.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"]))
        box = self.run("(({x, y, width, height}) => ({x, y, width, height}))(document.getElementById('stage')"
                       ".getBoundingClientRect())")
        box = {**box, "y": box["y"] + 52, "height": box["height"] - 52}
        clip = {**{key: round(value) for key, value in box.items()}, "scale": 0.4}
        return pixels(base64.b64decode(self.ask("Page.captureScreenshot", format="png", clip=clip)["data"]))

    def close(self):
        try:
            self.session = None
            self.ask("Browser.close")
            self.process.wait(10)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        for end in (self.to, self.source):
            os.close(end)
        shutil.rmtree(self.profile, ignore_errors=True)


def pixels(png):
    """The pixels of an 8-bit RGB or RGBA picture, three bytes each."""
    width, height, _, colour = struct.unpack(">IIBB", png[16:26])
    size = {2: 3, 6: 4}[colour]
    data, at = b"", 8
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    data, row, out = zlib.decompress(data), bytearray(width * size), []
    for y in range(height):
        start = y * (width * size + 1)
        kind, line = data[start], bytearray(data[start + 1:start + 1 + width * size])
        for i in range(len(line) if kind else 0):
            left = line[i - size] if i >= size else 0
            corner = row[i - size] if i >= size else 0
            if kind == 4:
                guess = left + row[i] - corner
                add = min((left, row[i], corner), key=lambda value: abs(guess - value))
            else:
                add = (0, left, row[i], (left + row[i]) // 2)[kind]
            line[i] = (line[i] + add) & 255
        row = line
        out.extend(line[i:i + 3] for i in range(0, len(line), size))
    return [bytes(pixel) for pixel in out]


def changed(a, b):
    """The part of the pixels that differ visibly."""
    return sum(max(abs(p - q) for p, q in zip(x, y)) > 12 for x, y in zip(a, b)) / max(len(a), 1)


def coloured(picture, strength):
    """The part of the pixels whose colour is that far from grey: bodies are, background and ground are not."""
    return sum(max(pixel) - min(pixel) > strength for pixel in picture) / max(len(picture), 1)


class Report:
    def __init__(self):
        self.failed = self.passed = 0

    def check(self, good, what):
        if good:
            self.passed += 1
        else:
            self.failed += 1
            print(f"look: WRONG: {what}")


def facts_of_all_scenes(browser, page, report, most_bytes):
    """Every scene, without WebGL: what the player says of it, and what the page shows."""
    browser.window(1280, 800)
    browser.open(page, "scene=0&t=0&paused")
    count = browser.run("player.sceneCount")
    report.check(count >= 1, f"there are {count} scenes")
    report.check(browser.run("document.querySelectorAll('#facts tbody tr').length") == count, "a row for every scene")
    report.check(browser.run("player.verify()") == count, "all recordings unpack")
    size = page.stat().st_size
    report.check(browser.run("player.pageBytes") == size, f"the page says that it has {size} bytes")
    report.check(size <= most_bytes, f"the page has {size} bytes, {most_bytes} are allowed")
    scenes = []
    for scene in range(count):
        browser.go(f"scene={scene}&t=0.5&paused&contacts&debug")
        said = browser.run("({...player, pose: player.pose(0)})")
        name = f"scene {scene} ({said['title']}, {said['scalar']})"
        report.check(said["scene"] == scene and not said["playing"] and said["contactsShown"], f"{name}: as asked")
        report.check(said["frameCount"] >= 2 and said["duration"] > 0, f"{name}: has {said['frameCount']} frames")
        report.check(abs(said["time"] - min(0.5, said["duration"])) < 1e-9, f"{name}: time is {said['time']}")
        report.check(said["renderer"] == "canvas", f"{name}: drawn without WebGL")
        stored = browser.run("JSON.parse(document.getElementById('recording').textContent)"
                             f".scenes[{scene}]")
        frame = round(said["time"] / stored["dt"] / stored["every"])
        absent = {body for body, *_ in stored["spans"]} - {body for body, first, last in stored["spans"]
                                                           if first <= frame <= last}
        bodies = {i for i, kind in enumerate(stored["bodies"]) if len(stored["kinds"][kind]) > 1} - absent
        joints = len(stored["joints"])
        report.check(said["bodies"] == len(bodies), f"{name}: drew {said['bodies']} bodies of {len(bodies)}")
        report.check(said["joints"] == joints, f"{name}: drew {said['joints']} joints of {joints}")
        report.check(all(isinstance(value, (int, float)) for value in said["pose"]), f"{name}: pose {said['pose']}")
        if "palette" in stored:
            unpacked = browser.run("decode.scene(JSON.parse(document.getElementById('recording').textContent)"
                                   f".scenes[{scene}]).drawing.frames.map(frame => frame.former.length)")
            report.check(sum(unpacked) == stored["lines"] > 0,
                         f"{name}: {sum(unpacked)} lines unpack of {stored['lines']}")
            report.check(said["debugShown"] and (said["lines"] == unpacked[frame] or said["frame"] % 1),
                         f"{name}: drew {said['lines']} lines of {unpacked[frame]}")
            said["drawing"] = True
        scenes.append(said)
    return scenes


def controls(browser, page, report, scene):
    """Keys, slider, wheel and mouse do what they say, and nothing on the page jumps."""
    browser.open(page, f"scene={scene}&t=0&paused")
    boxes = ("JSON.stringify(['stage', 'transport', 'scrub', 'time', 'facts'].map(id => document.getElementById(id)"
             ".getBoundingClientRect()))")
    before, places = browser.shot(), browser.run(boxes)
    browser.key("ArrowRight")
    report.check(browser.run("player.frame") == 1, "the right arrow goes on by a frame")
    browser.key("ArrowLeft")
    report.check(browser.run("player.frame") == 0, "the left arrow goes back by a frame")
    browser.run("{ const scrub = document.getElementById('scrub'); scrub.value = scrub.max / 2;"
                " scrub.dispatchEvent(new Event('input')); }")
    report.check(abs(browser.run("player.time / player.duration") - 0.5) < 1e-6, "the slider moves the time")
    browser.key("End")
    browser.key("Home")
    report.check(browser.run("player.time") == 0, "Home goes to the start")
    browser.key(" ")
    report.check(browser.run("player.playing"), "space plays")
    browser.until("player.time > 0.2", "playing on")
    browser.key(" ")
    report.check(not browser.run("player.playing"), "space pauses")
    browser.key("End")
    browser.run("document.getElementById('loop').getAttribute('aria-pressed') === 'true' ||"
                " document.getElementById('loop').click()")
    end = browser.run("player.duration")
    report.check(browser.run("player.time") == end, "End goes to the end")
    browser.go(f"scene={scene}&t={end - 0.05}&speed=4")
    browser.until(f"player.playing && player.time < {end / 2}", "starting again at the end")
    browser.key(" ")
    browser.key("c")
    report.check(browser.run("player.contactsShown"), "C shows the contacts")
    report.check(browser.run(boxes) == places, "nothing jumps when the controls are used")
    browser.key("c")
    browser.key("Home")
    browser.drawn()
    report.check(changed(before, browser.shot()) < 0.001, "the start looks as at first")
    browser.mouse("mousePressed", 600, 250, button="left", clickCount=1)
    browser.mouse("mouseMoved", 700, 280, button="left")
    browser.mouse("mouseReleased", 700, 280, button="left", clickCount=1)
    dragged = browser.shot()
    report.check(changed(before, dragged) > 0.002, "dragging moves the view")
    browser.mouse("mouseWheel", 600, 250, deltaX=0, deltaY=-300)
    zoomed = browser.shot()
    report.check(changed(dragged, zoomed) > 0.002, "the wheel zooms")
    browser.key("f")
    report.check(changed(zoomed, browser.shot()) > 0.002, "F fits the scene again")
    report.check(browser.run(
        "[...document.querySelectorAll('button, input, select')].every(part => part.getAttribute('aria-label') ||"
        " (part.closest('label') || part).textContent.trim())"), "every control has a name")


def pictures(browser, page, report, scenes, first, out, suffix):
    """The first run of every scene in the shapes that people see."""
    for scene in first:
        said = scenes[scene]
        half = said["duration"] / 2
        name = f"{scene}-{said['dimension']}d{suffix}"
        wants = "&renderer=webgl" if suffix == "-webgl" else ""
        for dark in (False, True):
            shade = "dark" if dark else "light"
            browser.window(1280, 800, dark=dark)
            browser.open(page, f"scene={scene}&t=0&paused{wants}")
            start = browser.shot(out / f"{name}-{shade}-start.png")
            near = "&zoom=2.5" if said["dimension"] == 3 else ""
            browser.open(page, f"scene={scene}&t={half}&paused&contacts{near}{wants}")
            later = browser.shot(out / f"{name}-{shade}-contacts.png")
            report.check(coloured(start, 24) > 0.001, f"{name}, {shade}: bodies are seen")
            # A few may be hidden by the bodies that touch.
            if browser.run("player.contacts") > 8:
                report.check(coloured(later, 60) > 0.0001, f"{name}, {shade}: contacts are seen")
            bright = sum(sum(pixel) for pixel in start) / (3 * len(start))
            report.check((bright < 110) == dark, f"{name}, {shade}: the mean brightness is {bright:.0f}")
        if said.get("drawing"):
            browser.window(1280, 800)
            views = []
            for state in ("", "&debug"):
                browser.open(page, f"scene={scene}&t={half}&paused{near}{wants}{state}")
                views.append(browser.shot(out / f"{name}-debug.png" if state else None))
            report.check(changed(*views) > 0.002, f"{name}: debug drawing is seen")
            browser.key("b")
            report.check(changed(views[0], browser.shot()) < 0.001, f"{name}: B takes debug drawing away")
        runs = [one for one in scenes if one["title"] == said["title"] and one["dimension"] == said["dimension"]]
        if len(runs) > 1:
            browser.window(1280, 800)
            browser.open(page, f"scene={scene}&t={half}&paused&compare{wants}")
            browser.shot(out / f"{name}-side-by-side.png")
            drawn = browser.run("player.bodies")
            report.check(drawn == sum(one["bodies"] for one in runs), f"{name}: side by side shows {drawn} bodies")
        if not suffix:
            browser.window(390, 844, 2)
            browser.open(page, f"scene={scene}&t={half}&paused")
            browser.shot(out / f"{name}-phone.png")
            report.check(browser.run("document.documentElement.scrollWidth <= innerWidth"), f"{name}: fits a phone")


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("page", type=pathlib.Path)
    options.add_argument("--out", type=pathlib.Path, help="folder for the screenshots; without it they are not kept")
    options.add_argument("--most-bytes", type=int, default=8_000_000, help="how large the page may be")
    options = options.parse_args()
    names = [os.environ.get("CHROMIUM", ""), "chromium", "chromium-browser", "google-chrome"]
    program = next(filter(None, map(shutil.which, filter(None, names))), None)
    if not options.page.is_file():
        sys.exit(f"look: WRONG: no page {options.page}")
    if not program:
        print("look: skipped, no chromium here")
        return
    page, report = options.page.resolve(), Report()
    out = options.out or pathlib.Path(tempfile.mkdtemp(prefix="look-"))
    out.mkdir(parents=True, exist_ok=True)
    try:
        for flags, suffix in ((PLAIN, ""), (WEBGL, "-webgl")):
            browser = Browser(program, flags)
            try:
                if not suffix:
                    scenes = facts_of_all_scenes(browser, page, report, options.most_bytes)
                    kinds = [(one["title"], one["dimension"]) for one in scenes]
                    first = [i for i, kind in enumerate(kinds) if kinds.index(kind) == i]
                    for scene in first:
                        browser.window(1280, 800)
                        controls(browser, page, report, scene)
                else:
                    first = [scene for scene in first if scenes[scene]["dimension"] == 3]
                    if first:
                        browser.window(640, 400)
                        browser.open(page, f"scene={first[0]}&paused&renderer=webgl")
                        if browser.run("!document.createElement('canvas').getContext('webgl2')"):
                            print("look: no WebGL in this browser, only the plain view was looked at")
                            first = []
                        else:
                            report.check(browser.run("player.renderer") == "webgl", "WebGL draws where there is WebGL")
                pictures(browser, page, report, scenes, first, out, suffix)
                # Without a scene in space the second browser has opened no page.
                errors = browser.run("window.player ? player.errors : []")
                report.check(errors == [], f"errors on the page: {errors}")
                report.check(not browser.errors, f"errors in scripts: {browser.errors}")
                outside = [url for url in browser.requests if not url.startswith(("file:", "data:", "about:"))]
                report.check(not outside, f"the page asks the network for {outside}")
            finally:
                browser.close()
    except RuntimeError as error:
        report.check(False, error)
    finally:
        if not options.out:
            shutil.rmtree(out, ignore_errors=True)
    print(f"look: {report.passed} checks passed, {report.failed} failed" +
          (f"; screenshots in {out}" if options.out else ""))
    sys.exit(1 if report.failed else 0)


if __name__ == "__main__":
    main()
