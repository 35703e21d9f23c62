#!/usr/bin/python3
"""A picture for each effect: pipeline/docs/gallery.py -o FOLDER [--palpate PROGRAM] [EFFECT ...]

The program hides an effect in a body (`palpate probe BODY --hide EFFECT`), fits the body without it, and once more with
it (`palpate improve --add EFFECT`). The body is a bar of spheres and links; where links cannot show the effect or a rig
drives the body, one of finite elements. Drawn is the state with the largest error: without the effect, with it, and
where the former is wrong. Asks for Debian's python3-vtk9 and python3-matplotlib; all pictures take minutes.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from PIL import Image
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

root = Path(__file__).resolve().parents[2]


def box(low, high):
    """Its triangles, outward; inward where low and high are exchanged."""
    x, y, z = zip(low, high)
    corners = np.array([(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)])
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    return [corners[[f[0], f[i], f[i + 1]]] for f in faces for i in (1, 2)]


def surface(path, triangles):
    facets = ("facet normal 0 0 0\nouter loop\n" + "".join("vertex {:g} {:g} {:g}\n".format(*p) for p in t) + "endloop\nendfacet\n" for t in triangles)
    path.write_text("solid body\n" + "".join(facets) + "endsolid body\n")


class Shown(NamedTuple):
    """How an effect is shown: what is hidden in which body, how that is probed and loaded, and how it is fitted."""
    hide: str
    probe: tuple = ()
    loads: tuple = ("--probes", 4, "--displacement", 0.2)
    body: str = "links"
    fit: tuple = ()
    add: str = ""  # where the fit begins; by default the effect alone


bodies = {
    "bar": box((0, 0, 0), (100, 10, 10)),
    "block": box((0, 0, 0), (40, 24, 24)),
    "hollow": box((0, 0, 0), (100, 16, 16)) + box((94, 13, 9), (6, 3, 3)),
}
coarse = ("--edge-length", 8)
tendons = [("--tendon", f"1,{y} 20,{y} 40,{y} 60,{y} 80,{y} 99,{y}") for y in ("5,9", "9,5")]
shown = {
    "gravity": Shown("gravity:gx=0,gy=0,gz=-2500"),
    "stiffening": Shown("stiffening", ("--levels", 3)),
    "anisotropy": Shown("anisotropy:k=20,nx=0.8,ny=0.6,nz=0"),
    "inclusion": Shown("inclusion:cx=30,cy=8,cz=8,radius=12,ratio=8"),
    "map": Shown("map:contrast=3"),
    "volume": Shown("volume:poisson=0.2", coarse, ("--tendon", "1,12,12 39,12,12", "--tension", "2,4,5"), "block", coarse),
    # uniform links have a torsion and a shear of their own, which would stand for these
    "torsion": Shown("torsion:torsion=0.3", fit=("--fixed", "torsion")),
    "shear": Shown("shear", fit=("--fixed", "shear")),
    "compliant-support": Shown("compliant-support"),
    # the fit finds no obstacle that it does not begin near to
    "contact": Shown("contact:nx=0,ny=0,nz=1,offset=-9,stiffness=0.2", add="contact:nx=0,ny=0,nz=1,offset=-9,stiffness=0.2"),
    "pressure": Shown("pressure:pressure=0.006", ("--edge-length", 5), ("--probes", 3, "--displacement", 0.1), "hollow", ("--edge-length", 6)),
    "prestress": Shown("prestress"),
    "swelling": Shown("swelling"),
    "viscosity": Shown("viscosity", ("--dwell", "0.1,10")),
    "plasticity": Shown("plasticity", ("--unload", "--continuous")),
    "damage": Shown("damage"),
    "friction": Shown("friction:tendons=0.6", ("--back",), (*tendons[0], "--tension", "0.1,0.3,0.5"), "bar"),
    "misalignment": Shown("misalignment"),
    "force-gain": Shown("force-gain"),
    "slip": Shown("slip:share=0.7", coarse, ("--tool", "flat:radius=4", "--depth", "2,4", "--probes", 1), "sample", coarse),
    "actuation-gain": Shown("actuation-gain:gain=1.4", (), (*tendons[0], *tendons[1], "--tension", "0.1,0.2,0.3"), "bar"),
    "clock": Shown("clock:lag=0.33", ("--levels", 4, "--back")),
    "outliers": Shown("outliers"),
    # which a located source begins near to
    "local-force": Shown("local-force:cx=70,cy=5,cz=5,radius=6,fx=0,fy=0.01,fz=-0.015", add="local-force:cx=60,cy=5,cz=5,radius=10"),
    "local-springs": Shown("local-springs:cx=70,cy=5,cz=5,radius=6,stiffness=0.02", add="local-springs:cx=60,cy=5,cz=5,radius=10"),
    "local-swelling": Shown("local-swelling:cx=60,cy=5,cz=5,radius=8,growth=0.1", add="local-swelling:cx=50,cy=5,cz=5,radius=10"),
}
turn = np.array([[0.94, -0.34, 0.0], [0.12, 0.34, 0.93], [0.32, 0.88, -0.36]])  # rows: right, up, away from the eye
light = np.array([-0.3, 0.8, -0.5]) / np.linalg.norm([-0.3, 0.8, -0.5])  # in these


class State(NamedTuple):
    """A body that moved, and what is read of it [mm]."""
    rest: np.ndarray  # (n x 3)
    triangles: np.ndarray
    displacement: np.ndarray  # (n x 3)
    at: np.ndarray  # measured, where the markers are (m x 3)
    marker: np.ndarray  # at rest (m x 3)
    error: np.ndarray  # (m x 3)


def read(path):
    """Points, triangles, and the arrays of the points; of tetrahedra those of their surface."""
    reader = vtkXMLPolyDataReader() if path.suffix == ".vtp" else vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    if path.suffix == ".vtu":
        outside = vtkDataSetSurfaceFilter()
        outside.SetInputData(mesh)
        outside.Update()
        mesh = outside.GetOutput()
    arrays = mesh.GetPointData()
    polys = vtk_to_numpy(mesh.GetPolys().GetData()).reshape(-1, 4)[:, 1:] if mesh.GetNumberOfPolys() else np.empty((0, 3), int)
    return vtk_to_numpy(mesh.GetPoints().GetData()), polys, {
        arrays.GetArrayName(i): vtk_to_numpy(arrays.GetArray(i)) for i in range(arrays.GetNumberOfArrays())}


def of_links(step):
    """The states of a step of the ladder."""
    states = []
    for skin_file, marker_file in zip(sorted(step.glob("skin_*.vtp")), sorted(step.glob("markers_*.vtp"))):
        rest, triangles, skin = read(skin_file)
        at, _, markers = read(marker_file)
        states.append(State(rest, triangles, skin["displacement [mm]"], at, at - markers["measured [mm]"], markers["error [mm]"]))
    return states


def table(path, *keys):
    """Positions by key."""
    with path.open() as file:
        return {tuple(r[k] for k in keys): [float(r[c]) for c in "xyz"] for r in csv.DictReader(file)}


def of_solid(measured, played):
    """The states of a body in finite elements whose readings are played again without noise."""
    rests, readings, model = table(played / "markers.csv", "marker"), *(table(f / "positions.csv", "probe", "time", "marker") for f in (measured, played))
    states = []
    for probe, time in sorted({k[:2] for k in readings}):
        markers = [k[2] for k in readings if k[:2] == (probe, time)]
        at, moved = (np.array([t[probe, time, m] for m in markers]) for t in (readings, model))
        rest, triangles, skin = read(played / "field" / f"{probe}_{time}.vtu")
        states.append(State(rest, triangles, skin["displacement"], at, np.array([rests[m,] for m in markers]), moved - at))
    return states


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


def picture(name, steps, path):
    """Three panels of the worst state: without the effect, with it, and where the error is. steps: (states, rms) of each."""
    without = [np.sqrt((s.error ** 2).sum(axis=1).mean()) for s in steps[0][0]]
    worst = int(np.argmax(without))
    figure, panels = plt.subplots(1, 3, figsize=(9.6, 2.5), dpi=100)
    limits = []
    for panel, step, words in ((0, 0, "without"), (1, 1, "with"), (2, 0, "where it is wrong")):
        states, rms = steps[step]
        state = states[worst]
        moved = state.rest + state.displacement
        axes = panels[panel]
        colours = np.tile([0.62, 0.70, 0.80], (len(state.triangles), 1))
        if panel == 2:
            # of each triangle: that of the markers nearby
            apart = np.linalg.norm(state.rest[state.triangles].mean(axis=1)[:, None] - state.marker[None], axis=2)
            weight = 1 / (apart + 1) ** 4
            off = np.linalg.norm(state.error, axis=1)
            size = weight @ off / weight.sum(axis=1)
            colours = plt.get_cmap("inferno")(0.15 + 0.8 * size / max(size.max(), 1e-12))[:, :3]
            words += f" (at most {off.max():.2g} mm)"
        else:
            words += f" {name}: {rms:.2g} mm rms"
        draw(axes, moved, state.triangles, colours)
        if panel < 2:
            is_seen = turn[2] @ (state.at - moved.mean(axis=0)).T < 0.25 * np.ptp(state.rest[:, 1])
            measured = state.at[is_seen] @ turn.T
            axes.scatter(measured[:, 0], measured[:, 1], s=7, color="#e8590c", linewidths=0, zorder=3)
            limits += [measured[:, :2]]
        limits += [(moved @ turn.T)[:, :2]]
        axes.set_title(words, fontsize=9, color="#868e96")
        axes.set_aspect("equal")
        axes.axis("off")
    low, high = np.concatenate(limits).min(axis=0) - 3, np.concatenate(limits).max(axis=0) + 3
    share = min(1, 2.5 / 3.2 * (high[0] - low[0]) / (high[1] - low[1]))  # of the width, where a body is tall
    wider = (1 / share - 1) * (high[0] - low[0]) / 2
    low[0], high[0] = low[0] - wider, high[0] + wider
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


def steps_of(effect, palpate, scratch):
    """Probes, fits without and with the effect: the states of both, and their errors."""
    told, folder = shown[effect], scratch / effect
    measured, better = folder / "set", folder / "better"
    body, model = root / "samples" / "plan" / "bar.stl", scratch / f"{told.body}.json"
    if told.body in bodies:
        body = scratch / f"{told.body}.stl"
        surface(body, bodies[told.body])
    palpate("skeleton", body, "-o", model, "--force")
    is_links = told.body == "links"
    probe = lambda to, *how: palpate("probe", model if is_links else body, "-o", to, "--markers", 150, "--seed", 3, *told.loads, *told.probe, *how)
    probe(measured, "--hide", told.hide)
    judge = "skeleton" if is_links else "reference"
    palpate("improve", model, measured, "--add", told.add or effect, "--body", judge, "--parameters", "uniform", *told.fit, "-o", better)
    ladder = json.loads((better / "ladder.json").read_text())["steps"]
    if effect != "volume":
        return [(of_links(better / f"step_{i}"), step["rms_mm"]) for i, step in enumerate(ladder)]
    # which links do not have; the fitted Poisson's ratio is written nowhere: drawn is the hidden one
    steps = []
    for i, step in enumerate(ladder):
        solid = step["reference"]
        played = folder / f"played_{i}"
        probe(played, "--young", solid["young_mpa"], "--poisson", (0.45, 0.2)[i], "--noise", 1e-6)
        steps.append((of_solid(measured, played), solid["rms_mm"]))
    return steps


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--palpate", default=str(root / "build" / "palpate"))
    parser.add_argument("effects", nargs="*", metavar="EFFECT", help="all by default: " + ", ".join(shown))
    told = parser.parse_args()
    if unknown := set(told.effects) - set(shown):
        raise SystemExit(f"no picture of: {', '.join(sorted(unknown))}; there are {', '.join(shown)}")
    told.output.mkdir(parents=True, exist_ok=True)
    palpate = lambda *words: subprocess.run([told.palpate, *map(str, words), "-q"], check=True, stdout=subprocess.DEVNULL)
    failed = []
    with tempfile.TemporaryDirectory() as scratch:
        for effect in told.effects or shown:
            try:
                steps = steps_of(effect, palpate, Path(scratch))
            except subprocess.CalledProcessError:  # which has told why
                failed.append(effect)
                continue
            picture(effect, steps, told.output / f"{effect}.png")
            print(f"{told.output / effect}.png: {steps[0][1]:.3g} mm rms without, {steps[1][1]:.3g} mm with", flush=True)
    if failed:
        print(f"no picture came of: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
