"""The functions of the package: what the program's commands of these names do, on files or objects."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from . import _core
from ._call import as_path, calling, real, settings_of, whole, words_of
from ._results import Check, Comparison, Diagnosis, Ladder, Simulation
from ._run import Run
from .errors import InvalidInput

_INPUTS = ((_core.Surface, "surface.vtp"), (_core.Mesh, "body.vtu"), (_core.Set, "set"))
_MODEL = ((_core.Model, "model.json"),)
_MOST_DRAWS = 1_000_000  # each is an equilibrium for each state
_FITS = ("Body", "Skeleton", "Sphere curve", "Probing", "Identification", "Diagnosis")


def _model(given):
    if isinstance(given, _core.Identification):
        return given.model
    if isinstance(given, (str, os.PathLike)):
        return _core.Model.read(given)
    if isinstance(given, _core.Model):
        return given
    raise TypeError(f"model: is a {type(given).__name__}, must be a Model, an Identification or a path of model.json")


def _set(given, call):
    if isinstance(given, (str, os.PathLike)):
        return _core.Set._read(given, call)
    if isinstance(given, _core.Set):
        return given
    raise TypeError(f"set: is a {type(given).__name__}, must be a Set or a path of a measurement set")


def run(input, output=None, *, threads=None, seed=None, force=False, progress=None, **settings):
    """The whole pipeline: mesh, skeleton, identification, comparison, diagnosis, improvement, report.

    `input`: a case.yaml, a measurement set (a path or a Set), or a body (a path, a Surface or a Mesh). `output`: the run
    folder, <input>-run where None. Stages that were finished before and whose inputs are the same are not run again.

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of(_FITS, settings)
    with calling(threads, seed, force, progress) as call, as_path(input, _INPUTS) as path:
        if output is None:
            is_path = isinstance(input, (str, os.PathLike))
            output = f"{Path(os.path.abspath(path)).stem}-run" if is_path else "palpate-run"
        text, result, code = _core.run(path, output, pairs, call)
    return Run(output, result, text, code)


def check(input, output=None, *, expect=(), cost=False, threads=None, force=False, **settings):
    """Reads everything, repairs nothing, says what is wrong and how to mend it, and what a set could show.

    `output`: a folder, or a page (.html). `expect`: names of effects that the set has to be able to show; the answer is
    false where it cannot. `cost`: also how long a run would take, and how much memory, as `result["cost"]`.
    """
    pairs = settings_of(("Body", "Skeleton", "Probing", "Identification"), settings)
    expect = words_of(expect, "expect")
    with calling(threads, None, force) as call, as_path(input, _INPUTS) as path:
        text, result, code = _core.check(path, output or "", expect, bool(cost), pairs, call)
    return Check(text, result, code == 0)


def mesh(input, *, threads=None, progress=None, **settings):
    """Repairs, remeshes and fills a body with tetrahedra.

    Settings: edge_length [mm], linear_elements, unit, longest [mm], label, keep.

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of(("Body",), settings)
    with calling(threads, None, False, progress) as call, as_path(input, _INPUTS) as path:
        return _core.mesh(path, pairs, call)


def skeleton(input, *, threads=None, progress=None, **settings):
    """A Model out of a body: medial axis, spheres, links and skin, with start stiffness from the sections.

    Settings: spheres, coverage [mm], links, zones, young [MPa], poisson, density [kg/m^3], and those of mesh().

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of(("Body", "Skeleton"), settings)
    with calling(threads, None, False, progress) as call, as_path(input, _INPUTS) as path:
        model, _ = _core.skeleton(path, pairs, call)
    return model


