#!/usr/bin/env python3
"""A slender aluminium strip under dead loads at its tip, by Euler's elastica: what a laboratory would measure of it.

A cantilever of length l and bending stiffness E I, bent by a dead load F across, keeps its length; its slope theta(s)
follows E I theta'' = -F cos(theta), theta(0) = 0, theta'(l) = 0. [Timoshenko & Gere, Theory of Elastic Stability, 2.7]
The equation is integrated by the classic Runge-Kutta method and shot at theta'(l) = 0 by bisection. Stretch and shear
are nothing in a strip 200 times as long as thick; it is four times as wide as thick, so that its width bends freely.

    samples/aluminium-strip/make_set.py samples/aluminium-strip
"""

import math
import pathlib
import random
import sys

YOUNG, LENGTH, WIDTH, THICKNESS = 70e3, 400.0, 8.0, 2.0  # MPa, mm
BENDING = YOUNG * WIDTH * THICKNESS**3 / 12  # N mm^2
LOADS = [0.06 * i for i in range(1, 22)]  # N
NOISE = 0.1  # mm, of a motion capture system
MARKERS = [(1, 50.0), (2, 100.0), (3, 200.0), (4, 300.0), (5, 398.0)]  # number, place along the strip [mm]
LOADED = 398.0  # mm
STEPS = 2000


def curve(force, curvature):
    """Slope, curvature, x and z along the strip up to the load, in STEPS steps, for a curvature at the clamp."""
    h = LOADED / STEPS
    points = [(0.0, curvature, 0.0, 0.0)]

    def slope(state):
        theta, kappa, _, _ = state
        return kappa, -force * math.cos(theta) / BENDING, math.cos(theta), math.sin(theta)

    for _ in range(STEPS):
        at = points[-1]
        k1 = slope(at)
        k2 = slope([a + h / 2 * k for a, k in zip(at, k1)])
        k3 = slope([a + h / 2 * k for a, k in zip(at, k2)])
        k4 = slope([a + h * k for a, k in zip(at, k3)])
        points.append(tuple(a + h / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(at, k1, k2, k3, k4)))
    return points


def bent(force):
    """The strip under a load, whose end has no moment."""
    least, most = 0.0, force * LOADED / BENDING
    for _ in range(60):
        middle = (least + most) / 2
        if curve(force, middle)[-1][1] > 0:
            most = middle
        else:
            least = middle
    return curve(force, (least + most) / 2)


def marker(points, along):
    """A marker on the upper side, of a strip bent downwards."""
    place = along / LOADED * STEPS
    i = min(int(place), STEPS - 1)
    theta, _, x, z = (a + (place - i) * (b - a) for a, b in zip(points[i], points[i + 1]))
    up = THICKNESS / 2
    return x + up * math.sin(theta), 0.0, -z + up * math.cos(theta)


def box_stl():
    corners = [(x, y, z) for x in (0, LENGTH) for y in (-WIDTH / 2, WIDTH / 2) for z in (-THICKNESS / 2, THICKNESS / 2)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    text = "solid strip\n"
    for a, b, c, d in sides:
        for triangle in ((a, b, c), (a, c, d)):
            text += "facet normal 0 0 0\nouter loop\n"
            text += "".join("vertex %g %g %g\n" % corners[i] for i in triangle)
            text += "endloop\nendfacet\n"
    return text + "endsolid strip\n"


def main(folder):
    chance = random.Random(1)
    folder.mkdir(parents=True, exist_ok=True)
    top = THICKNESS / 2
    (folder / "rest.stl").write_text(box_stl())
    (folder / "set.yaml").write_text(f"""format: palpate-measurements/1
name: aluminium-strip
rest_surface: rest.stl
supports:
  - box: {{min: [-1, -5, -2], max: [0.01, 5, 2]}}
noise: {{position: {NOISE}}}
material: {{young: 50000, poisson: 0.33}}
""")
    probes = ["probe,time,x,y,z,fx,fy,fz,radius"]
    positions = ["probe,time,marker,x,y,z"]
    for probe, force in enumerate(LOADS, 1):
        probes.append(f"{probe},0,{LOADED:g},0,{top:g},0,0,{-force:.2f},2")
        points = bent(force)
        for number, along in MARKERS:
            read = [a + chance.gauss(0, NOISE) for a in marker(points, along)]
            positions.append(f"{probe},0,{number}," + ",".join(f"{a:.3f}" for a in read))
    markers = ["marker,x,y,z"] + [f"{number},{along:g},0,{top:g}" for number, along in MARKERS]
    for name, rows in (("probes", probes), ("positions", positions), ("markers", markers)):
        (folder / f"{name}.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
