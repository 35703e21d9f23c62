"""The model in the hand, in a browser: a drag by the mouse, forces that balance, the shape that `palpate simulate` finds,
switches that change the error as the ladder says, keys, links, phones; and nothing is logged as an error.

play_test.py PALPATE SOURCE_FOLDER [PICTURES]: see browser.py.
"""
import base64
import json
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from browser import Browser, end, expect, failures, palpate, program  # noqa: E402


class PlayerBrowser(Browser):
    """A page that plays a model."""

    def open(self, address, width, height, mobile=False):
        super().open(address, width, height, mobile)
        self.still()

    def still(self):
        """Waits until the body stands still."""
        self.run("p.wake();")
        self.wait("!p.moving")


def displacement_in(file):
    """The array "displacement [mm]" of a .vtp: in base64, zipped in blocks."""
    text = re.search(r'Name="displacement \[mm\]"[^>]*>\s*([A-Za-z0-9+/=]+)', file.read_text()).group(1)
    blocks = struct.unpack("<I", base64.b64decode(text[:8])[:4])[0]
    header_length = (4 * (3 + blocks) + 2) // 3 * 4
    sizes = struct.unpack(f"<{3 + blocks}I", base64.b64decode(text[:header_length])[:4 * (3 + blocks)])[3:]
    packed = base64.b64decode(text[header_length:header_length + (sum(sizes) + 2) // 3 * 4])
    raw, at = b"", 0
    for size in sizes:
        raw += zlib.decompress(packed[at:at + size])
        at += size
    return struct.unpack(f"<{len(raw) // 8}d", raw)


def open_hand(browser):
    """A point of the body that stands free, on the screen."""
    browser.still()
    return browser.run("""
      const c = p.at('canvas'), v = p.points[0], s = row3(p.skin ?? p.rest, v);
      const towards = s.map((x, i) => x + 0.06 * (p.camera.target[i] - x));
      const [x, y] = p.camera.project(towards, c.clientWidth, c.clientHeight), b = c.getBoundingClientRect();
      for (let r = 0; r < 60; r += 4) for (const [dx, dy] of [[0,0],[-r,0],[r,0],[0,-r],[0,r]])
        if (p.under(x + dx, y + dy)) return [x + dx + b.left, y + dy + b.top];
      return null;""")


def drag(browser, name, by):
    """Pulls at the body by the mouse and leaves it held, at rest."""
    place = open_hand(browser)
    if place is None:
        raise RuntimeError(f"{name}: no free point is in sight")
    x, y = place
    browser.picture(f"{name}-before")
    browser.mouse("mouseMoved", x, y, 0)
    browser.mouse("mousePressed", x, y)
    for i in range(1, 13):
        browser.mouse("mouseMoved", x + by[0] * i / 12, y + by[1] * i / 12)
        browser.frame()
    browser.still()
    browser.picture(f"{name}-during")
    return x + by[0], y + by[1]


def shape_as_simulated(browser, model, scratch):
    """Largest distance of the shape in the page from what `palpate simulate` finds under the same forces [mm]."""
    table, shape, rest = browser.run("""
      p.numerics.equilibrium();
      return [p.probesTable(), Array.from(p.numerics.shape()), Array.from(p.data.models[p.chosen.model].text.skin.vertices.flat())];""")
    (scratch / "probes.csv").write_text(table)
    palpate("simulate", model, "--probes", scratch / "probes.csv", "-o", scratch / "simulated", "--draws", 0, "--force")
    simulated = displacement_in(scratch / "simulated/simulation_000.vtp")
    expect(len(simulated) == len(shape), "the simulated skin has another number of vertices")
    worst = max(abs(r + u - x) for r, u, x in zip(rest, simulated, shape))
    moved = max(abs(a - b) for a, b in zip(shape, rest))
    return worst, moved


def wait_for_verdict(browser):
    browser.wait("p.verdict.whole || p.verdict.trouble")
    return browser.run("return {rms: p.verdict.rms, all: p.verdict.allRms, heldOut: p.verdict.heldOutRms, trouble: p.verdict.trouble};")


def check_model(browser, run, page, scratch):
    """Drags the result of a run and compares with simulate; then keys and a link."""
    model = run / "improve/model.json"
    browser.open(page.as_uri(), 1366, 900)
    # the body as its model alone has it, without what the set knows to act
    browser.run("p.chooseProbe(-1);")
    end = drag(browser, "drag", (0, 120))
    told = browser.run("return {...p.feel(), quiet: p.quiet, force: p.at('force').textContent, stiffness: p.at('stiffness').textContent};")
    print(f"held: {told['force']}, {told['stiffness']} felt")
    expect(told["strength"] > 0 and told["force"].endswith(" N"), "no force is told of a drag")
    expect(told["stiffness"].endswith("N/mm") and not told["stiffness"].startswith("–"), "no stiffness is told")

    # the forces balance: what the spring pulls is what the body resists, and the shape is simulate's
    balance = browser.run("""
      p.numerics.equilibrium();
      const {force, place} = p.numerics.at(p.hand.touch), spring = times3(minus3(p.hand.target, place), p.hand.spring);
      return length3(minus3(force, spring)) / length3(force);""")
    expect(balance < 1e-9, f"the force differs from the spring's by {balance:.1e} of it")
    worst, moved = shape_as_simulated(browser, model, scratch)
    print(f"dragged by {moved:.3g} mm: {worst:.1e} mm from `palpate simulate`")
    expect(moved > 1, f"the drag moves the body by {moved:.3g} mm only")
    expect(worst <= 1e-6, f"the shape is {worst:.1e} mm from what simulate finds")

    # the stiffness is what a little more force tells
    felt, found = browser.run("""
      const n = unit3(p.numerics.at(p.hand.touch).force), {force, place} = p.numerics.at(p.hand.touch);
      const felt = p.feel().stiffness, more = 1e-4 * length3(force);
      p.numerics.push(p.hand.touch, plus3(force, n, more)); p.numerics.equilibrium();
      const further = dot3(n, minus3(p.numerics.at(p.hand.touch).place, place));
      p.numerics.drag(p.hand.touch, p.hand.target, p.hand.spring);
      return [felt, more / further];""")
    print(f"stiffness: {felt:.6g} N/mm told, {found:.6g} by a little more force")
    expect(abs(felt - found) < 0.01 * found, f"the stiffness told is {felt} N/mm, but {found} is felt")
    browser.mouse("mouseReleased", *end)
    browser.still()
    browser.picture("drag-after")
    expect(browser.run("return p.touches.length") == 0, "something is held after the drag")

    # by keys alone
    browser.run("p.at('canvas').focus();")
    for key in ("n", "Enter", "ArrowDown", "ArrowDown", "ArrowDown", "PageDown"):
        browser.key(key)
    browser.still()
    strength = browser.run("return p.feel()?.strength ?? 0;")
    expect(strength > 1e-6, "keys do not pull")
    browser.wait("p.at('spoken').textContent.includes('newton')")
    link = browser.run("return p.link();")
    browser.key("Escape")
    expect(browser.run("return p.touches.length") == 0, "Escape does not let go")

    # the link holds what was seen
    before = browser.run("return [p.camera.distance];")
    browser.open(page.as_uri() + link, 1366, 900)
    after = browser.run("p.settle(); return [p.camera.distance, p.numerics.at(p.hand.touch).force];")
    expect(abs(before[0] - after[0]) < 1e-3 * before[0], "the link loses the view")
    expect(abs(sum(f * f for f in after[1]) ** 0.5 - strength) < 0.05 * strength + 1e-9, "the link loses the pull")
    unnamed = browser.unnamed_controls()
    expect(not unnamed, f"controls without a name: {unnamed}")


def check_ball(browser, page):
    """A ball that comes up to a point by keys and goes on inwards pushes the skin before it; lifted, it lets it go."""
    browser.open(page.as_uri(), 1366, 900)
    browser.run("p.chooseProbe(-1); p.settle(); p.at('with').value = 'ball'; p.choosePoint(0); p.at('canvas').focus();")
    browser.key("Enter")
    pressed = browser.run("""
      p.frame = () => {};
      const {from, normal, ball} = p.hand;
      p.pull(plus3(from, normal, -0.5 * ball.radius));
      for (let i = 0; i < 60; ++i) p.step();
      const skin = p.numerics.skin();
      let within = 0;
      for (let v = 0; v < skin.length / 3; ++v)
        within = Math.max(within, ball.radius - length3(minus3(row3(skin, v), ball.at)));
      p.draw();
      return {...p.feel(), within: within / ball.radius, along: dot3(unit3(p.numerics.ballForce()), normal)};""")
    browser.picture("ball")
    print("ball: {strength:.3g} N at {moved:.3g} mm, {within:.1e} of its radius within the skin".format(**pressed))
    expect(pressed["strength"] > 0 and pressed["along"] < -0.5, f"the ball presses with {pressed}")
    expect(pressed["within"] < 0.05, f"the ball goes into the skin by {pressed['within']} of its radius")
    lifted = browser.run("""
      const before = p.numerics.shape();
      p.letAllGo(); p.settle();
      return [p.ball, length3(p.numerics.ballForce()), Math.max(...p.numerics.shape().map((x, i) => Math.abs(x - before[i])))];""")
    expect(lifted[0] is None and lifted[1] == 0 and lifted[2] > 0.1, f"the ball that is lifted leaves {lifted}")


def check_ladder(browser, run, page):
    """Each step's error is what ladder.json says, and a switch moves the body and the error."""
    ladder = json.loads((run / "improve/ladder.json").read_text())
    browser.open(page.as_uri(), 1366, 900)
    names = browser.run("return p.data.models.map((m) => m.name);")
    expect(len(names) == len(ladder["steps"]) + 1, f"the page has models {names}")
    for i, step in enumerate(ladder["steps"]):
        browser.run(f"p.chooseModel({i});")
        verdict = wait_for_verdict(browser)
        print(f"step {i}: {verdict['rms']:.6g} mm rms, {step['rms_mm']:.6g} by ladder.json")
        expect(abs(verdict["rms"] - step["rms_mm"]) < 1e-5 * step["rms_mm"] + 1e-6,
               f"step {i} comes to {verdict['rms']} mm, not {step['rms_mm']}")
        if verdict["heldOut"]:
            expect(abs(verdict["heldOut"] - step["held_out_rms_mm"]) < 1e-5 * step["held_out_rms_mm"] + 1e-6,
                   f"step {i} comes to {verdict['heldOut']} mm held out, not {step['held_out_rms_mm']}")

    # the result, with gravity and without: the body rises, and the error with it
    browser.run(f"p.chooseModel({len(names) - 1}); p.chooseProbe(-1);")
    whole = wait_for_verdict(browser)
    height = "p.settle(); const s = p.numerics.shape(); let z = 0; for (let i = 2; i < s.length; i += 3) z += s[i]; return 3 * z / s.length;"
    hangs = browser.run(height)
    expect(browser.run("return p.findings.map((f) => f.kind);") == ["arrow"], "gravity is not drawn")
    browser.run("p.at('effect-gravity').click();")
    expect(browser.run("return p.findings;") == [], "gravity is drawn where it is switched off")
    rises = browser.run(height)
    without = wait_for_verdict(browser)
    print(f"gravity off: the mean height goes from {hangs:.3g} to {rises:.3g} mm, the error from {whole['all']:.3g} to {without['all']:.3g} mm")
    expect(rises > hangs + 0.1, "the body does not rise without gravity")
    expect(without["rms"] > 2 * whole["rms"], "the error does not rise without gravity")
    loaded = browser.run("return p.data.sets[p.set].states.findIndex((s) => s.readings.length && s.contacts.some((c) => c[5] !== 0));")
    browser.run(f"p.chooseProbe({loaded}); p.at('colour').value = 'error';")
    browser.still()
    expect("rms" in browser.run("return p.at('told').textContent;"), "the error of a probe is not told")
    browser.picture("probe-without-gravity")
    browser.run("p.at('effect-gravity').click();")
    browser.still()
    browser.picture("probe-with-gravity")
    worst = browser.run("p.settle(); return p.markerErrors().rms;")
    expect(worst < 0.5, f"a replayed probe is {worst} mm off")


def check_creep(browser, run, page):
    """A replayed state has crept until it was read; what the hand does creeps as one looks on."""
    ladder = json.loads((run / "improve/ladder.json").read_text())
    expect(ladder["steps"][-1]["effects"] == ["viscosity"], f"the ladder adds {ladder['steps'][-1]['effects']}")
    browser.open(page.as_uri(), 1366, 900)
    steps = len(ladder["steps"])
    browser.run(f"p.chooseModel({steps - 1});")
    verdict, told = wait_for_verdict(browser), ladder["steps"][-1]["rms_mm"]
    print(f"with viscosity: {verdict['rms']:.6g} mm rms, {told:.6g} by ladder.json")
    expect(abs(verdict["rms"] - told) < 1e-5 * told + 1e-6, f"with viscosity it comes to {verdict['rms']} mm, not {told}")
    late = browser.run("""const {states} = p.data.sets[p.set];
      return states.reduce((last, s, i) => s.contacts.some((c) => c[5] !== 0) && s.time > (states[last]?.time ?? 0) ? i : last, -1);""")
    crept = browser.run(f"p.chooseProbe({late}); p.settle(); return p.markerErrors().rms;")
    at_once = browser.run("p.at('effect-viscosity').click(); p.settle(); return p.markerErrors().rms;")
    print(f"a state held for long: {crept:.3g} mm off, {at_once:.3g} mm without viscosity")
    expect(at_once > 2 * crept, f"viscosity takes the error of a state from {at_once} to {crept} mm only")
    before, after, back = browser.run("""
      p.at('effect-viscosity').click(); p.chooseProbe(-1); p.frame = () => {};
      const {contacts} = p.data.sets[p.set].states[%d], [x, y, z, ...force] = contacts.find((c) => c[5] !== 0);
      p.press([x, y, z], [0, 0, 1], force.slice(0, 3), 0);
      const touch = p.hand.touch, rest = p.numerics.at(touch).place;
      const away = () => length3(minus3(p.numerics.at(touch).place, rest));
      p.settle(); const before = away();
      for (let i = 0; i < 600; ++i) p.numerics.advance(0.1);
      p.settle(); const after = away();
      p.numerics.push(touch, [0, 0, 0]); p.settle();
      return [before, after, away()];""" % late)
    print(f"the hand's push: {before:.3g} mm at once, {after:.3g} mm in a minute, {back:.3g} mm when it is taken away")
    expect(after > 1.1 * before and 0 < back < after - 0.9 * before, "a push does not creep, or leaves nothing behind")


def check_actuators(browser, page):
    """A slider bends the body as far as a probe's setting does, which the probe's markers show; and back."""
    browser.open(page.as_uri(), 1366, 900)
    rest = browser.run("return Array.from(p.numerics.shape());")
    bent = browser.run("""
      const slider = p.at('drive-0');
      slider.value = 0.4 * slider.max; slider.dispatchEvent(new Event('input'));
      const asked = +slider.value;
      p.settle(); p.tell(0);
      return {shape: Array.from(p.numerics.shape()), told: p.at('driven-0').textContent, asked, driven: p.driven[0]};""")
    moved = max(abs(a - b) for a, b in zip(bent["shape"], rest))
    browser.picture("actuator")
    print(f"tendon: {bent['told']} moves the body by {moved:.3g} mm")
    expect(moved > 1 and bent["driven"] == bent["asked"] > 0,
           f"set to {bent['asked']} N, the tendon pulls by {bent['driven']} N and moves the body by {moved} mm")
    link = browser.run("return p.link();")
    largest = browser.run("""
      const {states} = p.data.sets[p.set];
      return states.reduce((best, s, i) => (s.settings?.[0]?.[1] ?? 0) > (states[best].settings?.[0]?.[1] ?? 0) ? i : best, 0);""")
    set_to, asked, told = browser.run(f"""
      p.chooseProbe({largest}); p.settle(); p.tell(0);
      return [p.state.settings[0][1], p.driven[0], p.at('told').textContent];""")
    expect(asked == set_to, f"the probe sets the tendon to {set_to} N, but the body is driven by {asked} N")
    expect("rms" in told, "the error of a driven probe is not told")
    browser.picture("actuated-probe")
    back = browser.run("p.chooseProbe(-1); p.settle(); return Array.from(p.numerics.shape());")
    expect(max(abs(a - b) for a, b in zip(back, rest)) < 1e-6, "the body does not come back")
    browser.open(page.as_uri() + link, 1366, 900)
    again = browser.run("return Array.from(p.numerics.shape());")
    expect(max(abs(a - b) for a, b in zip(again, bent["shape"])) < 0.01 * moved, "the link loses the actuators")
    unnamed = browser.unnamed_controls()
    expect(not unnamed, f"controls without a name: {unnamed}")


def check_phone(browser, page):
    browser.open(page.as_uri(), 390, 844, mobile=True)
    wait_for_verdict(browser)
    width = browser.run("return document.documentElement.scrollWidth;")
    expect(width <= 390, f"the page is {width} px wide in 390")
    browser.picture("phone")
    check_fingers(browser)


def check_fingers(browser):
    """One finger pulls at the body, two beside it come closer."""
    browser.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
    x, y = open_hand(browser)
    browser.touch("touchStart", (x, y))
    for i in range(1, 9):
        browser.touch("touchMove", (x - 4 * i, y + 5 * i))
    browser.wait("p.hand && length3(p.numerics.at(p.hand.touch).force) > 0")
    expect(browser.run("return [...document.querySelectorAll('#readout b')].every((b) => b.scrollWidth <= b.clientWidth);"),
           "a number does not fit its frame")
    browser.picture("phone-pulled")
    browser.touch("touchEnd")
    expect(browser.run("return p.hand === null;"), "the body stays held when the finger is lifted")
    before = browser.run("return p.camera.distance;")
    left, top, width = browser.run("const b = p.at('canvas').getBoundingClientRect(); return [b.left, b.top, b.width];")
    for i in range(9):
        fingers = (left + 15 + 2 * i, top + 60), (left + width - 15 - 2 * i, top + 60)
        browser.touch("touchStart" if i == 0 else "touchMove", *fingers)
    browser.touch("touchEnd")
    after = browser.run("return p.camera.distance;")
    expect(after > 1.02 * before, f"two fingers that come closer take the eye from {before} to {after} mm")
    browser.call("Emulation.setTouchEmulationEnabled", enabled=False)


def tell_time(browser, page):
    """A step of the module, with the skin as it is shown [ms]."""
    browser.open(page.as_uri(), 1366, 900)
    told = browser.run("""
      p.frame = () => {};
      p.take(row3(p.rest, p.points[0]), [0, 0, 1]);
      const {place} = p.numerics.at(p.hand.touch), steps = 120, begin = performance.now();
      for (let i = 0; i < steps; ++i) {
        p.pull(plus3(place, [0, 0, 0.03 * p.size * Math.sin(i / 15)]));
        p.numerics.advance(frameTime); p.numerics.skin();
      }
      return [p.numerics.spheres, p.numerics.vertices, (performance.now() - begin) / steps];""")
    print("{} spheres, {} vertices: {:.2f} ms a step of 1/60 s, skin included".format(*told))


def check_server(model):
    """Serves this machine alone, under its own names, until it is told to end."""
    server = subprocess.Popen([program, "play", str(model), "-q"], stdout=subprocess.PIPE, text=True)
    try:
        address = re.match(r"(http://127\.0\.0\.1:\d+/)", server.stdout.readline()).group(1)
        page = urllib.request.urlopen(address, timeout=10).read()
        expect(b"play-module" in page, "the server gives another page")
        try:
            urllib.request.urlopen(urllib.request.Request(address, headers={"Host": "elsewhere.example"}), timeout=10)
            expect(False, "the server answers under a foreign name")
        except urllib.error.HTTPError as refused:
            expect(refused.code == 403, f"the server answers a foreign name with {refused.code}")
        port = address.rsplit(":", 1)[1].strip("/")
        second = subprocess.run([program, "play", str(model), "--port", port], capture_output=True, text=True, timeout=60)
        expect(second.returncode == 3 and "--port" in second.stderr, f"a port in use: {second.returncode}, {second.stderr}")
    finally:
        server.send_signal(signal.SIGINT)
    expect(server.wait(10) == 0, f"the server ends with {server.returncode}")


with tempfile.TemporaryDirectory() as folder:
    at = pathlib.Path(folder)
    palpate("new", at / "case")
    palpate("probe", at / "case/case.yaml", "-o", at / "blind", "--hide", "gravity:gx=0,gy=0,gz=-4000", "--probes", 9,
            "--edge-length", 10)
    palpate("run", at / "blind", "-o", at / "measured", "--parameters", "uniform", "--particles", 40, "--edge-length", 10)
    page = at / "page.html"
    palpate("play", at / "measured", "-o", page)
    size = page.stat().st_size
    print(f"{size} bytes")
    expect(size < 5_000_000, f"{size} bytes are more than 5 MB")
    palpate("probe", at / "case/case.yaml", "-o", at / "slow", "--hide", "viscosity", "--dwell", "0.1,2,10", "--probes", 5,
            "--edge-length", 10)
    palpate("run", at / "slow", "-o", at / "crept", "--parameters", "uniform", "--particles", 40, "--edge-length", 10)
    palpate("play", at / "crept", "-o", at / "crept.html")
    finger = pathlib.Path(sys.argv[2]) / "samples/tendon-finger"
    palpate("skeleton", finger, "-o", at / "finger.json")
    palpate("play", at / "finger.json", "--set", finger, "-o", at / "finger.html")
    check_server(at / "measured")
    browser = PlayerBrowser(at / "profile", "player")
    try:
        check_model(browser, at / "measured", page, at)
        check_ball(browser, page)
        check_ladder(browser, at / "measured", page)
        check_creep(browser, at / "crept", at / "crept.html")
        check_actuators(browser, at / "finger.html")
        check_phone(browser, page)
        tell_time(browser, page)
        for error in browser.errors():
            failures.append(f"the console says {error}")
    finally:
        browser.close()

end()
