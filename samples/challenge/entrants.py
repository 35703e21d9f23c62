#!/usr/bin/python3
"""Palpate and four baselines take part: entrants.py CHALLENGE -o RESULTS [--only NAME,...] [--palpate PROGRAM] [--edge-length MM]

  palpate       `palpate improve --auto`: diagnosis, and the effects that it names added to the identified model
  tuning        identification alone: what is done where no effect is thought of; its verdict is always "adequate"
  discrepancy   tuning, and a Gaussian process over what it leaves (Kennedy and O'Hagan 2001); it names nothing
  aic           Akaike's criterion over single effects on the skeleton
  sparse        regression of what tuning leaves on the effects' signatures, forward selection by the BIC
"""

import argparse
import csv
import json
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np

# Strengths at which the signatures of `sparse` are computed; parameters enter one by one, in proportion.
directions = {"gravity": [{"gx": 500.0}, {"gy": 500.0}, {"gz": 500.0}],
              "stiffening": [{"c2": 0.3, "c3": 0.0}],
              "anisotropy": [{"k": 0.3, "nx": 1.0, "ny": 0.0, "nz": 0.0}, {"k": 0.3, "nx": 0.0, "ny": 1.0, "nz": 0.0},
                             {"k": 0.3, "nx": 0.0, "ny": 0.0, "nz": 1.0}],
              "prestress": [{axis: 0.02} for axis in ("sxx", "syy", "szz", "sxy", "syz", "sxz")],
              "torsion": [{"torsion": 0.3}], "shear": [{"shear": 0.3}]}
names = {"gravity": ("gx", "gy", "gz"), "prestress": ("sxx", "syy", "szz", "sxy", "syz", "sxz")}


class Entry:
    """A set, and what palpate's commands say of it. Single threads, so that seconds compare."""

    def __init__(self, palpate, folder, scratch, edge_length):
        self.palpate, self.folder, self.scratch, self.edge_length = palpate, folder, scratch, edge_length
        self.held_out = folder / "held_out" / "probes.csv"

    def run(self, *command):
        words = [self.palpate, *map(str, command), "--threads", "1", "--seed", "1", "--force", "-q"]
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def identified(self, effects=()):
        """The model with effects in, its stiffnesses fitted to the set."""
        model = json.loads((self.folder / "model.json").read_text())
        model["effects"] = list(effects)
        start, out = self.scratch / "start.json", self.scratch / "identified"
        start.write_text(json.dumps(model))
        parameters = "uniform" if effects else "zones"
        self.run("identify", start, self.folder / "set", "--parameters", parameters, "-o", out)
        return out / "model.json"

    def played(self, model, probes, add=(), draws=0):
        out = self.scratch / "played"
        extra = [word for one in add for word in ("--add", one)]
        self.run("simulate", model, "--probes", probes, "--markers", self.folder / "set" / "markers.csv", *extra, "--draws", draws, "-o", out)
        return out / "positions.csv"

    def judged(self, body):
        """Arguments of the commands that judge the start model on a body."""
        size = ("--edge-length", self.edge_length) if self.edge_length and body == "reference" else ()
        return self.folder / "model.json", self.folder / "set", "--body", body, *size

    def diagnosis(self, body):
        out = self.scratch / f"diagnosed-{body}"
        self.run("diagnose", *self.judged(body), "-o", out)
        return json.loads((out / "diagnosis.json").read_text())

    def improved(self, body):
        out = self.scratch / "improved"
        self.run("improve", *self.judged(body), "--auto", "-o", out)
        return json.loads((out / "ladder.json").read_text()), out / "model.json"


def rows_of(path):
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    return list(csv.DictReader(lines))


def places(rows, wanted=None):
    """Rows by probe, time and marker -> (n x 3), in the order of `wanted`."""
    by_key = {(r["probe"], float(r["time"]), r["marker"]): [float(r[a]) if r[a] else np.nan for a in "xyz"] for r in rows}
    return np.array([by_key[key] for key in wanted]) if wanted else (list(by_key), np.array(list(by_key.values())))


def write_forecast(path, keys, means, half_widths):
    lines = ["probe,time,marker,x,y,z,within_95"]
    for (probe, at, marker), mean, width in zip(keys, means, half_widths):
        lines.append(f"{probe},{at:g},{marker}," + ",".join(f"{m:.6g}" for m in mean) + f",{width:.4g}")
    path.write_text("\n".join(lines) + "\n")


