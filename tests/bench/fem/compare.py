#!/usr/bin/env python3
"""fem_bench beside CalculiX (Debian's calculix-ccx) and FEniCSx (python3-dolfinx), on the same meshes in one run.

compare.py --bench build/fem_bench [--dolfinx-root DIR] [--loads 100] [--limit SECONDS] MESH ...

MESH: 5k-linear, 20k-quadratic, ... FEniCSx may live in a Debian tree of its own (debootstrap), --dolfinx-root, which
needs root to enter; without it, it runs where it is installed. Prints a table: seconds of wall time, memory, and the
largest difference of displacements from ours, as a share of the load's largest.
"""
import argparse
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
from array import array

HERE = pathlib.Path(__file__).resolve().parent


class NotDone(Exception):
    """Why a command gave no figures, in the words of the table."""


def measured(command, limit, **options):
    """Output, wall seconds and peak memory [GB] of a command. Raises NotDone where it fails or takes over `limit`."""
    with tempfile.TemporaryFile("w+") as output:
        start = time.perf_counter()
        child = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, start_new_session=True, **options)
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.perf_counter() - start > limit:
                os.killpg(child.pid, signal.SIGKILL)
                os.wait4(child.pid, 0)
                child.returncode = -9
                raise NotDone(f"over {limit:.0f}")
            time.sleep(0.01)
        child.returncode = status
        wall = time.perf_counter() - start
        output.seek(0)
        text = output.read()
    if status:
        print(text[-2000:])
        how = f"killed by signal {os.WTERMSIG(status)}" if os.WIFSIGNALED(status) else "failed"
        raise NotDone(f"{how} after {wall:.0f}, with {usage.ru_maxrss * 1024e-9:.3g} GB")
    return text, wall, usage.ru_maxrss * 1024e-9


def displacements(file):
    values = array("d")
    values.frombytes(file.read_bytes())
    return values


def of_calculix(file):
    """The rows of each "displacements" table."""
    values = array("d")
    for line in file.open():
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            values.extend(float(word) for word in words[1:])
    return values


def difference(ours, theirs, loads):
    if len(ours) != len(theirs):
        return float("nan")
    size = len(ours) // loads
    worst = 0.0
    for k in range(loads):
        a, b = ours[k * size:(k + 1) * size], theirs[k * size:(k + 1) * size]
        worst = max(worst, max(abs(x - y) for x, y in zip(a, b)) / max(abs(x) for x in a))
    return worst


def row(mesh, code, assemble, factor, load, all_loads, peak, off):
    cells = [mesh, code, assemble, factor, load, all_loads, peak, off]
    print("| " + " | ".join(cell if isinstance(cell, str) else f"{cell:.3g}" for cell in cells) + " |", flush=True)


def ours(args, mesh, folder):
    command = [args.bench, "--only", mesh, "--folder", folder, "--loads", str(args.loads), "--memory", str(args.memory)]
    found = measured(command, args.limit)
    words = found[0].splitlines()[-1].replace(" GB", "").replace("CG ", "CG_").split()
    assemble, analyse, factor, size, _, load, everything, peak = words[3:]
    row(mesh, "palpate" + (f" ({size})" if size.startswith("CG") else ""), assemble, float(analyse) + float(factor),
        load, everything, float(peak), "")
    return displacements(folder / mesh / "ours.f64")


def calculix(args, mesh, folder, reference):
    environment = dict(os.environ, OMP_NUM_THREADS=str(args.threads))
    # One load alone first: what each further one takes is the rest over their number.
    lines = (folder / mesh / "green.inp").read_text().splitlines(keepends=True)
    first = next(k for k, line in enumerate(lines) if line.startswith("*CLOAD")) + 1
    (folder / mesh / "one.inp").write_text("".join(lines[:first + 1] + lines[first + args.loads:]))
    one = measured(["ccx", "-i", "one"], args.limit, cwd=folder / mesh, env=environment)
    try:
        found = measured(["ccx", "-i", "green"], args.limit, cwd=folder / mesh, env=environment)
    except NotDone as why:
        raise NotDone(f"one load {one[1]:.3g}, {args.loads} {why}") from why
    off = difference(reference, of_calculix(folder / mesh / "green.dat"), args.loads)
    row(mesh, "CalculiX", "", "", (found[1] - one[1]) / (args.loads - 1), found[1], found[2], off)


def dolfinx(args, mesh, folder, reference, package):
    inside, command = folder / mesh, ["python3", str(HERE / "dolfinx_solve.py"), str(folder / mesh), package]
    if args.dolfinx_root:
        inside = args.dolfinx_root / "tmp" / "palpate_bench" / mesh
        shutil.copytree(folder / mesh, inside, dirs_exist_ok=True)
        shutil.copy(HERE / "dolfinx_solve.py", inside)
        place = pathlib.Path("/") / inside.relative_to(args.dolfinx_root)
        command = ["chroot", str(args.dolfinx_root), "python3", str(place / "dolfinx_solve.py"), str(place), package]
    threads = str(args.threads)
    environment = dict(os.environ, OMP_NUM_THREADS=threads, OPENBLAS_NUM_THREADS=threads)
    found = measured(command, args.limit, env=environment)
    stages = json.loads(found[0].splitlines()[-1])
    off = difference(reference, displacements(inside / "dolfinx.f64"), args.loads)
    everything = sum(stages[stage] for stage in ("assemble", "factor", "loads"))
    row(mesh, f"FEniCSx, {package}", stages["assemble"], stages["factor"], stages["loads"] / args.loads, everything, found[2], off)


def told(mesh, code, work):
    """What `work` returns; None where its command is not done, which makes a row."""
    try:
        return work()
    except NotDone as why:
        row(mesh, code, "", "", "", str(why), "", "")
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+")
    parser.add_argument("--bench", type=pathlib.Path, required=True)
    parser.add_argument("--dolfinx-root", type=pathlib.Path)
    parser.add_argument("--without-calculix", action="store_true")
    parser.add_argument("--packages", nargs="*", default=["mumps", "cholmod"], help="of PETSc's, for FEniCSx: also gamg")
    parser.add_argument("--loads", type=int, default=100)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--memory", type=float, default=0, help="that our factor may take [GB]; 0: as it decides")
    parser.add_argument("--limit", type=float, default=400, help="seconds that a code may take")
    args = parser.parse_args()
    print("| mesh | code | assemble [s] | analyse, factor [s] | a load [s] | all [s] | peak [GB] | differs by |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for mesh in args.meshes:
            place = pathlib.Path(folder)
            reference = told(mesh, "palpate", lambda: ours(args, mesh, place))
            if reference is None:
                continue
            if not args.without_calculix:
                told(mesh, "CalculiX", lambda: calculix(args, mesh, place, reference))
            for package in args.packages:
                told(mesh, f"FEniCSx, {package}", lambda: dolfinx(args, mesh, place, reference, package))


if __name__ == "__main__":
    main()
