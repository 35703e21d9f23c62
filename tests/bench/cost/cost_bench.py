#!/usr/bin/env python3
"""What `palpate check --cost` says of runs, and what they took: cost_bench.py PALPATE DATA FOLDER.

DATA has the folders meshes/ and hidden/. Runs that FOLDER has already are not run again. Writes a table.
"""
import json
import subprocess
import sys
from pathlib import Path

SAMPLES = Path(__file__).resolve().parents[3] / "samples"
PALPATE, DATA, FOLDER = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(sys.argv[3])
ORGAN, ELL, FINGER, KIDNEY = SAMPLES / "organ/organ.stl", *(DATA / f"hidden/{body}-none/rest.stl" for body in ("ell", "finger", "kidney"))
CASES = [
    (SAMPLES / "plan/bar.stl", ""), (FINGER, ""), (ELL, "--spheres 40"), (KIDNEY, "--spheres 60 --probes 120"),
    (KIDNEY, "--spheres 200"), (FINGER, "--spheres 300 --probes 30"), (ELL, "--edge-length 2.5 --spheres 80 --probes 100"),
    (ORGAN, "--edge-length 5 --spheres 60"), (ORGAN, "--edge-length 4 --spheres 20 --probes 20"), (ORGAN, "--spheres 300 --probes 100"),
    (ORGAN, "--spheres 60 --probes 40 --markers 600"), (DATA / "meshes/starfish.stl", "--longest 100"), (DATA / "meshes/liver2.obj", "--longest 150"),
    (DATA / "meshes/angle_block.STL", ""), (ELL, "--spheres 80 --probes 30"), (DATA / "meshes/plate_holes.STL", ""),
    (FINGER, "--edge-length 1.6 --probes 30"), (DATA / "meshes/octagonal_pocket.stl", ""), (DATA / "meshes/idler_riser.STL", "--spheres 120"),
    *((DATA / "hidden" / name, "") for name in ("ell-gravity", "finger-none", "kidney-stiffening", "finger-plasticity", "ell-none-large", "kidney-viscosity")),
    (SAMPLES / "dragonskin-beam", ""),
]


def measured(number, case, flags):
    run = FOLDER / str(number)
    if not (run / "run.json").exists():
        subprocess.run([PALPATE, "run", case, *flags.split(), "-o", run, "--threads", "1", "-q"], stdout=subprocess.DEVNULL, check=False)
    return json.loads((run / "run.json").read_text())["stages"]


def told(case, flags):
    answer = subprocess.run([PALPATE, "check", case, *flags.split(), "--cost", "--threads", "1", "--json", "-q"], capture_output=True, text=True, check=True)
    return json.loads(answer.stdout)["cost"]


def main():
    print("| run | stage | told [s] | took [s] | told [GB] | took [GB] |\n| --- | --- | --- | --- | --- | --- |")
    seconds, gigabytes, whole = [], [], []
    for number, (case, flags) in enumerate(CASES):
        stages, cost = measured(number, case, flags), told(case, flags)
        name = " ".join([case.name if case.name != "rest.stl" else case.parent.name.split("-")[0], flags]).strip()
        for stage in cost["stages"]:
            took = stages.get(stage["stage"])
            if took is None:
                continue
            most = f" to {stage['most_seconds']:.2g}" if stage["most_seconds"] > stage["seconds"] else ""
            print(f"| {name} | {stage['stage']} | {stage['seconds']:.2g}{most} | {took['seconds']:.2g} | {stage['gigabytes']:.2g} | {took['peak_memory_mb'] / 1000:.2g} |")
            seconds.append((stage["stage"], stage["seconds"] / took["seconds"]))
            gigabytes.append(stage["gigabytes"] / (took["peak_memory_mb"] / 1000))
        whole.append(cost["seconds"] / sum(stage["seconds"] for stage in stages.values()))
    within = lambda ratios: f"{sum(0.5 <= r <= 2 for r in ratios)} of {len(ratios)}"
    for stage in dict(seconds):
        print(f"\nwithin a factor of two, {stage}: {within([r for s, r in seconds if s == stage])}", end="")
    print(f"\nwhole runs: {within(whole)}; memory of stages: {within(gigabytes)}")


main()
