#!/usr/bin/env bash
# All tests, one after the other though an earlier one fails, and a summary at the end.
set -uo pipefail
cd "$(dirname "$0")/.."
export PATH="$PWD/.venv/bin:$PATH"
failed=0
summary=''

phase() {
  local name=$1 start=$SECONDS result=passed
  shift
  printf '\n\033[1m==> %s\033[0m\n' "$name"
  "$@" || { result=FAILED; failed=1; }
  summary+=$(printf '  %-26s %-7s %5d s' "$name" $result $((SECONDS - start)))$'\n'
}

# A program of somebody else's on the installed library.
cmake_package() {
  local prefix=$PWD/build/prefix
  cmake --install build/release --prefix "$prefix" >/dev/null &&
    cmake -S examples/cmake_package -B build/cmake_package -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null &&
    cmake --build build/cmake_package && build/cmake_package/example
}

phase 'layers, formatting, types' tools/lint.sh
phase 'C++ tests' tools/cpp_tests.sh release
phase 'CMake package' cmake_package
# Files stay whole: their fixtures are built once.
phase 'Python tests' python -m pytest -n "${JOBS:-$(nproc)}" --dist loadfile
printf '\n\033[1m==> Summary\033[0m\n%s' "$summary"
exit $failed
