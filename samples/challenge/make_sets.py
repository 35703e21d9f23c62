#!/usr/bin/python3
"""Makes the challenge's sets: make_sets.py --secret TEXT -o FOLDER [--sets 1,2,17] [--palpate PROGRAM]

sets.csv tells league, body, what may be hidden, and how the body is probed. The secret draws what is hidden and the
seed, so that whoever has the table cannot tell. Every set is FOLDER/sets/ID with model.json (the start), set/ (what may
be fitted) and held_out/probes.csv (loads whose readings are to be forecast). FOLDER/commitments.json is published with
them; FOLDER/keys.json opens the truths. "foreign code" needs CalculiX (ccx).
"""

import argparse
import csv
import hashlib
import hmac
import json
import math
import random
import re
import shutil
import subprocess
from pathlib import Path

from sealing import seal

here = Path(__file__).resolve().parent
root = here.parents[1]


def drawn(secret, name, choices):
    """What a set hides, and its seed."""
    number = int.from_bytes(hmac.new(secret.encode(), name.encode(), hashlib.sha256).digest()[:8], "big")
    return choices[number % len(choices)], number // len(choices) % 100000


def run(*command, **more):
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL, **more)


def by_calculix(palpate, row, folder, hidden, seed):
    """CalculiX computes the body; a tenth of gravity acts in it or nothing does."""
    deck = folder / "deck"
    options = [word for word in row["options"].split()]
    markers = options[options.index("--markers") + 1]
    at = options.index("--markers")
    run(palpate, "probe", root / row["body"], "--to", "inp", *options[:at], *options[at + 2 :], "--seed", seed, "-q", "-o", deck)
    if hidden == "gravity":
        text = (deck / "body.inp").read_text()
        load = "*DLOAD\nEBODY, GRAV, 981., 0., 0., -1.\n*NODE FILE"
        (deck / "body.inp").write_text(text.replace("*NODE FILE", load))
    run("ccx", "body", cwd=deck)
    readings = ["--markers", markers, "--noise", "0.02", "--seed", seed]  # [mm], about a hundredth of what is displaced
    run(palpate, "probe", root / row["body"], "--from", deck, *readings, "-q", "-o", folder / "set")
    shutil.rmtree(deck)
    shutil.rmtree(folder / "set" / "field")  # a full field would tell more than markers do


def table(path):
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    return lines[0], lines[1:]


def hold_out(folder, seed):
    """Takes the readings of a fifth of the loaded probes out of the set; they are returned, to be sealed. Their loads stay:
    the body bore them, and one that yields remembers them."""
    head, loads = table(folder / "set" / "probes.csv")
    force = [head.split(",").index(axis) for axis in ("fx", "fy", "fz")]
    loaded = sorted({line.split(",")[0] for line in loads if any(float(line.split(",")[i]) for i in force)}, key=int)
    held = set(random.Random(seed).sample(loaded, math.ceil(len(loaded) / 5)))
    (folder / "held_out").mkdir()
    (folder / "held_out" / "probes.csv").write_text("\n".join([head] + [x for x in loads if x.split(",")[0] in held]) + "\n")
    head, readings = table(folder / "set" / "positions.csv")
    kept = [line for line in readings if line.split(",")[0] not in held]
    (folder / "set" / "positions.csv").write_text("\n".join([head] + kept) + "\n")
    rows = csv.DictReader([head] + [line for line in readings if line.split(",")[0] in held])
    return [[row["probe"], float(row["time"]), row["marker"], *(float(row[a]) if row[a] else None for a in "xyz")] for row in rows]


def noise_of(folder):
    found = re.search(r"position: *([0-9.e-]+)", (folder / "set" / "set.yaml").read_text())
    return float(found.group(1)) if found else None


def make(palpate, row, secret, folder):
    """One set; its truth is returned."""
    hidden, seed = drawn(secret, row["id"], row["hides"].split("|"))
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    body, model = root / row["body"], folder / "model.json"
    if row["league"] == "measured":
        shutil.copytree(body, folder / "set", ignore=shutil.ignore_patterns("*.png", "*.md", "case.yaml"))
    elif row["league"] == "foreign code":
        by_calculix(palpate, row, folder, hidden, seed)
    elif row["league"] == "twins":
        run(palpate, "skeleton", body, "-q", "-o", model)
        run(palpate, "probe", model, "--hide", hidden, *row["options"].split(), "--seed", seed, "-q", "-o", folder / "set")
    else:
        run(palpate, "probe", body, "--hide", hidden, *row["options"].split(), "--seed", seed, "-q", "-o", folder / "set")
    if not model.exists():
        run(palpate, "skeleton", folder / "set" / "set.yaml", "-q", "-o", model)
    (folder / "set" / "truth.json").unlink(missing_ok=True)
    truth = {"effects": [] if hidden == "none" else [hidden], "noise_mm": noise_of(folder), "held_out": []}
    if row["league"] != "second format":
        truth["held_out"] = hold_out(folder, seed)
    return truth


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--secret", required=True)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--sets", help="ids, all by default")
    parser.add_argument("--palpate", default=str(root / "build" / "palpate"))
    told = parser.parse_args()
    rows = list(csv.DictReader((here / "sets.csv").open()))
    if told.sets:
        wanted = [name.zfill(2) for name in told.sets.split(",")]
        unknown = set(wanted) - {row["id"] for row in rows}
        if unknown:
            parser.error(f"sets.csv has no set {', '.join(sorted(unknown))}; there are 01 to {rows[-1]['id']}")
        rows = [row for row in rows if row["id"] in wanted]
    truths = {row["id"]: make(told.palpate, row, told.secret, told.output / "sets" / row["id"]) for row in rows}
    commitments, keys = seal(truths)
    for name, content in ("commitments", commitments), ("keys", keys), ("leagues", {row["id"]: row["league"] for row in rows}):
        (told.output / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
