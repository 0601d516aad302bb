#!/usr/bin/env bash
# The wheels for Linux on this machine's processor, into dist/: for Python 3.10, 3.11, and 3.12 with all that follow it.
# An interpreter of each is needed, as python3.10 on the PATH or in pyenv; what there is none of is left out, and said.
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
work=$root/build/wheels
libraries=$work/libraries
export PATH="$root/.venv/bin:$PATH" PIP_DISABLE_PIP_VERSION_CHECK=1 CMAKE_GENERATOR=Ninja
export CMAKE_BUILD_PARALLEL_LEVEL=${JOBS:-$(nproc)}
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_COMPILERTYPE=clang; fi
machine=$(uname -m)
isas=(x86-64-v3 x86-64-v4)
if [ "$machine" = aarch64 ]; then isas=(armv8); fi
export ZIG_TARGET=$machine-linux-gnu.2.28

mkdir -p "$work"

say() { printf '\033[1m==> %s\033[0m\n' "$*"; }

interpreter() { # interpreter 3.10
  local found
  for found in "$(command -v "python$1")" "$HOME"/.pyenv/versions/"$1".*/bin/python"$1"; do
    if "$found" -c '' 2>/dev/null; then echo "$found"; return; fi
  done
  return 1
}

# What CMake is told: definitions for an instruction set, each behind PREFIX.
definitions() { # definitions ISA PREFIX
  printf -- "$2%s\n" CMAKE_TOOLCHAIN_FILE="$root/tools/cross/zig.cmake" CMAKE_PREFIX_PATH="$libraries" \
    CMAKE_MAKE_PROGRAM="$root/.venv/bin/ninja" MANYHANDS_ISA="$1" MANYHANDS_WERROR=OFF
}

# The package with the kernels of one instruction set.
build_package() { # build_package ISA VENV
  local settings
  mapfile -t settings < <(definitions "$1" --config-settings=cmake.define.)
  "$2/bin/pip" wheel --quiet --no-deps --no-build-isolation --wheel-dir "$work/new" \
    --config-settings=build-dir="$work/$1" "${settings[@]}" .
}

# The extension alone for another, put into the package.
add_kernels() { # add_kernels ISA VENV PACKAGE
  local build=$work/$1 python=$2/bin/python stable=() given
  if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 12))'; then
    stable=(-DSKBUILD_SABI_COMPONENT=Development.SABIModule -DSKBUILD_SABI_VERSION=3.12)
  fi
  rm -rf "$build/package"
  mapfile -t given < <(definitions "$1" -D)
  # What it found of another Python is forgotten.
  cmake -S . -B "$build" -U '*Python*' "${given[@]}" -DCMAKE_BUILD_TYPE=Release \
    -DMANYHANDS_PYTHON=ON -DMANYHANDS_UNITY=ON -DSKBUILD=ON -DPython_EXECUTABLE="$python" "${stable[@]}" >"$work/$1.log"
  cmake --build "$build" --target _core >>"$work/$1.log"
  install -D -t "$3/manyhands/$1" "$build"/package/manyhands/_core.*
}

make_wheel() { # make_wheel 3.10
  local python venv=$work/python$1 isa unpacked
  python=$(interpreter "$1") || { say "There is no python$1 here, so no wheel for it"; return 0; }
  say "Python $1: $python"
  if [ ! -x "$venv/bin/pip" ]; then
    "$python" -m venv "$venv"
    .venv/bin/python tools/requirements.py build | "$venv/bin/pip" install --quiet -r /dev/stdin
  fi
  rm -rf "$work/new"
  build_package "${isas[0]}" "$venv"
  python -m wheel unpack --dest "$work/new" "$work"/new/*.whl
  rm "$work"/new/*.whl
  unpacked=$(echo "$work"/new/*/)
  for isa in "${isas[@]:1}"; do add_kernels "$isa" "$venv" "$unpacked"; done
  python -m wheel pack --dest-dir "$work/new" "$unpacked"
  auditwheel repair --plat "manylinux_2_28_$machine" --wheel-dir dist "$work"/new/*.whl
}

if [ ! -e "$libraries/done" ]; then
  say "Building the libraries that wheels bring along"
  tools/wheels/libraries.sh "$libraries" >"$work/libraries.log" 2>&1 || { tail -20 "$work/libraries.log"; exit 1; }
  touch "$libraries/done"
fi
for version in ${VERSIONS:-3.10 3.11 3.12}; do make_wheel "$version"; done
if compgen -G 'dist/*-abi3-*.whl' >/dev/null; then abi3audit --strict --summary dist/*-abi3-*.whl; fi
python tools/wheels/sizes.py dist/*.whl
