#!/usr/bin/env bash
# Builds the C++ tests of a preset and runs them: tools/cpp_tests.sh [release|dev|asan|tsan] [ctest arguments...]
set -euo pipefail
cd "$(dirname "$0")/.."
export PATH="$PWD/.venv/bin:$PATH"
preset=${1:-release}
shift || true
jobs=${JOBS:-$(nproc)}

mkdir -p build
cmake --preset "$preset" >build/configure.log || { cat build/configure.log; exit 1; }
cmake --build --preset "$preset" -j "$jobs" --target tests
ctest --preset "$preset" -j "$jobs" "$@"
