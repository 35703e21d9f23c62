"""Objects of other packages in and out. None of these is needed: each is imported when it is asked for."""

from __future__ import annotations

import importlib

import numpy as np

from . import _core
from ._call import whole
from .errors import InvalidInput

_SOURCES = {
    "pandas": "python3-pandas (Debian) or pandas (pip)",
    "xarray": "python3-xarray (Debian) or xarray (pip)",
    "meshio": "python3-meshio (Debian) or meshio (pip)",
    "arviz": "arviz (pip)",
    "pyvista": "pyvista (pip)",
}


def imported(name):
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"{name} is not installed; install {_SOURCES[name]}", name=name) from None


def frame(rows):
    return imported("pandas").DataFrame(rows)


# --- Tables --------------------------------------------------------------------------------------------------------


def model_frame(model):
    """A pandas.DataFrame with a row a link: its spheres, length and stiffnesses, units in the names."""
    columns = {"a": model.links[:, 0], "b": model.links[:, 1], "length [mm]": model.lengths}
    for i, (name, unit) in enumerate(zip(model.stiffness_names, model.stiffness_units)):
        columns[f"{name} [{unit}]"] = model.stiffness[:, i]
    return imported("pandas").DataFrame(columns)


def posterior_frame(posterior):
    """A pandas.DataFrame with a row a parameter, as posterior.csv has them."""
    names = ("mean", "sd", "q025", "q50", "q975", "prior_mean", "prior_sd", "informed")
    columns = {"parameter": posterior.parameters, "link": posterior.links, "unit": posterior.units}
    columns.update({name: getattr(posterior, f"_{name}") for name in names})
    return imported("pandas").DataFrame(columns)


def set_frame(set):
    """A pandas.DataFrame with a row a reading: probe, time, marker, x, y, z and sigma [mm], as positions.csv has them."""
    states, markers = np.nonzero(~np.isnan(set.positions).all(axis=2))
    x = set.positions[states, markers]
    columns = {
        "probe": set.probes[states],
        "time": set.times[states],
        "marker": np.array(set.marker_names, dtype=object)[markers],
        **{name: x[:, i] for i, name in enumerate("xyz")},
        "sigma": set.sigma[states, markers],
    }
    return imported("pandas").DataFrame(columns)


# --- Fields and posteriors -------------------------------------------------------------------------------------------


def set_dataset(set):
    """An xarray.Dataset: positions (state, marker, axis) [mm], with the markers at rest and the probes of the states."""
    coordinates = {
        "marker": set.marker_names,
        "axis": list("xyz"),
        "probe": ("state", set.probes),
        "time": ("state", set.times),
    }
    arrays = {
        "position": (("state", "marker", "axis"), set.positions, {"units": "mm"}),
        "rest": (("marker", "axis"), set.markers, {"units": "mm"}),
        "sigma": (("state", "marker"), set.sigma, {"units": "mm"}),
    }
    return imported("xarray").Dataset(arrays, coords=coordinates)


def resampled(posterior, draws=1000, seed=1):
    """Draws of equal weight (draws, parameters): systematic resampling, the same ones each time."""
    if posterior.draws.shape[0] == 0:
        raise InvalidInput("posterior: has no draws; identify with particles")
    draws = whole(draws, "draws", 1, 1_000_000)
    places = (np.random.default_rng(seed).random() + np.arange(draws)) / draws
    sums = np.cumsum(posterior.weights)
    return posterior.draws[np.searchsorted(sums / sums[-1], places)]


def inference_data(posterior, draws=1000, seed=1):
    """An arviz.InferenceData (a DataTree by arviz 1) of equally likely draws, a variable a parameter. They are in one chain
    and are none: ArviZ's ess and r_hat say nothing of them."""
    arviz = imported("arviz")
    drawn = resampled(posterior, draws, seed)
    values = {name: drawn[None, :, i] for i, name in enumerate(posterior.parameters)}
    if int(arviz.__version__.split(".")[0]) >= 1:
        data = arviz.from_dict({"posterior": values})
    else:
        data = arviz.from_dict(posterior=values)
    for name, unit in zip(posterior.parameters, posterior.units):
        data.posterior[name].attrs["units"] = unit
    return data


# --- Meshes ----------------------------------------------------------------------------------------------------------

# meshio's quadratic tetrahedra number their midsides as VTK does, and so do ours.
_CELLS = {3: "triangle", 4: "tetra", 10: "tetra10"}
_VTK = {4: 10, 10: 24}  # VTK's numbers of them


def to_meshio(body):
    """A meshio.Mesh of it [mm]."""
    points, cells = (body.nodes, body.tetrahedra) if isinstance(body, _core.Mesh) else (body.vertices, body.triangles)
    return imported("meshio").Mesh(points, [(_CELLS[cells.shape[1]], cells)])


def mesh_from_meshio(mesh):
    """Tetrahedra of a meshio.Mesh as a palpate.Mesh."""
    kind = "tetra10" if "tetra10" in mesh.cells_dict else "tetra"
    if kind not in mesh.cells_dict:
        raise InvalidInput(f"mesh: has cells {', '.join(mesh.cells_dict) or 'of no kind'}, must have tetra or tetra10")
    return _core.Mesh(_in_space(mesh.points), mesh.cells_dict[kind])


def surface_from_meshio(mesh):
    """Triangles of a meshio.Mesh as a palpate.Surface."""
    if "triangle" not in mesh.cells_dict:
        raise InvalidInput(f"mesh: has cells {', '.join(mesh.cells_dict) or 'of no kind'}, must have triangle")
    return _core.Surface(_in_space(mesh.points), mesh.cells_dict["triangle"])


def _in_space(points):
    points = np.asarray(points)
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def to_pyvista(body):
    """A pyvista.PolyData of a Surface, an UnstructuredGrid of a Mesh [mm]."""
    pyvista = imported("pyvista")
    if isinstance(body, _core.Mesh):
        return pyvista.UnstructuredGrid({_VTK[body.tetrahedra.shape[1]]: np.array(body.tetrahedra)}, np.array(body.nodes))
    return pyvista.PolyData(np.array(body.vertices), _faces(body.triangles))


def _faces(triangles):
    return np.column_stack([np.full(len(triangles), 3), triangles]).ravel()


def surface_from_pyvista(data):
    """A pyvista.PolyData as a palpate.Surface; polygons are cut into triangles."""
    if not hasattr(data, "faces"):
        raise InvalidInput(f"data: is a {type(data).__name__}, must be a PolyData; take its extract_surface()")
    surface = data.triangulate()
    return _core.Surface(np.asarray(surface.points, float), np.asarray(surface.faces).reshape(-1, 4)[:, 1:])


def mesh_from_pyvista(data):
    """Tetrahedra of a pyvista.UnstructuredGrid as a palpate.Mesh."""
    cells = getattr(data, "cells_dict", {})
    kind = _VTK[10] if _VTK[10] in cells else _VTK[4]
    if kind not in cells:
        raise InvalidInput(f"data: is a {type(data).__name__} without tetrahedra, must be an UnstructuredGrid that has them")
    return _core.Mesh(np.asarray(data.points, float), cells[kind])
