"""Checks in a headless browser that pages of `garnet view` draw, turn fast and can be used.

    apt-get install chromium
    python check_page.py --garnet target/release/garnet -o shots
    python check_page.py PAGE.html -o shots

Without a page, one is made of a wavy tube round a ball, 20,000 vertices in all. Each page is opened
without a network, with software rendering, and must

- show more than a background, on a screen of 800 x 600 and on a phone,
- ask for no address,
- look other after a key for each of turning, moving, zooming, parts, wireframe and coloring, after a
  drag of the mouse and after two fingers on the phone,
- turn at 30 frames a second or more, all of them drawn to the end, at 800 x 600, if no more than
  20,000 vertices are seen (in all panes); of larger pages the rate is told.

Prints a line a check, writes a picture of each screen, and ends with 1 if a check fails. Needs
Python's own library alone.
"""

import argparse
import base64
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

WIDTH, HEIGHT = 800, 600
PHONE = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
LEAST_RATE, MOST_VERTICES = 30.0, 20_000
SECONDS = 5

# Turns by a key in each frame, and waits at the end until all pictures are there.
TURN = """
new Promise((done) => {
  const gl = document.getElementById("stage").getContext("webgl2");
  const pixel = new Uint8Array(4);
  const start = performance.now();
  let frames = 0;
  const turn = () => {
    document.dispatchEvent(new KeyboardEvent("keydown", {key: "ArrowRight"}));
    requestAnimationFrame(() => {
      frames++;
      if (performance.now() - start < %d) {
        turn();
        return;
      }
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      done(frames * 1000 / (performance.now() - start));
    });
  };
  turn();
})
"""


# How many vertices are drawn, those of a body in each pane.
SEEN = """
(() => {
  const { panes, meshes } = JSON.parse(document.getElementById("scene").textContent);
  return panes.flatMap((pane) => pane.meshes).reduce((sum, mesh) => sum + meshes[mesh].vertices, 0);
})()
"""


class Browser:
    """A Chromium that is spoken to over pipes."""

    def __init__(self, program, folder):
        to_read, self.to = os.pipe()
        self.back, back_write = os.pipe()
        flags = [
            "--headless=new",
            "--no-sandbox",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
            f"--user-data-dir={folder}",
            "--remote-debugging-pipe",
            "about:blank",
        ]
        # Chromium reads commands from 3 and answers on 4.
        script = f'exec 3<&{to_read} 4>&{back_write}; exec "$@"'
        self.process = subprocess.Popen(
            ["bash", "-c", script, "browser", program, *flags],
            pass_fds=[to_read, back_write],
            stderr=subprocess.DEVNULL,
        )
        os.close(to_read)
        os.close(back_write)
        self.rest = b""
        self.number = 0
        self.events = []
        self.session = None
        made = self.call("Target.createTarget", url="about:blank")
        attached = self.call("Target.attachToTarget", targetId=made["targetId"], flatten=True)
        self.session = attached["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call(
            "Network.emulateNetworkConditions",
            offline=True,
            latency=0,
            downloadThroughput=-1,
            uploadThroughput=-1,
        )

    def call(self, method, **arguments):
        self.number += 1
        message = {"id": self.number, "method": method, "params": arguments}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.next()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def next(self):
        while b"\0" not in self.rest:
            got = os.read(self.back, 1 << 20)
            if not got:
                raise RuntimeError("the browser has ended")
            self.rest += got
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def run(self, script):
        """What a script gives, waited for."""
        found = self.call(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"]["exception"]["description"])
        return found["result"].get("value")

    def screen(self, width, height, deviceScaleFactor=1, mobile=False):
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=deviceScaleFactor,
            mobile=mobile,
        )
        self.call("Emulation.setTouchEmulationEnabled", enabled=mobile, maxTouchPoints=2)

    def open(self, page):
        self.events.clear()
        self.call("Page.navigate", url=page.resolve().as_uri())
        state = "document.documentElement.dataset.state"
        waiting = f"new Promise((done) => {{ const look = () => {state} ? done({state}) : setTimeout(look, 50); look(); }})"
        # A page that is being left answers, too.
        while self.run("location.href") != page.resolve().as_uri():
            pass
        return self.run(waiting)

    def settle(self):
        """Waits until what was asked for is on the screen."""
        self.run(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 400))))"
        )

    def picture(self):
        self.settle()
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def key(self, key, shift=False):
        text = key if len(key) == 1 else ""
        for kind in ("keyDown", "keyUp"):
            self.call(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                text=text if kind == "keyDown" else "",
                modifiers=8 if shift else 0,
            )

    def mouse(self, kind, x, y, button="left"):
        self.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=y,
            button=button,
            buttons={"left": 1, "right": 2}[button],
            clickCount=1,
        )

    def touch(self, kind, *points):
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def addresses(self):
        """What was asked of a network."""
        urls = [
            event["params"]["request"]["url"]
            for event in self.events
            if event.get("method") == "Network.requestWillBeSent"
        ]
        return [url for url in urls if not url.startswith(("file:", "data:", "blob:", "about:"))]

    def complaints(self):
        """Errors that the page has logged."""
        told = []
        for event in self.events:
            if event.get("method") == "Runtime.exceptionThrown":
                told.append(event["params"]["exceptionDetails"]["text"])
            elif event.get("method") == "Log.entryAdded":
                entry = event["params"]["entry"]
                if entry["level"] == "error":
                    told.append(entry["text"])
        return told

    def close(self):
        self.session = None
        self.call("Browser.close")
        self.process.wait()


