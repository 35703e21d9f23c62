#!/usr/bin/env bash
# Another solver as the reference, start to end: palpate plans the probes and writes the input, CalculiX computes, and
# what it computed becomes a measurement set. Into the input goes a load that nobody tells palpate: it is to be named.
#
#   samples/own-solver/own_solver.sh [CASE]        that of samples/plan
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
case=${1:-$here/../plan/case.yaml}
palpate=${PALPATE:-$here/../../build/palpate}
out=${OUT:-runs/own-solver}
command -v ccx >/dev/null || { echo "CalculiX is needed: apt-get install calculix-ccx" >&2; exit 3; }

"$palpate" probe "$case" --to inp --probes "${PROBES:-8}" --force --quiet -o "$out/deck"
# A tenth of gravity, in every step; probes.csv beside it does not say so.
sed -i 's/^\*NODE FILE/*DLOAD\nEBODY, GRAV, 981., 0., 0., -1.\n*NODE FILE/' "$out/deck/body.inp"
(cd "$out/deck" && ccx body >ccx.log)
"$palpate" probe "$case" --from "$out/deck" --force --quiet -o "$out/set"
cp "$here/expected.yaml" "$out/case.yaml"
"$palpate" run "$out/case.yaml" -o "$out/run"
