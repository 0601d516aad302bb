#!/usr/bin/env bash
# Checks that run no program of ours: formatting, Python lint and types, layers.
#   tools/lint.sh          check        tools/lint.sh --fix     format in place
#   tools/lint.sh --tidy   check, with clang-tidy over every C++ source too
set -uo pipefail
cd "$(dirname "$0")/.."
export PATH="$PWD/.venv/bin:$PATH"
mode=${1:-}
jobs=${JOBS:-$(nproc)}
failed=()

step() {
  printf -- '--- %s\n' "$1"
  "${@:2}" || failed+=("$1")
}

finish() {
  [ ${#failed[@]} -eq 0 ] && exit 0
  printf 'FAILED: %s\n' "${failed[@]}"
  exit 1
}

cpp_files() { find manyhands bindings tests benchmarks examples -name '*.h' -o -name '*.cpp' -o -name '*.inl' | sort; }

clang_format() { cpp_files | xargs -r clang-format "$@"; }

clang_tidy() {
  cmake --preset dev -B build/tidy -DMANYHANDS_BENCHMARKS=ON -DMANYHANDS_PYTHON=ON >/dev/null &&
    cpp_files | grep '\.cpp$' | grep -v '^examples/cmake_package/' |
    xargs -r -P "$jobs" -n 1 clang-tidy --quiet -p build/tidy
}

if [ "$mode" = --fix ]; then
  step clang-format clang_format -i
  step 'ruff check' ruff check --quiet --fix .
  step 'ruff format' ruff format --quiet .
  finish
fi

step layers python tools/check_layers.py
step clang-format clang_format --dry-run -Werror --ferror-limit=1
step 'ruff check' ruff check --quiet .
step 'ruff format' ruff format --quiet --check --output-format concise .
step pyright pyright
[ "$mode" != --tidy ] || step clang-tidy clang_tidy
finish
