#!/usr/bin/env bash
# The golden hashes (tests/physics/golden) by compiler and instruction set, as a table. Fails where one is another number
# than in the tests: tools/cross/goldens.sh [PLATFORM...], of gcc-native gcc-v3 clang-v3 clang-v4 gcc-arm
# Clang takes its libraries from `make wheels`, ARM needs g++-aarch64-linux-gnu and qemu-user.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
work=$root/build/cross
libraries=$root/build/wheels/libraries
jobs=${JOBS:-$(nproc)}
export PATH="$root/.venv/bin:$PATH"

zig=(-DCMAKE_TOOLCHAIN_FILE="$root/tools/cross/zig.cmake" -DCMAKE_MAKE_PROGRAM="$root/.venv/bin/ninja"
  -DCMAKE_PREFIX_PATH="$libraries;$work/clang" -DMANYHANDS_WERROR=OFF)
if command -v ccache >/dev/null; then zig+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi

need_clang() {
  if [ ! -e "$libraries/done" ]; then tools/wheels/libraries.sh "$libraries" && touch "$libraries/done"; fi
  [ ! -e "$work/clang/lib/libgtest.a" ] || return 0
  cmake -G Ninja -S /usr/src/googletest -B "$work/gtest" "${zig[@]}" -DCMAKE_BUILD_TYPE=Release -DBUILD_GMOCK=OFF
  cmake --build "$work/gtest" -j "$jobs"
  cmake --install "$work/gtest" --prefix "$work/clang"
}

need_arm() { [ -e "$work/aarch64/usr/lib" ] || tools/cross/aarch64.sh "$work/aarch64"; }

build() { # build PLATFORM DEFINITIONS...
  local platform=$1
  shift
  cmake -G Ninja -S . -B "$work/$platform" -DCMAKE_BUILD_TYPE=Release -DMANYHANDS_UNITY=ON -DMANYHANDS_TESTS=ON \
    -DMANYHANDS_TEST_FILES=tests/physics/golden -DMANYHANDS_BENCHMARKS=OFF -DMANYHANDS_EXAMPLES=OFF \
    -DMANYHANDS_INSTALL=OFF "$@"
  cmake --build "$work/$platform" -j "$jobs" --target manyhands_tests
}

prepare() { # prepare PLATFORM
  case $1 in
    gcc-native) build "$1" ;;
    gcc-v3) build "$1" -DMANYHANDS_ISA=x86-64-v3 ;;
    clang-v3) need_clang && build "$1" "${zig[@]}" -DMANYHANDS_ISA=x86-64-v3 ;;
    clang-v4) need_clang && build "$1" "${zig[@]}" -DMANYHANDS_ISA=x86-64-v4 ;;
    gcc-arm) need_arm && build "$1" -DCMAKE_TOOLCHAIN_FILE="$root/tools/cross/aarch64.cmake" -DMANYHANDS_ISA=armv8 ;;
    *) echo "There is no platform '$1'" >&2; return 1 ;;
  esac
}

run() { # run PLATFORM: prints the hashes, and runs the tests that take lanes of every width
  local emulator=()
  if [ "$1" = gcc-arm ]; then
    emulator=(qemu-aarch64 -L /usr/aarch64-linux-gnu -E "LD_LIBRARY_PATH=$work/aarch64/usr/lib/aarch64-linux-gnu")
  fi
  MANYHANDS_PRINT_GOLDEN=1 "${emulator[@]}" "$work/$1/manyhands_tests" --gtest_filter='Golden.*' >"$work/$1.txt"
  "${emulator[@]}" "$work/$1/manyhands_tests" --gtest_filter='Golden.*' >"$work/$1.log" && echo "lanes equal" >>"$work/$1.txt"
}

mkdir -p "$work"
[ $# -gt 0 ] || set -- gcc-native gcc-v3 clang-v3 clang-v4 gcc-arm
for platform in "$@"; do
  prepare "$platform" >"$work/$platform.build" 2>&1 || { tail -30 "$work/$platform.build"; exit 1; }
  run "$platform" || true
done
python tools/cross/goldens.py "${@/#/$work/}"
