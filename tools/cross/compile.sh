#!/usr/bin/env bash
# Compiles the C++ library for systems that this one is not, by the package ziglang: tools/cross/compile.sh [TARGET...]
# Targets are Zig's. The code of libraries is not linked, so their header files are those of `make wheels`.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
libraries=$root/build/wheels/libraries
export PATH="$root/.venv/bin:$PATH"
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi

mkdir -p build/cross
[ -e "$libraries/done" ] || { tools/wheels/libraries.sh "$libraries" && touch "$libraries/done"; }
[ $# -gt 0 ] || set -- aarch64-macos x86_64-macos x86_64-windows-gnu
for target in "$@"; do
  isa=x86-64-v3
  if [[ $target == aarch64-* ]]; then isa=armv8; fi
  build=build/cross/$target
  # Whether it compiles is asked, not how fast it runs.
  ZIG_TARGET=$target cmake -G Ninja -S . -B "$build" -DCMAKE_TOOLCHAIN_FILE="$root/tools/cross/zig.cmake" \
    -DCMAKE_MAKE_PROGRAM="$root/.venv/bin/ninja" -DCMAKE_PREFIX_PATH="$libraries" -DCMAKE_BUILD_TYPE=None \
    -DMANYHANDS_ISA=$isa -DMANYHANDS_UNITY=ON -DMANYHANDS_TESTS=OFF -DMANYHANDS_BENCHMARKS=OFF \
    -DMANYHANDS_EXAMPLES=OFF -DMANYHANDS_INSTALL=OFF -DMANYHANDS_WERROR=OFF "${launcher[@]}" >"$build.log"
  ZIG_TARGET=$target cmake --build "$build" -j "${JOBS:-$(nproc)}" >>"$build.log" || { tail -30 "$build.log"; exit 1; }
  echo "$target: $(ls "$build"/*.a | xargs -n1 basename | xargs)"
done
