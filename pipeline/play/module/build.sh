#!/usr/bin/env bash
# Compiles the runtime for browsers and leaves it here, with the sums of all that it is made of:
#
#   pipeline/play/module/build.sh        needs Debian's emscripten, cmake and ninja-build; takes some minutes
#
# palpate.wasm.gz.base64 is the module, palpate.js what loads it, made_of.txt the SHA-256 of both and of their sources.
# The program takes them as they lie here: who builds it needs no emscripten. The test pipeline.play_module fails where a
# source has changed since.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
build=${1:-$root/build/play-module}
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}  # where Debian has what emscripten's optimiser needs

emcmake cmake -S "$here" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=None
cmake --build "$build"

cp "$build/palpate.js" "$here/palpate.js"
gzip -9 --no-name --stdout "$build/palpate.wasm" | base64 --wrap=0 >"$here/palpate.wasm.gz.base64"

# All sources and headers of ours, as the compiler tells them.
cd "$root"
{
  git ls-files "*sources.cmake"
  echo pipeline/play/module/CMakeLists.txt
  echo pipeline/play/module/build.sh
  echo pipeline/play/module/palpate.js
  echo pipeline/play/module/palpate.wasm.gz.base64
  ninja -C "$build" -t deps | sed -n "s|^    $root/||p" | grep -v "^build/"
} | sort -u | xargs sha256sum >"$here/made_of.txt"
echo "$(wc -c <"$build/palpate.wasm") bytes of module, made of $(wc -l <"$here/made_of.txt") files"