def probe(
    input,
    output=None,
    *,
    hide=None,
    law=None,
    levels=None,
    dwell=None,
    unload=None,
    back=None,
    continuous=None,
    missing=None,
    unlabelled=None,
    include_material=None,
    threads=None,
    seed=None,
    force=False,
    progress=None,
    **settings,
):
    """Measurements by simulation, with effects hidden in them; of a body, or of a Model itself (a twin experiment).

    `hide`: 'gravity', 'inclusion:ratio=8,radius=12', several, or 'none'. `law`: linear, svk or neo-hooke. `dwell`: each
    load is read so long after it was put on [s]. `missing`, `unlabelled`: shares of the readings. Settings: probes,
    markers, displacement (over the longest side), noise [mm], young [MPa], and those of mesh().

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of(("Body", "Probing"), settings)
    synthesis = {
        "hide": None if hide is None else words_of(hide, "hide"),
        "law": law,
        "levels": levels,
        "dwell": dwell,
        "unload": unload,
        "back": back,
        "continuous": continuous,
        "missing": missing,
        "unlabelled": unlabelled,
        "include_material": include_material,
    }
    with calling(threads, seed, force, progress) as call, as_path(input, _INPUTS + _MODEL) as path:
        with tempfile.TemporaryDirectory(prefix="palpate-") as folder:
            where = Path(output) if output is not None else Path(folder) / "set"
            _core.probe(path, where, pairs, synthesis, call)
            return _core.Set._read(where, call)


def identify(model, set, output=None, *, threads=None, seed=None, force=False, progress=None, **settings):
    """The stiffness of every link, by particle filter. `output`: a folder for what the program writes.

    Settings: parameters (uniform, zones, links), particles, law, method, domain, fixed, search_low, search_high.

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of(("Identification",), settings)
    with calling(threads, seed, force, progress) as call:
        found = _core.identify(_model(model), _set(set, call), pairs, call)
    if output is not None:
        found.write(output, force)
    return found


def compare(model, set, output=None, *, reference=True, threads=None, force=False, progress=None, **settings):
    """A model against measurements: how wrong, where, under which probe.

    `reference`: beside the body in finite elements, for an error budget; False: fast. Settings: edge_length [mm].

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of((), settings, ("volume.edge_length",))
    with calling(threads, None, force, progress) as call:
        given = _set(set, call)
        text, result, predicted = _core.compare(_model(model), given, output or "", reference, pairs, call)
    return Comparison(text, result, given, predicted)


def diagnose(
    model, set, output=None, *, without=(), body="reference", threads=None, force=False, progress=None, **settings
):
    """Which physical effect a model lacks, with the evidence, and the next probe that would tell more.

    `without`: effects left out of the catalogue. `body`: what the errors are judged on. Settings: edge_length [mm],
    gravity (automatic, earth, unknown), false_claims.

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of((), settings, ("volume.edge_length", "diagnose.gravity", "diagnose.false_claims"))
    without = words_of(without, "without")
    for name in without:
        effects(name)
    _require_body(body, ("reference", "skeleton"))
    with calling(threads, None, force, progress) as call:
        text, result, notes = _core.diagnose(
            _model(model), _set(set, call), output or "", without, body, pairs, call
        )
    return Diagnosis(text, result, notes)


def improve(
    model, set, add=(), output=None, *, body="", threads=None, seed=None, force=False, progress=None, **settings
):
    """Adds effects to a model, fits anew, and tells the error before and after, on fitted and on held-out probes.

    `add`: effects, 'gravity' or 'gravity:gz=-9810' (where the fit begins), a rung each; 'auto': what a diagnosis names;
    'residual': the same or, where no effect explains the measurements, a force, springs, growth or another
    stiffness in one place, if the forecast of held-out probes gains by it.
    Settings: those of identify() and diagnose().

    `threads`: all cores where None; they change no number. `progress`: a function of (what, fraction in [0, 1]), or True
    for a bar where tqdm is installed; what it raises ends the work, as Ctrl-C does. `settings`: those of case.yaml by
    their last name, in its units; palpate.effects and `palpate run --help` tell more.
    """
    pairs = settings_of(
        ("Identification",), settings, ("volume.edge_length", "diagnose.gravity", "diagnose.false_claims")
    )
    automatic, residual = add == "auto", add == "residual"
    names = [] if automatic or residual else words_of(add, "add")
    if not (automatic or residual or names):
        raise InvalidInput("add: names no effect; give effects as 'gravity' or 'gravity:gz=-9810', 'auto' or 'residual'")
    _require_body(body, ("", "reference", "skeleton"))
    with calling(threads, seed, force, progress) as call:
        text, result, model, identified, notes = _core.improve(
            _model(model), _set(set, call), output or "", names, automatic, residual, body, pairs, call
        )
    return Ladder(text, result, model, identified, notes)


