"""What a call into a body costs beside the work that it does, and what importing the package costs.

    PYTHONPATH=build/python python3 tests/bench/python/step_overhead.py [MODEL]

A thousand calls of one step each against one call of a thousand steps: the difference is the calls'.
"""

import statistics
import subprocess
import sys
import time

import numpy as np
import palpate


def best(work, rounds=15):
    """Of several rounds, as others use the machine too [s]."""
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return min(times)


def bar():
    """A small model: the calls count."""
    corners = np.array([[x, y, z] for x in (0.0, 60.0) for y in (0.0, 20.0) for z in (0.0, 20.0)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    surface = palpate.Surface(corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return palpate.skeleton(surface, edge_length=14.0, spheres=6)


model = palpate.Model.read(sys.argv[1]) if len(sys.argv) > 1 else bar()
body = palpate.Body(model)
vertices = model.surface.vertices
tip = vertices[np.argmax(vertices[:, 0])]
hand = body.touch(tip)
force = np.array([0, 0, -0.01])
body.push(hand, force)
h, n = 0.1 * body.stable_step, 1000


def one_by_one():
    step = body.step_explicit
    for _ in range(n):
        step(h)


def at_once():
    body.step_explicit(h, n)


def calls_of(call, *arguments):
    def work():
        for _ in range(n):
            call(*arguments)

    return work


print(f"model: {len(model.radii)} spheres, {len(model.links)} links")
single, whole = best(one_by_one), best(at_once)
print(f"a step:                 {whole / n * 1e6:7.2f} us")
print(f"a call around it:       {(single - whole) / n * 1e6:7.2f} us")
to = tip + (0, 0, -1)
for name, call, arguments in (
    ("push(contact, array)", body.push, (hand, force)),
    ("push(contact, tuple)", body.push, (hand, (0.0, 0.0, -0.01))),
    ("drag(contact, array)", body.drag, (hand, to, 0.05)),
    ("force(contact)", body.force, (hand,)),
    ("place(contact)", body.place, (hand,)),
    ("positions", lambda: body.positions, ()),
    ("skin", lambda: body.skin, ()),
):
    print(f"{name + ':':<24}{best(calls_of(call, *arguments)) / n * 1e6:7.2f} us")


def imports(what):
    code = f"import time; t = time.perf_counter(); import {what}; print(time.perf_counter() - t)"
    runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True) for _ in range(7)]
    return statistics.median(float(run.stdout) for run in runs)


print(f"import numpy:           {imports('numpy'):7.3f} s")
print(f"import palpate:         {imports('palpate'):7.3f} s, numpy's with it")