def answer(out, verdict, explanation=(), forecast=None):
    (out / "diagnosis.json").write_text(json.dumps({"verdict": verdict, "explanation": list(explanation)}) + "\n")
    if forecast:
        shutil.copy(forecast, out / "forecast.csv")


def forecast(entry, model):
    return entry.played(model, entry.held_out, draws=32) if entry.held_out.exists() else None


def as_effects(diagnosis, wanted):
    """What is named, as a model tells it; faults of the measurement are none of the model's."""
    found = [r for r in diagnosis["ranking"] if r["effect"] in wanted and r["kind"] == "body" and r["parameters"]]
    return [{"name": r["effect"], "parameters": {n: {"value": p["value"], "unit": p["unit"]} for n, p in r["parameters"].items()}} for r in found]


def palpate(entry, out, twin):
    """One command, as its users run it: what it names and what it leaves out of the skeleton count as named."""
    ladder, model = entry.improved("skeleton" if twin else "reference")
    named = ladder["steps"][-1]["effects"] + [one["effect"] for one in ladder["not_added"]]
    answer(out, "missing-effect" if named else ladder["verdict"], named, forecast(entry, model))


def tuning(entry, out, twin):
    answer(out, "adequate", (), forecast(entry, entry.identified()))


def aic(entry, out, twin):
    """Akaike: n log of the mean square over the noise's, plus twice the free numbers."""
    told = entry.diagnosis("skeleton")
    n = told["independent_readings"]
    score = {(): n * told["baseline"]["whitened_rms"] ** 2}
    for r in told["ranking"]:
        if r["whitened_rms"] is not None:
            score[(r["effect"],)] = n * r["whitened_rms"] ** 2 + 2 * len(r["parameters"])
    best = min(score, key=score.get)
    answer(out, "missing-effect" if best else "adequate", best, forecast(entry, entry.identified(as_effects(told, best))))


def inputs_of(entry, probes, keys):
    """What the discrepancy may depend on: where the marker is, where and how hard is pushed (n x 9), scaled to 1."""
    loads = {(r["probe"], float(r["time"])): r for r in rows_of(probes)}
    markers = {r["marker"]: [float(r[a]) for a in "xyz"] for r in rows_of(entry.folder / "set" / "markers.csv")}
    columns = ("x", "y", "z", "fx", "fy", "fz")
    return np.array([markers[m] + [float(loads[p, t][c]) for c in columns] for p, t, m in keys])


def discrepancy(entry, out, twin):
    """A Gaussian process over the residual of the tuned model; its length and size by maximum likelihood on a grid."""
    model = entry.identified()
    keys, read = places(rows_of(entry.folder / "set" / "positions.csv"))
    if not entry.held_out.exists():
        return answer(out, "adequate")
    probes = entry.folder / "set" / "probes.csv"
    residual = read - places(rows_of(entry.played(model, probes)), keys)
    seen = ~np.isnan(residual).any(axis=1)
    keys, residual = [k for k, s in zip(keys, seen) if s], residual[seen]
    played = rows_of(entry.played(model, entry.held_out))
    new_keys, means = places(played)
    fitted, new = inputs_of(entry, probes, keys), inputs_of(entry, entry.held_out, new_keys)
    scale = np.repeat([np.ptp(fitted[:, 3 * i : 3 * i + 3]) or 1.0 for i in range(3)], 3)
    squares = ((fitted[:, None] - fitted[None]) ** 2 / scale**2).sum(-1)
    best = None
    for length in (0.2, 0.5, 1.0, 2.0):
        K = np.exp(-0.5 * squares / length**2)
        for share in (1e-3, 1e-2, 1e-1, 1.0):  # of the noise in the variance
            L = np.linalg.cholesky(K + share * np.eye(len(K)))
            a = np.linalg.solve(L, residual)
            size = (a**2).mean()
            likelihood = -0.5 * residual.size * np.log(size) - 3 * np.log(np.diag(L)).sum()
            if best is None or likelihood > best[0]:
                best = likelihood, length, share, L, a, size
    _, length, share, L, a, size = best
    cross = np.exp(-0.5 * ((new[:, None] - fitted[None]) ** 2 / scale**2).sum(-1) / length**2)
    half = np.linalg.solve(L, cross.T)
    variance = size * np.maximum(1.0 + share - (half**2).sum(0), share)
    write_forecast(out / "forecast.csv", new_keys, means + half.T @ a, 1.96 * np.sqrt(variance))
    alone = -0.5 * residual.size * np.log((residual**2).mean())  # the residual as noise that nothing correlates
    bic = 2 * (best[0] - alone) - 2 * np.log(residual.size)
    answer(out, "unexplained" if bic > 10 else "adequate")


