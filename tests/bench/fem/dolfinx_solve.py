"""A problem of fem_bench by FEniCSx (python3-dolfinx 0.5) and PETSc: dolfinx_solve.py FOLDER [mumps|cholmod|gamg].

Reads nodes.f64, tetrahedra.i32, held.i32, loaded.i32, markers.i32 and material.txt; writes dolfinx.f64, displacements at
the markers for each load, and prints the seconds of each stage as JSON. gamg: conjugate gradients with PETSc's
multigrid of smoothed aggregation and rigid-body modes, load by load; the others factor.
"""
import json
import sys
import time

import numpy as np
import ufl
from dolfinx import fem, mesh
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

TOGETHER = 64  # right-hand sides

folder, package = sys.argv[1], (sys.argv[2:] or ["mumps"])[0]
read = lambda name, kind: np.fromfile(f"{folder}/{name}", kind)
young, poisson, width = np.loadtxt(f"{folder}/material.txt")
nodes = read("nodes.f64", np.float64).reshape(-1, 3)
corners = read("tetrahedra.i32", np.int32).reshape(-1, int(width))[:, :4].astype(np.int64)
held, loaded, markers = (read(f"{name}.i32", np.int32) for name in ("held", "loaded", "markers"))
seconds, clock = {}, time.perf_counter


def stage(name, since):
    seconds[name] = round(clock() - since, 4)


# Straight elements: the corners make the mesh, the midsides come with the quadratic space.
start = clock()
used = np.unique(corners)
domain = mesh.create_mesh(MPI.COMM_WORLD, np.searchsorted(used, corners), nodes[used],
                          ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1)))
V = fem.VectorFunctionSpace(domain, ("Lagrange", 2 if width == 10 else 1))
stage("mesh", start)

# Our nodes among theirs, by place.
keys = lambda x: np.lexsort(np.round(x, 6).T)
node = np.empty(len(nodes), np.int64)
node[keys(nodes)] = keys(V.tabulate_dof_coordinates()[:len(nodes)])

start = clock()
mu, lam = young / 2 / (1 + poisson), young * poisson / (1 + poisson) / (1 - 2 * poisson)
u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
strain = lambda w: ufl.sym(ufl.grad(w))
a = fem.form((2 * mu * ufl.inner(strain(u), strain(v)) + lam * ufl.div(u) * ufl.div(v)) * ufl.dx)
stage("compile", start)
start = clock()
clamp = fem.dirichletbc(np.zeros(3), node[held].astype(np.int32), V)
A = assemble_matrix(a, bcs=[clamp])
A.assemble()
A.setOption(PETSc.Mat.Option.SPD, True)
stage("assemble", start)


def rigid_modes():
    """Orthonormal, as vectors of A's unknowns."""
    x = V.tabulate_dof_coordinates()
    modes = np.zeros((6, x.shape[0], 3))
    for c in range(3):
        modes[c, :, c] = 1
        modes[3 + c] = np.cross(np.eye(3)[c], x - x.mean(axis=0))
    basis = np.linalg.qr(modes.reshape(6, -1).T)[0]
    return [PETSc.Vec().createWithArray(np.ascontiguousarray(column), bsize=3) for column in basis.T]


def by_factor():
    pc = PETSc.PC().create()
    pc.setOperators(A)
    pc.setType("cholesky")
    pc.setFactorSolverType(package)
    pc.setFactorSetUpSolverType()
    pc.setUp()
    factor = pc.getFactorMatrix()

    def solve(loads):
        size = A.getSize()[0]
        B = PETSc.Mat().createDense([size, len(loads)], comm=MPI.COMM_WORLD)
        B.setUp()
        X = B.duplicate()
        dense = np.zeros((size, len(loads)), order="F")
        dense[3 * node[loads] + 2, np.arange(len(loads))] = 1
        B.getDenseArray()[:] = dense
        B.assemble()
        X.assemble()
        factor.matSolve(B, X)
        return X.getDenseArray()

    return solve


def by_multigrid():
    A.setNearNullSpace(PETSc.NullSpace().create(vectors=rigid_modes()))
    ksp = PETSc.KSP().create(MPI.COMM_WORLD)
    ksp.setType("cg")
    ksp.setTolerances(rtol=1e-10, max_it=1000)
    ksp.setOperators(A)
    ksp.getPC().setType("gamg")
    ksp.setUp()

    def solve(loads):
        answers = np.zeros((A.getSize()[0], len(loads)))
        b, x = A.createVecs()
        for k, at in enumerate(loads):
            b.set(0)
            b[3 * node[at] + 2] = 1
            b.assemble()
            ksp.solve(b, x)
            assert ksp.getConvergedReason() > 0, ksp.getConvergedReason()
            answers[:, k] = x.array
        return answers

    return solve


start = clock()
solve = by_multigrid() if package == "gamg" else by_factor()
stage("factor", start)

start = clock()
solve(loaded[:1])
stage("one", start)
start = clock()
rows = (3 * node[markers][:, None] + np.arange(3)).ravel()
answers = [solve(loaded[k:k + TOGETHER])[rows].T for k in range(0, len(loaded), TOGETHER)]
stage("loads", start)
np.vstack(answers).tofile(f"{folder}/dolfinx.f64")
print(json.dumps(seconds))
