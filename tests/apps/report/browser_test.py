#!/usr/bin/env python3
"""Opens reports in headless Chromium and clicks through them: browser_test.py DRIVER BROWSER PAGE.html... [--screenshots DIR]

Fails (1) where a page logs an error, asks for anything from anywhere, shows an empty view or panel; is skipped (77) where
the browser itself cannot be had: that says nothing about the page. Waiting ends when the page says that it is done, not
after a time.
"""
import base64
import json
import pathlib
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

SKIPPED = 77
PATIENCE_S = 240  # after which the browser is given up, not the page


class NoBrowser(Exception):
    """The browser or its driver is not to be had, or does not answer."""


class Driver:
    """A WebDriver session, in plain HTTP."""

    def __init__(self, driver, browser, flags):
        self.folder = tempfile.TemporaryDirectory()
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.base = f"http://127.0.0.1:{port}"
        try:
            self.process = subprocess.Popen([driver, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        except OSError as error:
            raise NoBrowser(error) from error
        arguments = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--window-size=1200,900", f"--user-data-dir={self.folder.name}"] + flags
        capabilities = {"browserName": "chrome", "goog:chromeOptions": {"binary": browser, "args": arguments},
                        "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        begin = time.monotonic()
        while True:
            try:
                self.session = "/session/" + self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})["sessionId"]
                break
            except NoBrowser:
                if self.process.poll() is not None or time.monotonic() - begin > PATIENCE_S:
                    raise
                time.sleep(0.2)
        self.call("POST", self.session + "/timeouts", {"script": 1000 * PATIENCE_S, "pageLoad": 1000 * PATIENCE_S})

    def call(self, method, path, body=None):
        request = urllib.request.Request(self.base + path, method=method, data=None if body is None else json.dumps(body).encode(),
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=2 * PATIENCE_S) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise NoBrowser(error.read().decode(errors="replace")[:500]) from error
        except (OSError, ValueError) as error:
            raise NoBrowser(error) from error

    def open(self, page):
        self.call("POST", self.session + "/url", {"url": page.resolve().as_uri()})

    def run(self, script, *arguments):
        """The value that the body of an async function returns, {error} where it throws."""
        text = ("const done = arguments[arguments.length - 1], given = Array.from(arguments).slice(0, -1);"
                f"(async (...a) => {{ {script} }})(...given).then((value) => done({{value}}), (error) => done({{error: String(error)}}));")
        return self.call("POST", self.session + "/execute/async", {"script": text, "args": list(arguments)})

    def log(self, kind):
        return self.call("POST", self.session + "/se/log", {"type": kind})

    def screenshot(self, file):
        file.write_bytes(base64.b64decode(self.call("GET", self.session + "/screenshot")))

    def close(self):
        try:
            self.call("DELETE", self.session)
        except (NoBrowser, AttributeError):
            pass
        self.process.terminate()
        self.process.wait()
        self.folder.cleanup()


WAIT = """
while (!['ready', 'failed'].includes(document.body.dataset.state)) await new Promise((go) => setTimeout(go, 50));
return document.body.dataset.state;
"""

# Every control of the page once, and what is then wrong.
CLICK = """
const faults = [], wait = (ms) => new Promise((go) => setTimeout(go, ms));
const expect = (what, holds) => { if (!holds) faults.push(what); };
const sections = Array.from(document.querySelectorAll('#app section'));
if (sections.length === 0) {  // a page of tables and plots
  expect('plots', document.querySelectorAll('#app path.line').length > 0);
  for (const path of document.querySelectorAll('path.line')) expect('a line', /^M[-0-9]/.test(path.getAttribute('d')) && !/NaN/.test(path.getAttribute('d')));
  return faults;
}
expect('sections', sections.length >= 5);
for (const s of sections) expect('an empty section: ' + s.id, s.children.length > 1);
expect('a verdict', document.querySelector('.verdict strong').textContent.length > 5);
for (const box of document.querySelectorAll('input[type=checkbox]')) { box.click(); box.click(); }
for (const button of document.querySelectorAll('th button')) { button.click(); button.click(); }
for (const details of document.querySelectorAll('details')) details.open = true;
for (const select of document.querySelectorAll('section:not(#in-three-dimensions) select'))
  for (const option of select.options) { select.value = option.value; select.dispatchEvent(new Event('change')); }
for (const svg of document.querySelectorAll('svg[tabindex]')) {
  const box = svg.getBoundingClientRect();
  svg.dispatchEvent(new MouseEvent('mousemove', {clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true}));
  for (const key of ['+', 'ArrowRight', '-', 'Escape']) svg.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
}
for (const path of document.querySelectorAll('path.line')) expect('a line without points', !/NaN/.test(path.getAttribute('d') || ''));
const sorted = (column) => Array.from(document.querySelectorAll('#closures tbody tr')).map((r) => r.cells[column].textContent);
const inliers = Array.from(document.querySelectorAll('#closures th')).findIndex((h) => h.textContent === 'inliers');
if (inliers > 0) {
  document.querySelectorAll('#closures th button')[inliers].click();
  const values = sorted(inliers).map(Number);
  expect('sorted by inliers', values.every((v, i) => i === 0 || values[i - 1] <= v) || values.every((v, i) => i === 0 || values[i - 1] >= v));
}
const canvas = document.querySelector('.stage.view canvas');
if (canvas) {
  const ink = () => {
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const pen = copy.getContext('2d');
    pen.drawImage(canvas, 0, 0);
    const colours = new Set(), data = pen.getImageData(0, 0, copy.width, copy.height).data;
    for (let i = 0; i < data.length; i += 16) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return colours.size;
  };
  const frame = () => new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)));
  await frame();
  expect('pixels in the view', ink() > 20);
  canvas.focus();
  const select = Array.from(document.querySelectorAll('#in-three-dimensions label')).find((l) => l.textContent.startsWith('colour')).querySelector('select');
  for (const key of ['t', 'b', 'm', 'm', 'b', '0', 'ArrowLeft', 'ArrowUp', '+', '-', ...Array.from(select.options, () => 'c')]) {
    canvas.dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true}));
    await frame();
    if (key === 'c') expect('pixels coloured by ' + select.value, ink() > 5);
  }
  const readout = document.querySelector('#in-three-dimensions .readout');
  const box = canvas.getBoundingClientRect();
  let picked = false;
  for (let y = 0.3; y < 0.8 && !picked; y += 0.05) for (let x = 0.2; x < 0.8 && !picked; x += 0.05) {
    for (const type of ['pointerdown', 'pointerup']) canvas.dispatchEvent(new PointerEvent(type, {clientX: box.left + x * box.width, clientY: box.top + y * box.height, bubbles: true}));
    picked = /^x /.test(readout.textContent);
  }
  expect('a point can be picked', picked);
} else expect('a picture in place of the view', document.querySelector('.stage.view img'));
for (const button of Array.from(document.querySelectorAll('#closures td button')).slice(0, 3)) {
  button.click();
  const detail = document.querySelector('#closures .detail');
  const before = performance.now();
  while (!detail.dataset.open && performance.now() - before < 60000) await wait(20);
  expect('a closure opens', detail.children.length > 2);
  delete detail.dataset.open;
}
for (const node of document.querySelectorAll('button, input, select'))
  expect('a control without a name', (node.textContent || '').trim() || (node.closest('label') || {textContent: ''}).textContent.trim() || node.getAttribute('aria-label'));
return faults;
"""


def check(driver, page, faults, screenshots):
    driver.log("browser")
    driver.log("performance")
    driver.open(page)
    state = driver.run(WAIT).get("value")
    if state != "ready":
        faults.append(f"{page.name}: the page says '{state}'")
    shots = pathlib.Path(screenshots) if screenshots else None
    stem = page.resolve().parent.name if page.stem == "report" else page.stem
    if shots:
        driver.screenshot(shots / f"{stem}_top.png")
    clicked = driver.run(CLICK)
    for fault in [clicked["error"]] if "error" in clicked else clicked["value"]:
        faults.append(f"{page.name}: {fault}")
    if shots:
        for name in driver.run("return Array.from(document.querySelectorAll('#app section'), (s) => s.id)")["value"]:
            driver.run("document.getElementById(a[0]).scrollIntoView(); await new Promise((go) => setTimeout(go, 300));", name)
            driver.screenshot(shots / f"{stem}_{name}.png")
    for entry in driver.log("browser"):
        if entry["level"] in ("SEVERE", "WARNING"):
            faults.append(f"{page.name}: console: {entry['message']}")
    own = page.resolve().as_uri()
    for entry in driver.log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] != "Network.requestWillBeSent" or not message["params"]["documentURL"].startswith(own):
            continue  # the browser's own pages
        url = message["params"]["request"]["url"]
        if not url.startswith((own, "data:", "blob:")):
            faults.append(f"{page.name}: asks for {url}")


def main(arguments):
    screenshots = None
    if "--screenshots" in arguments:
        at = arguments.index("--screenshots")
        screenshots = arguments[at + 1]
        del arguments[at:at + 2]
    driver_binary, browser, *pages = arguments
    faults = []
    for flags in ([], ["--disable-3d-apis"]):  # with and without WebGL
        driver = None
        try:
            driver = Driver(driver_binary, browser, flags)
            for page in map(pathlib.Path, pages):
                check(driver, page, faults, screenshots if not flags else None)
        except NoBrowser as error:
            print(f"skipped: no browser: {error}")
            if not faults:
                return SKIPPED
        finally:
            if driver:
                driver.close()
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
