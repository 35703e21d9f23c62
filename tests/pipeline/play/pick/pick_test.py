"""A body that is set up by mouse: what is clicked is what the files say, palpate reads them, and nothing is logged as an
error.

pick_test.py PALPATE SOURCE_FOLDER [PICTURES]: see browser.py.
"""
import csv
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from browser import Browser, end, expect, failures, palpate  # noqa: E402


def choose(browser, mode):
    browser.run(f"document.querySelector('input[value={mode}]').click();")


def place_of(browser, point):
    """Where the surface is seen nearest to a point, on the screen: the click and the point that it meets."""
    return browser.run("""
      const c = p.at('canvas'), b = c.getBoundingClientRect(), [x, y] = p.camera.project(%s, c.clientWidth, c.clientHeight);
      for (let r = 0; r < 80; r += 2) for (const [dx, dy] of [[0,0],[-r,0],[r,0],[0,-r],[0,r]]) {
        const hit = p.under(x + dx, y + dy);
        if (hit) return {at: pointIn(p.points, p.triangles, hit), x: x + dx + b.left, y: y + dy + b.top};
      }
      return null;""" % json.dumps(point))


def click(browser, point, to=(0, 0)):
    seen = place_of(browser, point)
    browser.mouse("mouseMoved", seen["x"], seen["y"], 0)
    browser.mouse("mousePressed", seen["x"], seen["y"])
    browser.mouse("mouseMoved", seen["x"] + to[0], seen["y"] + to[1])
    browser.mouse("mouseReleased", seen["x"] + to[0], seen["y"] + to[1], 0)
    return seen["at"]


def near(found, expected, within=1e-3):
    return len(found) == len(expected) and all(abs(a - b) <= within for a, b in zip(found, expected))


def texts(browser):
    return browser.run("return Object.fromEntries(p.setup.files().map((f) => "
                       "[f.name, typeof f.content === 'string' ? f.content : Array.from(new Uint8Array(f.content.buffer))]));")


def write_all(files, folder):
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else bytes(content))