def sparse(entry, out, twin):
    model = entry.identified()
    keys, read = places(rows_of(entry.folder / "set" / "positions.csv"))
    probes = entry.folder / "set" / "probes.csv"
    if not entry.held_out.exists():
        return answer(out, "adequate")
    both = entry.scratch / "both.csv"  # one play for what was read and what is to be forecast
    both.write_text(probes.read_text().rstrip() + "\n" + "\n".join(entry.held_out.read_text().splitlines()[1:]) + "\n")
    all_keys, played = places(rows_of(entry.played(model, both)))
    ahead_of = {r["probe"] for r in rows_of(entry.held_out)}
    new_keys = [key for key in all_keys if key[0] in ahead_of]
    base, means = (np.array([dict(zip(all_keys, played))[k] for k in some]) for some in (keys, new_keys))
    residual = (read - base).ravel()
    seen = ~np.isnan(residual)
    columns, ahead = {}, {}
    for effect, cases in directions.items():
        for case in cases:
            numbers = dict.fromkeys(names.get(effect, ()), 0.0) | case
            add = [f"{effect}:" + ",".join(f"{n}={v}" for n, v in numbers.items())]
            try:
                rows = rows_of(entry.played(model, both, add))
            except subprocess.CalledProcessError:  # an effect that this model cannot play
                continue
            columns.setdefault(effect, []).append((places(rows, keys) - base).ravel()[seen])
            ahead.setdefault(effect, []).append((places(rows, new_keys) - means).ravel())
    n, r, chosen = seen.sum(), residual[seen], []

    def fit(effects):
        A = np.array([c for e in effects for c in columns[e]]).T.reshape(n, -1)
        x = np.linalg.lstsq(A, r, rcond=None)[0] if A.size else np.zeros(0)
        left = r - A @ x
        return n * np.log((left**2).mean()) + A.shape[1] * np.log(n), x, left.std()

    while len(chosen) < 3:
        better = min(((fit(chosen + [e])[0], e) for e in columns if e not in chosen), default=None)
        if better is None or better[0] > fit(chosen)[0] - 10:  # 10: "very strong" (Kass and Raftery 1995)
            break
        chosen.append(better[1])
    _, x, sd = fit(chosen)
    B = np.array([c for e in chosen for c in ahead[e]]).T.reshape(means.size, -1)
    write_forecast(out / "forecast.csv", new_keys, means + (B @ x).reshape(-1, 3), [1.96 * sd] * len(new_keys))
    answer(out, "missing-effect" if chosen else "adequate", chosen)


entrants = {f.__name__: f for f in (palpate, tuning, discrepancy, aic, sparse)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("challenge", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--only", default=",".join(entrants))
    parser.add_argument("--palpate", default=str(Path(__file__).resolve().parents[2] / "build" / "palpate"))
    parser.add_argument("--edge-length", type=float, help="of the bodies that judge [mm]; larger is faster and coarser")
    told = parser.parse_args()
    leagues = json.loads((told.challenge / "leagues.json").read_text())
    for who in told.only.split(","):
        for name, league in leagues.items():
            out = told.output / who / name
            shutil.rmtree(out, ignore_errors=True)
            out.mkdir(parents=True)
            scratch = out / "scratch"
            scratch.mkdir()
            began = time.monotonic()
            try:
                entrants[who](Entry(told.palpate, told.challenge / "sets" / name, scratch, told.edge_length), out, league == "twins")
            except subprocess.CalledProcessError as e:
                print(f"{who}, set {name}: {e.stderr.decode().strip()}")
            (out / "seconds").write_text(f"{time.monotonic() - began:.2f}\n")
            shutil.rmtree(scratch)


if __name__ == "__main__":
    main()
