"""A problem of fem_bench by FEniCSx (python3-dolfinx 0.5) and PETSc: dolfinx_solve.py FOLDER [mumps|cholmod].

Reads nodes.f64, tetrahedra.i32, held.i32, loaded.i32, markers.i32 and material.txt; writes dolfinx.f64, displacements at
the markers for each load, and prints the seconds of each stage as JSON.
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

start = clock()
pc = PETSc.PC().create()
pc.setOperators(A)
pc.setType("cholesky")
pc.setFactorSolverType(package)
pc.setFactorSetUpSolverType()
pc.setUp()
factor = pc.getFactorMatrix()
stage("factor", start)


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


start = clock()
solve(loaded[:1])
stage("one", start)
start = clock()
rows = (3 * node[markers][:, None] + np.arange(3)).ravel()
answers = [solve(loaded[k:k + TOGETHER])[rows].T for k in range(0, len(loaded), TOGETHER)]
stage("loads", start)
np.vstack(answers).tofile(f"{folder}/dolfinx.f64")
print(json.dumps(seconds))