def pixels(png):
    """Width, and the rows of a PNG of 8 bits a channel, as bytes a pixel."""
    at, packed = 8, b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at : at + 8])
        data = png[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, _, color = struct.unpack(">IIBB", data[:10])
            size = {2: 3, 6: 4}[color]
        elif kind == b"IDAT":
            packed += data
        at += 12 + length
    raw, rows = zlib.decompress(packed), []
    last = bytearray(width * size)
    for y in range(height):
        start = y * (width * size + 1)
        kind, row = raw[start], bytearray(raw[start + 1 : start + 1 + width * size])
        for x in range(len(row)):
            left = row[x - size] if x >= size else 0
            up = last[x]
            corner = last[x - size] if x >= size else 0
            if kind == 1:
                row[x] = row[x] + left & 255
            elif kind == 2:
                row[x] = row[x] + up & 255
            elif kind == 3:
                row[x] = row[x] + (left + up) // 2 & 255
            elif kind == 4:
                guess = left + up - corner
                apart = [abs(guess - left), abs(guess - up), abs(guess - corner)]
                row[x] = row[x] + [left, up, corner][apart.index(min(apart))] & 255
        rows.append([bytes(row[x : x + 3]) for x in range(0, len(row), size)])
        last = row
    return rows


def share_drawn(png, box):
    """The share of a box of a picture that is not its most frequent color, and how many colors."""
    left, top, right, bottom = box
    counts = {}
    for row in pixels(png)[top:bottom]:
        for color in row[left:right]:
            counts[color] = counts.get(color, 0) + 1
    total = sum(counts.values())
    return 1 - max(counts.values()) / total, len(counts)


def write_meshes(folder):
    """A wavy tube of 12,000 vertices round a ball of 8,000, in metres."""

    def grid(rows, columns, place):
        lines = []
        for row in range(rows):
            for column in range(columns):
                x, y, z = place(row / (rows - 1), 2 * math.pi * column / columns)
                lines.append(f"v {x:.5f} {y:.5f} {z:.5f}")
        for row in range(rows - 1):
            for column in range(columns):
                after = (column + 1) % columns
                a, b = row * columns + column + 1, row * columns + after + 1
                lines.append(f"f {a} {a + columns} {b + columns} {b}")
        return "\n".join(lines) + "\n"

    def tube(share, angle):
        radius = 0.3 + 0.1 * share + 0.02 * math.sin(9 * angle) * share
        return radius * math.sin(angle), 1.5 - 0.9 * share, radius * math.cos(angle)

    def ball(share, angle):
        radius, turn = 0.25, math.pi * share
        x, z = radius * math.sin(turn) * math.sin(angle), radius * math.sin(turn) * math.cos(angle)
        return x, 1.1 + 0.7 * math.cos(turn), z

    (folder / "tube.obj").write_text(grid(100, 120, tube))
    (folder / "straight.obj").write_text(grid(100, 120, lambda t, a: (0.3 * math.sin(a), 1.5 - 0.9 * t, 0.3 * math.cos(a))))
    (folder / "ball.obj").write_text(grid(80, 100, ball))


class Checks:
    def __init__(self):
        self.failed = 0

    def hold(self, is_met, text):
        print(f"{'ok  ' if is_met else 'FAIL'} {text}", flush=True)
        self.failed += not is_met


def check(browser, page, out, checks):
    browser.screen(WIDTH, HEIGHT)
    state = browser.open(page)
    checks.hold(state == "drawn", f"{page.name}: {page.stat().st_size / 1e6:.2f} MB, {state}")
    if state != "drawn":
        print(browser.run("document.getElementById('failure').textContent"), browser.complaints())
        return
    # As large as is asked for without what is round it.
    beside = browser.run("innerHeight - document.getElementById('stage').clientHeight")
    browser.screen(WIDTH, HEIGHT + beside)
    num_vertices = browser.run(SEEN)
    first = browser.picture()
    (out / f"{page.stem}-desktop.png").write_bytes(first)
    share, colors = share_drawn(first, (0, beside, WIDTH, HEIGHT + beside))
    checks.hold(share > 0.03 and colors > 200, f"drawn: {share:.1%} of the canvas, {colors} colors")
    browser.key("Tab")
    seen = first
    presses = [("ArrowLeft", False), ("ArrowUp", True), ("+", False), ("w", False)]
    is_there = "!document.getElementById('{}').hidden"
    presses += [("b", False), ("b", False)] if browser.run(is_there.format("body")) else []
    presses += [("c", False)] if browser.run("document.getElementById('coloring').length > 1") else []
    presses += [("o", False), ("o", False)] if browser.run(is_there.format("together")) else []
    presses += [(".", False)] if browser.run("document.getElementById('frame').max > 0") else []
    for key, shift in presses:
        browser.key(key, shift)
        now = browser.picture()
        checks.hold(now != seen, f"key {'shift + ' * shift}{key}")
        seen = now
    (out / f"{page.stem}-keys.png").write_bytes(seen)
    browser.key("w")
    browser.key("0")
    checks.hold(bool(browser.run("document.activeElement.matches(':focus-visible')")), "focus is seen")
    unnamed = browser.run(
        "[...document.querySelectorAll('button, select, input, canvas')].filter((element) => !element.closest('[hidden]') && !(element.textContent.trim() || element.ariaLabel || element.labels?.length)).length"
    )
    checks.hold(unnamed == 0, f"{unnamed} controls without a name")
    seen = browser.picture()
    browser.mouse("mousePressed", 400, 300)
    browser.mouse("mouseMoved", 460, 310)
    browser.mouse("mouseReleased", 460, 310)
    checks.hold(browser.picture() != seen, "a drag turns")
    rates = [browser.run(TURN % (1000 * SECONDS)) for _ in range(3)]
    rate = sorted(rates)[1]
    size = browser.run("['width', 'height'].map((side) => document.getElementById('stage')[side]).join(' x ')")
    renderer = browser.run("(() => { const gl = document.getElementById('stage').getContext('webgl2'); return gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info').UNMASKED_RENDERER_WEBGL); })()")
    checks.hold(
        rate >= LEAST_RATE or num_vertices > MOST_VERTICES,
        f"turns at {rate:.1f} frames a second (of {', '.join(f'{r:.1f}' for r in rates)}), {num_vertices} vertices, {size} pixels, {renderer}",
    )
    browser.screen(**PHONE)
    browser.run("location.reload()")
    browser.open(page)
    seen = browser.picture()
    (out / f"{page.stem}-phone.png").write_bytes(seen)
    scale = PHONE["deviceScaleFactor"]
    top = browser.run("document.getElementById('stage').getBoundingClientRect().top")
    box = (0, int(scale * top), scale * PHONE["width"], scale * PHONE["height"])
    share, colors = share_drawn(seen, box)
    checks.hold(share > 0.03 and colors > 200, f"phone: {share:.1%} of the canvas, {colors} colors")
    wide = browser.run("document.documentElement.scrollWidth - innerWidth")
    checks.hold(wide <= 0, f"phone: {wide} pixels too wide")
    for what, starts, ends in [
        ("one finger turns", [(200, 400)], [(240, 420)]),
        ("two fingers zoom", [(150, 400), (250, 400)], [(110, 400), (290, 420)]),
    ]:
        browser.touch("touchStart", *starts)
        browser.touch("touchMove", *ends)
        browser.touch("touchEnd")
        now = browser.picture()
        checks.hold(now != seen, f"phone: {what}")
        seen = now
    asked = browser.addresses()
    checks.hold(not asked, f"{len(asked)} addresses asked for {' '.join(asked)}")
    told = browser.complaints()
    checks.hold(not told, f"{len(told)} errors logged {' '.join(told)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    parser.add_argument("--garnet", help="the command that makes a page of 20,000 vertices")
    parser.add_argument("--chromium", default="chromium")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("."))
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        pages = list(arguments.pages)
        if not pages:
            if not arguments.garnet:
                parser.error("name a page, or the command with --garnet")
            write_meshes(folder)
            page = folder / "tube.html"
            view = [arguments.garnet, "view", "tube.obj", "ball.obj", "-o", page.name]
            view += ["--color-by", "stretch=straight.obj"]
            subprocess.run(view, cwd=folder, check=True)
            pages = [page]
        for page in pages:
            # A browser of its own, whose caches know no other page.
            browser = Browser(arguments.chromium, str(folder / f"profile-{page.stem}"))
            try:
                check(browser, page, arguments.output, checks)
            finally:
                browser.close()
    sys.exit(checks.failed > 0)


if __name__ == "__main__":
    main()
