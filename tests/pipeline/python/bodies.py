"""What the tests share: a bar of 60 x 20 x 20 mm, its skeleton, and measurements of it, made once a process."""

import functools
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import palpate

PROGRAM = os.environ["PALPATE_PROGRAM"]
SAMPLES = Path(os.environ["PALPATE_SAMPLES"])
COARSE = {"edge_length": 14.0, "spheres": 6}


@functools.lru_cache(maxsize=None)
def folder():
    kept = tempfile.TemporaryDirectory(prefix="palpate-test-")
    folder.kept = kept
    return Path(kept.name)


@functools.lru_cache(maxsize=None)
def bar():
    """Its eight corners and twelve triangles."""
    corners = np.array([[x, y, z] for x in (0.0, 60.0) for y in (0.0, 20.0) for z in (0.0, 20.0)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return palpate.Surface(corners, triangles)


@functools.lru_cache(maxsize=None)
def bar_file():
    bar().write(folder() / "bar.stl")
    return folder() / "bar.stl"


@functools.lru_cache(maxsize=None)
def model_file():
    palpate.skeleton(bar_file(), **COARSE).write(folder() / "model.json")
    return folder() / "model.json"


def model():
    return palpate.Model.read(model_file())


@functools.lru_cache(maxsize=None)
def set_folder():
    """The skeleton itself, probed: a twin experiment, fast."""
    palpate.probe(model_file(), folder() / "set", probes=4, markers=8, noise=0.01)
    return folder() / "set"


def measured():
    return palpate.Set.read(set_folder())


def program(*arguments):
    """What the program prints with --json."""
    import json

    done = subprocess.run([PROGRAM, *map(str, arguments), "--json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)
