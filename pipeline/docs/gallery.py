#!/usr/bin/python3
"""A picture for each effect: pipeline/docs/gallery.py -o FOLDER [--palpate PROGRAM] [EFFECT ...]

A bar of spheres and links is the body. The program hides an effect in it (`palpate probe MODEL --hide EFFECT`), fits the
bar without it, and once more with it (`palpate improve --add EFFECT --body skeleton`). Drawn is the state with the
largest error: without the effect, with it, and where the former is wrong. Asks for Debian's python3-vtk9 and
python3-matplotlib.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from PIL import Image
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

root = Path(__file__).resolve().parents[2]
# What is hidden where something has to be told, and how the bar is probed where a rig would do otherwise.
hidden = {
    "gravity": ("gravity:gx=0,gy=0,gz=-2500", []),
    "stiffening": ("stiffening", ["--levels", "3"]),
    "anisotropy": ("anisotropy", []),
    "inclusion": ("inclusion:cx=30,cy=8,cz=8,radius=12,ratio=8", []),
    "compliant-support": ("compliant-support", []),
    "contact": ("contact", []),
    "prestress": ("prestress", []),
    "swelling": ("swelling", []),
    "viscosity": ("viscosity", ["--dwell", "0.1,10"]),
    "plasticity": ("plasticity", ["--unload", "--continuous"]),
    "torsion": ("torsion", []),
    "shear": ("shear", []),
    "misalignment": ("misalignment", []),
    "force-gain": ("force-gain", []),
    "outliers": ("outliers", []),
}
turn = np.array([[0.94, -0.34, 0.0], [0.12, 0.34, 0.93], [0.32, 0.88, -0.36]])  # rows: right, up, away from the eye
light = np.array([-0.3, 0.8, -0.5]) / np.linalg.norm([-0.3, 0.8, -0.5])  # in these


def read(path):
    """Points, triangles, and the arrays of the points."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    arrays = mesh.GetPointData()
    polys = vtk_to_numpy(mesh.GetPolys().GetData()).reshape(-1, 4)[:, 1:] if mesh.GetNumberOfPolys() else np.empty((0, 3), int)
    return vtk_to_numpy(mesh.GetPoints().GetData()), polys, {
        arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())}


def draw(axes, points, triangles, colours):
    """The skin, what is furthest first, lit from above."""
    seen = points @ turn.T
    corners = seen[triangles]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 1] - corners[:, 0])  # the axes are left-handed
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shade = 0.55 + 0.45 * np.clip(normals @ light, 0, 1)
    order = np.argsort(-corners[:, :, 2].mean(axis=1))
    faces = np.concatenate([colours * shade[:, None], np.ones((len(colours), 1))], axis=1)[order]
    axes.add_collection(PolyCollection(corners[order][:, :, :2], facecolors=faces, edgecolors=faces, linewidths=0.4))


def picture(folder, name, path):
    """Three panels of the worst state: without the effect, with it, and where the error is."""
    steps = [folder / "better" / f"step_{i}" for i in range(2)]
    errors = [np.sqrt((read(f)[2]["error [mm]"] ** 2).sum(axis=1).mean()) for f in sorted(steps[0].glob("markers_*.vtp"))]
    worst = int(np.argmax(errors))
    ladder = json.loads((folder / "better" / "ladder.json").read_text())["steps"]
    figure, panels = plt.subplots(1, 3, figsize=(9.6, 2.5), dpi=100)
    limits = []
    for panel, step, words in ((0, 0, "without"), (1, 1, "with"), (2, 0, "where it is wrong")):
        rest, triangles, skin = read(steps[step] / f"skin_{worst:03}.vtp")
        at, _, markers = read(steps[step] / f"markers_{worst:03}.vtp")
        moved = rest + skin["displacement [mm]"]
        error = markers["error [mm]"]
        axes = panels[panel]
        grey = np.tile([0.62, 0.70, 0.80], (len(triangles), 1))
        if panel == 2:
            # of each triangle: that of the markers nearby
            where = at - markers["measured [mm]"]
            apart = np.linalg.norm(rest[triangles].mean(axis=1)[:, None] - where[None], axis=2)
            weight = 1 / (apart + 1) ** 4
            size = weight @ np.linalg.norm(error, axis=1) / weight.sum(axis=1)
            grey = plt.get_cmap("inferno")(0.15 + 0.8 * size / max(size.max(), 1e-12))[:, :3]
            words += f" (at most {np.linalg.norm(error, axis=1).max():.2g} mm)"
        else:
            words += f" {name}: {ladder[step]['rms_mm']:.2g} mm rms"
        draw(axes, moved, triangles, grey)
        if panel < 2:
            is_seen = turn[2] @ (at - rest.mean(axis=0)).T < 0.25 * np.ptp(rest[:, 1])
            measured = at[is_seen] @ turn.T
            axes.scatter(measured[:, 0], measured[:, 1], s=7, color="#e8590c", linewidths=0, zorder=3)
        limits.append(np.r_[(moved @ turn.T).min(axis=0)[:2], (moved @ turn.T).max(axis=0)[:2]])
        axes.set_title(words, fontsize=9, color="#868e96")
        axes.set_aspect("equal")
        axes.axis("off")
    low, high = np.min(limits, axis=0)[:2] - 3, np.max(limits, axis=0)[2:] + 3
    for axes in panels:
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
    title = 0.3  # inches
    height = 9.6 / 3 * (high[1] - low[1]) / (high[0] - low[0]) + title
    figure.set_size_inches(9.6, height)
    figure.subplots_adjust(0, 0, 1, 1 - title / height, 0.02, 0)
    figure.savefig(path, transparent=True)
    plt.close(figure)
    Image.open(path).quantize(96, method=Image.Quantize.FASTOCTREE).save(path, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--palpate", default=str(root / "build" / "palpate"))
    parser.add_argument("effects", nargs="*", metavar="EFFECT", help="all by default: " + ", ".join(hidden))
    told = parser.parse_args()
    if unknown := set(told.effects) - set(hidden):
        raise SystemExit(f"no picture of: {', '.join(sorted(unknown))}; there are {', '.join(hidden)}")
    told.output.mkdir(parents=True, exist_ok=True)
    palpate = lambda *words: subprocess.run([told.palpate, *map(str, words), "-q"], check=True, stdout=subprocess.DEVNULL)
    failed = []
    with tempfile.TemporaryDirectory() as scratch:
        model = Path(scratch) / "model.json"
        palpate("skeleton", root / "samples" / "plan" / "bar.stl", "-o", model)
        for name in told.effects or hidden:
            folder = Path(scratch) / name
            what, how = hidden[name]
            try:
                palpate("probe", model, "-o", folder / "set", "--hide", what, "--probes", 4, "--markers", 150, "--displacement", 0.2, "--seed", 3, *how)
                palpate("improve", model, folder / "set", "--add", name, "--body", "skeleton", "--parameters", "uniform", "-o", folder / "better")
            except subprocess.CalledProcessError:  # which has told why
                failed.append(name)
                continue
            picture(folder, name, told.output / f"{name}.png")
            print(told.output / f"{name}.png")
    if failed:
        print(f"no picture came of: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
