"""Makes this set anew: CalculiX presses a bar, lets it go, and lets it ring in large displacement.

  palpate probe samples/plan/case.yaml --to inp --probes 4 -o deck
  samples/ring-down/make_set.py deck samples/ring-down       # two times 400 steps: half an hour

The body is Neo-Hooke's, of E = 0.1 MPa, nu = 0.45, 1000 kg/m^3, and damped after Rayleigh. Readings have a noise of
0.02 mm. Needs CalculiX (apt-get install calculix-ccx) and Python's standard library."""

import math
import pathlib
import random
import subprocess
import sys
import tempfile

ALPHA, BETA = 0.4, 0.004  # [1/s], [s]
SIGMA = 0.02  # of a reading [mm]
STEP, LASTS = 0.0025, 1.0  # of time [s]
RELEASES = [((80, 8, 14), (0, 0, -0.012)), ((80, 14, 6), (0, 0.010, 0.006))]  # where [mm], with what [N]
MARKERS, IN_MOTION, RADIUS = 30, 6, 3.0


class Deck:
    """The input that palpate wrote: nodes, the body up to its first step, the steps."""

    def __init__(self, folder):
        lines = (folder / "body.inp").read_text().split("\n")
        first = next(i for i, line in enumerate(lines) if line.startswith("*STEP"))
        self.head, self.steps = lines[:first], lines[first:]
        rows = (line.split(",") for line in self.block("*NODE, NSET=NALL"))
        self.at = {int(n): (float(x), float(y), float(z)) for n, x, y, z in rows}
        held = set(self.numbers("*NSET, NSET=NHELD"))
        self.free = [n for n in self.numbers("*NSET, NSET=NSKIN") if n not in held]

    def block(self, title):
        start = self.head.index(title) + 1
        end = next(i for i in range(start, len(self.head)) if self.head[i].startswith("*"))
        return self.head[start:end]

    def numbers(self, title):
        return [int(word) for line in self.block(title) for word in line.replace(",", " ").split()]

    def near(self, place):
        return [n for n in self.free if math.dist(self.at[n], place) <= RADIUS]


def solve(deck, markers, steps):
    """(time, displacement of each marker's node) of each output."""
    density = next(i for i, line in enumerate(deck.head) if line.startswith("*DENSITY"))
    head = deck.head[:density] + [f"*DAMPING, ALPHA={ALPHA}, BETA={BETA}"] + deck.head[density:]
    marked = "*NSET, NSET=NMARK\n" + ",\n".join(map(str, markers))
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        (work / "body.inp").write_text("\n".join([*head, marked, *steps]))
        subprocess.run(["ccx", "body"], cwd=work, check=True, stdout=subprocess.DEVNULL)
        outputs = []
        for line in (work / "body.dat").read_text().split("\n"):
            if "displacements" in line:
                outputs.append((float(line.split()[-1]), {}))
            elif outputs and line.strip():
                node, *u = line.split()
                outputs[-1][1][int(node)] = [float(c) for c in u]
    return outputs


def printed(steps):
    """The steps, each with the markers' displacements printed at its end."""
    for line in steps:
        if line.startswith("*END STEP"):
            yield "*NODE PRINT, NSET=NMARK, FREQUENCY=1000\nU"
        yield line


def release(nodes, force):
    load = [f"{n}, {d + 1}, {force[d] / len(nodes)}" for n in nodes for d in range(3) if force[d]]
    return f"""*STEP, NLGEOM, INC=1000
*STATIC
0.25, 1
*CLOAD, OP=NEW
{chr(10).join(load)}
*NODE PRINT, NSET=NMARK, FREQUENCY=1000
U
*EL FILE, FREQUENCY=100000
ENER
*END STEP
*STEP, NLGEOM, INC=100000
*DYNAMIC, ALPHA=0, DIRECT
{STEP}, {LASTS}
*CLOAD, OP=NEW
*NODE PRINT, NSET=NMARK, FREQUENCY=2
U
*END STEP""".split("\n")


def main(deck_folder, out):
    deck = Deck(deck_folder)
    random.seed(5)
    markers = sorted(random.sample(deck.free, MARKERS))

    def row(node, u):
        return ",".join(f"{x + du + random.gauss(0, SIGMA):.4f}" for x, du in zip(deck.at[node], u))

    rests = ["%d,%.5f,%.5f,%.5f" % (m, *deck.at[n]) for m, n in enumerate(markers)]
    (out / "markers.csv").write_text("\n".join(["marker,x,y,z", *rests, ""]))

    probes = (deck_folder / "probes.csv").read_text()
    states = list(dict.fromkeys(tuple(line.split(",")[:2]) for line in probes.split("\n")[2:] if line))
    table = ["probe,time,marker,x,y,z"]
    for (probe, time), (_, u) in zip(states, solve(deck, markers, printed(deck.steps))):
        table += [f"{probe},{time},{m},{row(n, u[n])}" for m, n in enumerate(markers)]
    (out / "probes.csv").write_text(probes)
    (out / "positions.csv").write_text("\n".join([*table, ""]))

    loads, table = ["probe,time,x,y,z,fx,fy,fz,radius"], ["probe,time,marker,x,y,z"]
    for probe, (place, force) in enumerate(RELEASES, 1):
        nodes = deck.near(place)
        centre = [sum(deck.at[n][d] for n in nodes) / len(nodes) for d in range(3)]
        loads.append("%d,0,%g,%g,%g,%g,%g,%g,%g" % (probe, *centre, *force, RADIUS))
        loads.append(f"{probe},{LASTS:g},0,0,0,0,0,0,0")
        for i, (time, u) in enumerate(solve(deck, markers, release(nodes, force))):
            since = 0 if i == 0 else time - 1  # the static step ends at 1
            table += [f"{probe},{since:.5g},{m},{row(n, u[n])}" for m, n in enumerate(markers[:IN_MOTION])]
    (out / "motion_probes.csv").write_text("\n".join([*loads, ""]))
    (out / "motion_positions.csv").write_text("\n".join([*table, ""]))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
