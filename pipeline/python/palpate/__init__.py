"""Palpate: from a mesh to a calibrated real-time model.

Units everywhere: mm, N, MPa, N/mm, N*mm/rad, s, tonne; densities in kg/m^3. Functions do what the program's commands of
their names do, with the same numbers to the last digit; they take paths or objects. Arrays of objects are views of
their own memory and cannot be written to. What you can mend is an `InvalidInput`, a computation without a result a
`SolverFailure`. Messages go to `logging.getLogger("palpate")`. ::

    import palpate
    run = palpate.run("samples/dragonskin-beam/case.yaml")
    print(run.diagnosis)
"""

from . import _exchange, _functions, _html, _sets
from ._core import Body, Identification, Mesh, Model, Posterior, Set, Surface
from ._core import version as __version__
from ._functions import check, compare, diagnose, effect, effects, export, identify, improve, mesh, probe, run, simulate
from ._functions import skeleton
from ._results import Check, Comparison, Diagnosis, Ladder, Simulation
from ._run import Run
from .errors import Error, FileError, InvalidInput, LimitReached, SolverFailure

Set.read = staticmethod(_sets.read)
Set.from_arrays = staticmethod(_sets.from_arrays)
Set.to_frame = _exchange.set_frame
Set.to_xarray = _exchange.set_dataset
Set.__repr__ = lambda self: (
    f"<palpate.Set {self.name!r}: {len(self.probes)} states, {len(self.markers)} markers>"
)
Model.with_effect = _functions.with_effect
Model.to_frame = _exchange.model_frame
Model.__repr__ = lambda self: f"<palpate.Model {self.name!r}: {len(self.centers)} spheres, {len(self.links)} links>"
Model._repr_html_ = _html.model
Posterior.to_frame = _exchange.posterior_frame
Posterior.resampled = _exchange.resampled
Posterior.to_arviz = _exchange.inference_data
Posterior.__repr__ = lambda self: f"<palpate.Posterior: {len(self.parameters)} parameters, {len(self.draws)} draws>"
Identification.__repr__ = lambda self: f"<palpate.Identification of {len(self.posterior.parameters)} parameters>"
Identification._repr_html_ = _html.words
for _kind in (Surface, Mesh):
    _kind.to_meshio = _exchange.to_meshio
    _kind.to_pyvista = _exchange.to_pyvista
Surface.from_meshio = staticmethod(_exchange.surface_from_meshio)
Surface.from_pyvista = staticmethod(_exchange.surface_from_pyvista)
Mesh.from_meshio = staticmethod(_exchange.mesh_from_meshio)
Mesh.from_pyvista = staticmethod(_exchange.mesh_from_pyvista)
Surface.__repr__ = lambda self: f"<palpate.Surface: {len(self.vertices)} vertices, {len(self.triangles)} triangles>"
Mesh.__repr__ = lambda self: f"<palpate.Mesh: {len(self.nodes)} nodes, {len(self.tetrahedra)} tetrahedra>"
for _kind in (Body, Identification, Mesh, Model, Posterior, Set, Surface):
    _kind.__module__ = "palpate"
Body.__repr__ = lambda self: "<palpate.Body, closed>" if self.closed else "<palpate.Body>"

__all__ = [
    "Body", "Check", "Comparison", "Diagnosis", "Error", "FileError", "Identification", "InvalidInput", "Ladder",
    "LimitReached", "Mesh", "Model", "Posterior", "Run", "Set", "Simulation", "SolverFailure", "Surface", "check",
    "compare", "diagnose", "effect", "effects", "export", "identify", "improve", "mesh", "probe", "run", "simulate",
    "skeleton",
]  # fmt: skip
