"""The report and the page of a check in a browser: they draw, every control works by mouse and keyboard, nothing is logged as an error.

browser_test.py PALPATE SOURCE_FOLDER [PICTURES]; ends with 77 (skipped) where there is no Chromium. Screenshots at laptop
and phone widths go to PICTURES.
"""
import base64
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
if not chromium:
    print("skipped: there is no Chromium")
    sys.exit(77)

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
of_report, of_check = ((source / "tests/pipeline/output/html/page" / name).read_text() for name in ("browser_test.js", "check_page_test.js"))
failures = []


def palpate(*arguments):
    subprocess.run([program, *map(str, arguments), "-q"], check=True, stdout=subprocess.DEVNULL)


def browse(page, width, height, profile, *what):
    command = [chromium, "--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
               "--enable-logging=stderr", "--force-prefers-reduced-motion", f"--user-data-dir={profile}", f"--window-size={width},{height}",
               "--host-resolver-rules=MAP * ~NOTFOUND", *what, page.as_uri()]
    if os.geteuid() == 0:
        command.insert(1, "--no-sandbox")  # Chromium's sandbox does not start as root
    return subprocess.run(command, capture_output=True, text=True, timeout=240)


def check(report, scratch, name, test_script=of_report):
    size = report.stat().st_size
    if size > 5_000_000:
        failures.append(f"{name}: {size} bytes are more than 5 MB")
    tested = scratch / f"{name}.html"
    tested.write_text(report.read_text() + f"<script>{test_script}</script>")
    for width, height in ((1366, 900), (390, 844)):
        profile = scratch / f"profile-{name}-{width}"
        done = browse(tested, width, height, profile, "--virtual-time-budget=60000", "--dump-dom")
        title = re.search(r"<title>(.*?)</title>", done.stdout, re.S)
        verdict = title.group(1) if title else "no title"
        print(f"{name} at {width} px: {verdict}; {size} bytes")
        if verdict != "tested: fine":
            failures.append(f"{name} at {width} px: {verdict}")
        failures.extend(f"{name} at {width} px: {line}" for line in done.stderr.splitlines() if "CONSOLE" in line)
        if len(sys.argv) > 3:
            picture = pathlib.Path(sys.argv[3]) / f"{name}-{width}.png"
            browse(report.resolve(), width, 5200 if width > 1000 else 9000, profile, "--virtual-time-budget=4000", f"--screenshot={picture}")


def packed(kind, numbers):
    return {"type": kind, "data": base64.b64encode(struct.pack(f"<{len(numbers)}{'f' if kind == 'f32' else 'i'}", *numbers)).decode()}


def forces_alone(report, page):
    """A report as of a set in which a ball, a punch and a mesh were pressed in, a grip was moved, and their forces read,
    but no marker."""
    text = report.read_text()
    at, end = re.search(r'<script id="run-data" type="application/json">(.*?)</script>', text, re.S).span(1)
    data = json.loads(text[at:end])
    nothing = {"type": "f32", "data": ""}
    corners = [50, 10, 25, 45, 5, 35, 55, 5, 35, 50, 15, 35]
    plain = {"surface": None, "patch": None, "triangles_left_out": 0}
    data["tools"] = [{**plain, "name": "ball", "origin": [50, 10, 22]}, {**plain, "name": "punch", "origin": [80, 10, 19]},
                     {**plain, "name": "wedge", "origin": [50, 10, 30],
                      "surface": {"points": packed("f32", corners), "triangles": packed("i32", [0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3])}},
                     {**plain, "name": "grip", "origin": [5, 10, 10], "patch": {**data["surface"]["triangles"]}},
                     {**plain, "name": "scan", "origin": [0, 0, 0], "triangles_left_out": 90000}]
    still = {"turned": [0, 0, 0], "radius": None, "axis": None, "measured": None}
    for number, state in enumerate(data["states"]):
        force = [0, 0, -0.1 * number]
        state["loads"] = []
        state["tools"] = [{**still, "name": "ball", "at": [50, 10, 22], "moved": [0, 0, 0], "radius": 5, "measured": force},
                          {**still, "name": "punch", "at": [80, 10, 19], "moved": [0, 0, 0], "radius": 4, "axis": [0, 0, -1]},
                          {**still, "name": "wedge", "at": [50, 10, 30 - number], "moved": [0, 0, -number], "turned": [0, 0.1 * number, 0],
                           "measured": [0, 0, -0.2]},
                          {**still, "name": "grip", "at": None, "moved": [None, 1, 0], "measured": [None, 0.01, None]},
                          {**still, "name": "scan", "at": [0, 0, 0], "moved": [0, 0, 0]}]
        for step in data["steps"]:
            step["forces_rms"] = 0.02
            answer = step["states"][number]
            answer["markers"] = {"id": [], "coordinates": [], "rest": nothing, "measured": nothing, "error": nothing}
            answer["tool_forces"] = [{"name": "ball", "modelled": [0, 0, -0.09 * number]}]
    page.write_text(text[:at] + json.dumps(data).replace("<", "\\u003c") + text[end:])
    return page


with tempfile.TemporaryDirectory() as folder:
    at = pathlib.Path(folder)
    palpate("new", at / "case")
    palpate("run", at / "case/case.yaml", "-o", at / "run", "--probes", 6, "--spheres", 8, "--parameters", "links",
            "--particles", 40, "--edge-length", 8)
    check(at / "run/report.html", at, "simulated")
    if 'id="density-of"' not in (at / "run/report.html").read_text():
        failures.append("simulated: no number's density can be chosen")
    palpate("probe", at / "run/identify/model.json", "-o", at / "blind", "--hide", "gravity", "--probes", 5, "--markers", 25)
    palpate("run", at / "blind", "-o", at / "measured", "--parameters", "uniform", "--particles", 40, "--edge-length", 12)
    check(at / "measured/report.html", at, "measured")
    check(forces_alone(at / "measured/report.html", at / "forces.html"), at, "forces-alone")
    palpate("new", "--rig", "tensile", at / "tensile")  # with a grip
    palpate("check", at / "tensile", "-o", at / "check.html")
    check(at / "check.html", at, "check", of_check)
    palpate("run", at / "tensile", "-o", at / "gripped")
    check(at / "gripped/report.html", at, "gripped")

for failure in failures:
    print("FAILED", failure)
sys.exit(1 if failures else 0)
