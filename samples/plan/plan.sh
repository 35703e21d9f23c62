#!/usr/bin/env bash
# What to measure before anyone goes to the lab: rehearses campaigns of ever more probes and markers on finite elements,
# reads them with the noise of the lab's camera, fits the skeleton to each, and judges them all by the same other probes.
#
#   samples/plan/plan.sh [CASE [NOISE_MM]]        the case here, and 0.05 mm
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
case=${1:-$here/case.yaml}
noise=${2:-0.05}
palpate=${PALPATE:-$here/../../build/palpate}
out=${OUT:-runs/plan}
read -ra probes <<<"${PROBES:-3 6 12 24}"
read -ra markers <<<"${MARKERS:-6 60}"
quietly() { "$palpate" "$@" --quiet --force; }

quietly skeleton "$case" -o "$out/model.json" >/dev/null
quietly probe "$case" --seed 99 --probes 20 --markers 200 -o "$out/judge" >/dev/null
echo "probes,markers,informed,parameters,rms_mm,relative" >"$out/plan.csv"
for p in "${probes[@]}"; do
  for m in "${markers[@]}"; do
    run="$out/p$p-m$m"
    # as a lab reads it: markers alone, no full fields
    quietly probe "$case" --hide none --probes "$p" --markers "$m" --noise "$noise" -o "$run/set" >/dev/null
    quietly identify "$out/model.json" "$run/set" --json -o "$run/fit" >"$run/identify.json"
    quietly compare "$run/fit/model.json" "$out/judge" --no-reference --json -o "$run/compare" >"$run/compare.json"
    python3 - "$p" "$m" "$run" >>"$out/plan.csv" <<'PY'
import json, sys
probes, markers, run = sys.argv[1:]
fit, judged = (json.load(open(f"{run}/{name}.json")) for name in ("identify", "compare"))
error = judged["error"]
print(probes, markers, fit["informed"], fit["parameters"], f'{error["rms_mm"]:.4f}', f'{error["relative"]:.3f}', sep=",")
PY
  done
done
python3 - "$out/plan.csv" <<'PY'
import csv, sys
for row in csv.reader(open(sys.argv[1])):
    print(*(cell.rjust(10) for cell in row))
PY
