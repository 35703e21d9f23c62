"""Measurement sets out of arrays."""

from __future__ import annotations

import csv
import json
import tempfile
from pathlib import Path

import numpy as np

from . import _core
from ._call import calling, real
from .errors import InvalidInput


def read(path, *, threads=None):
    """Reads a measurement set: its folder or its set.yaml."""
    with calling(threads) as call:
        return _core.Set._read(path, call)


def from_arrays(
    surface,
    supports,
    markers,
    positions,
    points,
    forces,
    *,
    radius=0.0,
    probes=None,
    times=None,
    anchors=None,
    marker_names=None,
    sigma=None,
    noise=None,
    density=None,
    gravity=None,
    young=None,
    poisson=None,
    name="measurements",
):
    """Measurements out of arrays, which are copied; n states, m markers::

        surface:   of the body at rest [mm]; a Mesh is used as it is
        supports:  where it is held: {'box': {'min': [..], 'max': [..]}}, {'sphere': {'center', 'radius'}} or {'plane':
                   {'point', 'normal', 'within'}} [mm]; one or several
        markers:   at rest (m, 3) [mm]
        positions: measured (n, m, 3) [mm]; NaN is a missing reading
        points:    where the force of each state acts (n, 3) [mm]
        forces:    on the body (n, 3) [N]; 0: an unloaded state
        radius:    over which the force is spread [mm]; one, or (n,)
        anchors:   surface points that markers which stand off are rigidly attached to (m, 3) [mm]; None: none does
        probes, times: of states (n,) [-, s]; None: a probe each, of time 0
        sigma:     1 sigma of the readings [mm], (n, m) or what becomes that; noise: the same of all
        density, gravity: [kg/m^3], known to act on every state (3) [mm/s^2]
        young, poisson:   first guesses [MPa, -]

    Wrong shapes and what is not finite are refused by name (InvalidInput).
    """
    if not isinstance(surface, (_core.Surface, _core.Mesh)):
        raise TypeError(f"surface: is a {type(surface).__name__}, must be a Surface or a Mesh; Surface.read(path) makes one")
    if not isinstance(supports, (dict, list, tuple)):
        raise InvalidInput(f"supports: is {supports!r}, must be a box, sphere or plane, or a list of them; help tells how")
    markers = _table(markers, "markers", (None, 3))
    anchors = None if anchors is None else _table(anchors, "anchors", (len(markers), 3))
    positions = _table(positions, "positions", (None, len(markers), 3), missing=True)
    states = len(positions)
    forces = _table(forces, "forces", (states, 3))
    points = _table(points, "points", (states, 3))
    radius = _spread(radius, "radius", (states,))
    sigma = None if sigma is None else _spread(sigma, "sigma", (states, len(markers)))
    probes = np.arange(1, states + 1) if probes is None else _whole(_table(probes, "probes", (states,)))
    times = np.zeros(states) if times is None else _table(times, "times", (states,))
    names = [str(i + 1) for i in range(len(markers))] if marker_names is None else [str(n) for n in marker_names]
    if len(names) != len(markers):
        raise InvalidInput(f"marker_names: has {len(names)} names, must have one for each of the {len(markers)} markers")
    head = {
        "format": "palpate-measurements/1",
        "name": name,
        "units": {"length": "mm", "force": "N", "time": "s"},
        "rest_surface": "rest.vtp" if isinstance(surface, _core.Surface) else "rest.vtu",
        "supports": [supports] if isinstance(supports, dict) else list(supports),
        "density": None if density is None else real(density, "density"),
        "gravity": None if gravity is None else _table(gravity, "gravity", (3,)).tolist(),
        "noise": None if noise is None else {"position": real(noise, "noise")},
        "material": {k: real(v, k) for k, v in (("young", young), ("poisson", poisson)) if v is not None} or None,
    }
    with tempfile.TemporaryDirectory(prefix="palpate-") as place:
        folder = Path(place)
        surface.write(folder / head["rest_surface"])
        told = {key: value for key, value in head.items() if value is not None}
        (folder / "set.yaml").write_text(json.dumps(told, default=_plain))  # which YAML is, too
        places = markers if anchors is None else np.hstack([markers, anchors])
        _write(folder / "markers.csv", "marker,x,y,z" + ("" if anchors is None else ",ax,ay,az"), zip(names, *places.T))
        _write(
            folder / "probes.csv",
            "probe,time,x,y,z,fx,fy,fz,radius",
            zip(probes, times, *points.T, *forces.T, radius),
        )
        rows = []
        for s, m in zip(*np.nonzero(~np.isnan(positions).all(axis=2))):
            own = [] if sigma is None else [sigma[s, m]]
            rows.append([probes[s], times[s], names[m], *positions[s, m], *own])
        _write(folder / "positions.csv", "probe,time,marker,x,y,z" + ("" if sigma is None else ",sigma"), rows)
        try:
            return read(folder)
        except InvalidInput as error:  # the folder is nobody's business
            raise InvalidInput(str(error).replace(f"{folder}/", "")) from None


def _plain(value):
    if not hasattr(value, "tolist"):
        raise InvalidInput(f"supports: a {type(value).__name__} stands in it, must be names and numbers; help tells how")
    return value.tolist()


def _spread(given, name, shape):
    try:
        if not np.iscomplexobj(given):
            return np.broadcast_to(np.asarray(given, dtype=float), shape)
    except (TypeError, ValueError):
        pass
    raise InvalidInput(f"{name}: must be a real number, or real numbers of shape {_words(shape)}")


def _whole(probes):
    odd = probes[probes != np.floor(probes)]
    if odd.size:
        raise InvalidInput(f"probes: {odd[0]} is no whole number; number the probes")
    return probes.astype(int)


def _table(given, name, shape, missing=False):
    try:
        table = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name}: must be real numbers of shape {_words(shape)}; give a numpy array") from None
    if np.iscomplexobj(given) or table.ndim != len(shape):
        raise InvalidInput(f"{name}: has the shape {np.shape(given)}, must be real numbers of shape {_words(shape)}")
    if any(wanted is not None and size != wanted for size, wanted in zip(table.shape, shape)):
        raise InvalidInput(f"{name}: has the shape {table.shape}, must have the shape {_words(shape)}; reshape or transpose it")
    bad = np.isinf(table) if missing else ~np.isfinite(table)
    if bad.any():
        at = tuple(int(i) for i in np.argwhere(bad)[0])
        raise InvalidInput(f"{name}: {table[at]} at {at}, must be finite{'; NaN is a missing reading' if missing else ''}")
    return table


def _words(shape):
    return "(" + ", ".join("n" if size is None else str(size) for size in shape) + ("," if len(shape) == 1 else "") + ")"


def _write(file, header, rows):
    with open(file, "w", newline="") as out:
        out.write(header + "\n")
        writer = csv.writer(out)
        for row in rows:
            writer.writerow(["" if isinstance(c, float) and np.isnan(c) else _cell(c) for c in row])


def _cell(value):
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(value)
