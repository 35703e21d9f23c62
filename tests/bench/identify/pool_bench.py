#!/usr/bin/python3
"""Thirty bars of one kind, a third of them poorly read: pool_bench.py PROGRAM -o FOLDER [--specimens N] [--seed N]

Young's moduli are log-normal. Each bar is probed, calibrated in finite elements, and all are pooled. Prints a table of
the population's mean and spread against those that were drawn, and what pooling does to the errors of the poorly read.
"""

import argparse
import json
import math
import random
import statistics
import subprocess
from pathlib import Path

bar = Path(__file__).resolve().parents[3] / "samples/plan/bar.stl"
mean, spread = math.log(0.1), 0.2  # of ln E [MPa]
well, poorly = (6, 30, 0.01), (3, 8, 2.0)  # probes, markers, noise [mm]; the bar moves by some 0.8 mm


def rms(values):
    return math.sqrt(statistics.fmean(v * v for v in values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--specimens", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()

    def palpate(*words):
        subprocess.run([told.program.resolve(), *map(str, words), "-q", "--threads", "1"], check=True, stdout=subprocess.DEVNULL)

    told.output.mkdir(parents=True, exist_ok=True)
    drawn = random.Random(told.seed)
    truth, runs = {}, []
    for i in range(told.specimens):
        name = f"bar{i:02}"
        log_young = drawn.gauss(mean, spread)
        probes, markers, noise = poorly if i % 3 == 0 else well
        a_set, run = told.output / f"{name}-set", told.output / name
        palpate("probe", bar, "-o", a_set, "--hide", "none", "--young", f"{math.exp(log_young):.6g}", "--probes", probes,
                "--markers", markers, "--noise", noise, "--seed", told.seed * 1000 + i, "--edge-length", 6)
        palpate("run", a_set, "-o", run, "--parameters", "uniform", "--edge-length", 8)
        truth[name] = log_young, i % 3 == 0
        runs.append(run)
    palpate("pool", *runs, "-o", told.output / "population", "--force")

    numbers = json.loads((told.output / "population/population.json").read_text())["numbers"]
    young = next(n for n in numbers if n["name"] == "young")
    moduli = [t for t, _ in truth.values()]
    print("| | drawn | found (95 %) |\n| --- | --- | --- |")
    print(f"| mean [MPa] | {math.exp(statistics.fmean(moduli)):.4f} | {young['mean']['value']:.4f} ({young['mean']['low']:.4f} to {young['mean']['high']:.4f}) |")
    print(f"| spread | {statistics.stdev(moduli):.3f} | {young['spread']['value']:.3f} ({young['spread']['low']:.3f} to {young['spread']['high']:.3f}) |")
    for kind, of_kind in (("well read", False), ("poorly read", True)):
        some = [s for s in young["specimens"] if truth[s["run"]][1] == of_kind]
        error = {key: rms(math.log(s[key]["value"]) - truth[s["run"]][0] for s in some) for key in ("own", "pooled")}
        inside = {key: sum(s[key]["low"] <= math.exp(truth[s["run"]][0]) <= s[key]["high"] for s in some) for key in ("own", "pooled")}
        print(f"\n{kind}: rms error of ln E {error['own']:.3f} by themselves, {error['pooled']:.3f} among the others; "
              f"{inside['own']} and {inside['pooled']} of {len(some)} inside their 95 %")
    print("unlike the others:", ", ".join(s["run"] for s in young["specimens"] if s["outlying"]) or "none")


if __name__ == "__main__":
    main()