def check_new_body(browser, body, scratch):
    """Supports, probes and markers on a bare mesh; the files are a case and a set that palpate reads."""
    palpate("play", body, "--pick", "-o", scratch / "pick.html")
    browser.open((scratch / "pick.html").as_uri(), 1366, 900)
    low, high = browser.run("return [p.setup.low, p.setup.high];")
    length = high[0] - low[0]
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    expect("Nothing is chosen" in browser.run("return p.at('warnings').textContent;"), "nothing is said of no support")

    choose(browser, "end")
    at = click(browser, [low[0] + 0.06 * length, low[1], middle[2]])
    box = browser.run("return p.setup.supports[0].box;")
    expect(near([box["max"][0]], [max(at[0], low[0] + 0.05 * length)]), f"a click at {at} holds the end up to {box['max'][0]}")
    expect(box["min"][0] < low[0] and all(box["min"][c] < low[c] and box["max"][c] > high[c] for c in (1, 2)),
           f"the end is held by {box}")

    choose(browser, "ball")
    centre = click(browser, [high[0] - 0.2 * length, low[1], middle[2]], to=(40, 0))
    ball = browser.run("return p.setup.supports[1].sphere;")
    reach = browser.run("""const c = p.at('canvas'), [x, y] = p.camera.project(%s, c.clientWidth, c.clientHeight);
      const {from, along} = rayAt(p.camera, x + 40, y, c.clientWidth, c.clientHeight), hit = p.under(x, y);
      return length3(minus3(plus3(from, along, hit.t), %s));""" % (json.dumps(centre), json.dumps(centre)))
    expect(near(ball["center"], centre) and abs(ball["radius"] - reach) < 0.01 * reach, f"a ball drawn to {reach} mm is {ball}")
    browser.run("p.at('undo').click();")
    expect(browser.run("return p.setup.supports.length;") == 1, "undo leaves the ball")

    choose(browser, "probe")
    browser.run("p.at('direction').value = '2,-1'; p.at('force').value = 0.3; p.at('levels').value = 2; p.at('probe-radius').value = 2;")
    pressed = click(browser, [high[0] - 0.1 * length, middle[1], high[2]])
    choose(browser, "marker")
    read = click(browser, [high[0] - 0.3 * length, middle[1], high[2]])
    browser.run("p.at('count').value = 5; p.at('spread').click();")
    browser.run("p.at('canvas').focus();")
    for key in ("n", "n", "Enter"):
        browser.key(key)
    expect(browser.run("return p.setup.markers.length;") == 7, "a click, five that are spread and one by keys are not 7 markers")
    browser.picture("pick")

    files = texts(browser)
    write_all(files, scratch / "set")
    probes = list(csv.DictReader((scratch / "set/probes.csv").open()))
    expect([row["probe"] for row in probes] == ["0", "1", "2"], f"probes.csv holds {probes}")
    expect(near([float(probes[1][c]) for c in ("x", "y", "z", "fx", "fy", "fz", "radius")], [*pressed, 0, 0, -0.15, 2]) and
           float(probes[2]["fz"]) == -0.3, f"probes.csv holds {probes}")
    markers = list(csv.DictReader((scratch / "set/markers.csv").open()))
    expect(near([float(markers[0][c]) for c in "xyz"], read), f"a marker at {read} is written as {markers[0]}")
    expect(all(float(m["x"]) > box["max"][0] for m in markers[1:6]), "markers are spread over what is held")
    positions = list(csv.DictReader((scratch / "set/positions.csv").open()))
    expect(len(positions) == 3 * 7, f"positions.csv has {len(positions)} rows for 3 states of 7 markers")

    # as a set, filled in; and as a case, beside the mesh
    rest = {m["marker"]: m for m in markers}
    with (scratch / "set/positions.csv").open("w") as table:
        table.write("probe,time,marker,x,y,z\n")
        for row in positions:
            m = rest[row["marker"]]
            table.write(f"{row['probe']},0,{row['marker']},{m['x']},{m['y']},{float(m['z']) - 0.5 * float(row['probe'])}\n")
    told = json.loads(palpate("check", scratch / "set", "--json"))
    expect(told["set"]["markers"] == 7 and told["set"]["states"] == 3 and not told["warnings"], f"check says {told['set']}, {told['warnings']}")
    share = browser.run("return p.setup.heldShare();")
    area = browser.run("""let sum = 0; for (let t = 0; t < p.triangles.length; t += 3) { const [a, b, c] = [0, 1, 2].map((k) => row3(p.points, p.triangles[t + k]));
      sum += length3(cross3(minus3(b, a), minus3(c, a))) / 2; } return sum;""")
    held = told["supports"][0]["area_mm2"]
    print(f"held: {share * area:.4g} mm^2 by the page, {held:.4g} by check")
    expect(abs(share * area - held) < 0.1 * held, f"{share * area} mm^2 are held by the page, {held} by check")
    (scratch / "picked").mkdir()
    (scratch / "picked" / body.name).write_bytes(body.read_bytes())
    (scratch / "picked/case.yaml").write_text(files["case.yaml"])
    told = json.loads(palpate("check", scratch / "picked/case.yaml", "--json"))
    expect(len(told["supports"]) == 1 and not told["warnings"], f"check of the case says {told['supports']}, {told['warnings']}")

    browser.run("p.setup.supports[0].box.max[0] = 1e6; p.changed();")
    warned = browser.run("return p.at('warnings').textContent;")
    expect("100 % of the surface" in warned and "Probe 1 presses on what is held" in warned, f"of a body held whole it says {warned}")


def check_set(browser, folder, scratch):
    """On a set, what is there stays: the page hands out what to add."""
    palpate("play", folder, "--pick", "-o", scratch / "more.html")
    browser.open((scratch / "more.html").as_uri(), 1366, 900)
    browser.run("document.querySelector('input[value=marker]').click(); p.at('count').value = 2; p.at('spread').click();")
    browser.picture("pick-set")
    files = texts(browser)
    expect(list(files) == ["supports.yaml", "probes.csv", "markers.csv"], f"of a set it hands out {list(files)}")
    expect(files["supports.yaml"].startswith("supports:\n  - box:"), f"its supports are told as {files['supports.yaml']}")
    names = {row["marker"] for row in csv.DictReader((folder / "markers.csv").open())}
    added = [line.split(",")[0] for line in files["markers.csv"].splitlines()]
    expect(len(added) == 2 and not names & set(added), f"markers {added} are added to {len(names)}")


with tempfile.TemporaryDirectory() as folder:
    at = pathlib.Path(folder)
    palpate("new", at / "case")
    body = at / "case/body.stl"
    palpate("probe", at / "case/case.yaml", "-o", at / "measured", "--probes", 3, "--edge-length", 10)
    browser = Browser(at / "profile", "picker")
    try:
        check_new_body(browser, body, at)
        check_set(browser, at / "measured", at)
        browser.call("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=True)
        width = browser.run("return document.documentElement.scrollWidth;")
        expect(width <= 390, f"the page is {width} px wide in 390")
        browser.picture("pick-phone")
        unnamed = browser.unnamed_controls()
        expect(not unnamed, f"controls without a name: {unnamed}")
        failures.extend(f"the console says {error}" for error in browser.errors())
    finally:
        browser.close()

end()
