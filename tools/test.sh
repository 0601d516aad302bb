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

phase 'layers, formatting, types' tools/lint.sh
phase 'C++ tests' tools/cpp_tests.sh dev
phase 'Python tests' python -m pytest
printf '\n\033[1m==> Summary\033[0m\n%s' "$summary"
exit $failed