def _require_body(body, allowed):
    if body not in allowed:
        raise InvalidInput(f"body: is {body!r}, must be 'reference' or 'skeleton'")


def simulate(model, probes, *, posterior=None, draws=32, threads=None, progress=None):
    """Equilibria of a model under the loads of a Set, of a set's folder or of a probes.csv [mm, N].

    `posterior`: a folder of particles.csv or an Identification, for intervals; None: that of the model, where it is an
    Identification or lies beside it. The result's `displacement` is (states, vertices, 3) [mm], `sd` of a coordinate
    (states, vertices) [mm] or None, `largest` (states,) [mm] with its 95 % `interval` (states, 2) [mm].
    """
    draws = whole(draws, "draws", 0, _MOST_DRAWS)
    with calling(threads, None, False, progress) as call, tempfile.TemporaryDirectory(prefix="palpate-") as folder:
        own = model
        if posterior is None and isinstance(model, (str, os.PathLike)) and draws > 0:
            beside = Path(model).parent
            posterior = beside if (beside / "particles.csv").exists() else None
        if posterior is None and isinstance(model, _core.Identification) and draws > 0:
            posterior = model
        if isinstance(posterior, _core.Identification):
            posterior.write(folder, True)
            posterior = folder
        given = _model(own)
        if isinstance(probes, _core.Set):
            found = _core.forecast_set(given, probes, posterior or "", draws, call)
        elif isinstance(probes, (str, os.PathLike)) and not Path(probes).is_dir():
            found = _core.forecast(given, probes, posterior or "", draws, call)
        else:
            found = _core.forecast_set(given, _set(probes, call), posterior or "", draws, call)
    return Simulation(given, *found)


def with_effect(model, name, **numbers):
    """Another model with an effect of the catalogue in force, by its numbers in our units: gravity, gx=0, gy=0, gz=-9810."""
    if not isinstance(name, str):
        raise TypeError(f"name: is a {type(name).__name__}, must be the name of an effect; palpate.effects() lists them")
    return model._with_effect(name, {key: real(value, f"effect '{name}': {key}") for key, value in numbers.items()})


def effects(name=None):
    """The catalogue of effects that a model may lack, or one of them: meaning, parameters with units, what reveals it."""
    with calling(1) as call:
        result = _core.effects(name or "", call)[1]
    return result if name else result["effects"]


def effect(name, parameters, *, acts_on="surface", meaning="An effect of one's own."):
    """Makes a function an effect of the catalogue, for this process: to be diagnosed, added and played::

        @palpate.effect("bed", {"stiffness": ("N/mm^3", 1e-4)})
        def bed(X, x, stiffness):
            u = x - X
            return stiffness / 2 * u @ u, stiffness * u, stiffness * np.eye(3)

    It is a potential of a point at `x` (3) [mm] that rests at `X` (3) [mm], per area ('surface') [N mm/mm^2] or per mass
    ('material') [N mm/tonne]: (energy, gradient (3), hessian (3, 3)) by x. `parameters`: unit and prior sd of each; all 0
    must be no effect. It may be called from any thread. For trying out: each call takes the interpreter's lock, so it is
    hundreds of times slower than an effect in C++ (samples/own-effect).
    """
    for value in parameters.values():
        if not (isinstance(value, tuple) and len(value) == 2):
            raise TypeError(f"parameters: is {parameters!r}, must be {{name: (unit, prior_sd)}}")
    told = [(number, unit, float(sd)) for number, (unit, sd) in parameters.items()]

    def register(function):
        _core.register_effect(name, function, told, acts_on, meaning)
        return function

    return register


def export(model, file, to=None, *, force=False):
    """Writes a model for other programs. `to`: gltf, sofa, chai3d, stl or vtp; None: as the file's name tells."""
    kinds = {".glb": "gltf", ".gltf": "gltf", ".stl": "stl", ".vtp": "vtp", ".scn": "sofa", ".py": "sofa"}
    to = to or kinds.get(Path(file).suffix)
    if to is None:
        raise InvalidInput(f"{file}: its name tells no format; say to='gltf', 'sofa', 'chai3d', 'stl' or 'vtp'")
    with calling(1, None, force) as call, as_path(_model(model), _MODEL) as path:
        _core.export_model(path, file, to, call)
