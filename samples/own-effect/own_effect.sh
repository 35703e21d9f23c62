#!/usr/bin/env bash
# An effect of one's own, start to end: palpate is built with embedding.cpp, hides the effect in a set, and names it.
#
#   samples/own-effect/own_effect.sh
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
build=${BUILD:-$root/build}
out=${OUT:-runs/own-effect}

cmake -S "$root" -B "$build" -DPALPATE_OWN_EFFECTS="$here/embedding.cpp" >/dev/null
cmake --build "$build" --target palpate
"$build/palpate" effects embedding
"$build/palpate" probe "$here/../organ/organ.stl" -o "$out/blind" --hide embedding --force --quiet
cp "$here/expected.yaml" "$out/case.yaml"
"$build/palpate" run "$out/case.yaml" -o "$out/run"
