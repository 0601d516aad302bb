#!/usr/bin/env bash
# The golden tests on one platform after another, beside that of `make test`: tools/goldens.sh [PLATFORM...]
# Prints a line for each test; any bit that differs fails. On ARM the processor is emulated, by Debian's qemu-user.
set -uo pipefail
cd "$(dirname "$0")/.."
root=$PWD
export PATH="$root/.venv/bin:$PATH"
jobs=${JOBS:-$(nproc)}
platforms=("$@")
[ ${#platforms[@]} -gt 0 ] ||
  platforms=(gcc-x86-64-v3 gcc-x86-64-v4 clang-x86-64-v3 clang-x86-64-v4 gcc-armv8)

# The libraries of Debian's arm64, unpacked into a folder.
arm_libraries() { # arm_libraries FOLDER
  [ ! -e "$1/done" ] || return 0
  mkdir -p "$1/lists/partial" "$1/archives"
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main" \
    >"$1/sources.list"
  local apt=(apt-get -qq -o Dir::Etc::sourcelist="$1/sources.list" -o Dir::Etc::sourceparts=/dev/null
    -o Dir::State::lists="$1/lists" -o APT::Architecture=arm64 -o APT::Architectures=arm64)
  "${apt[@]}" update
  (cd "$1/archives" && "${apt[@]}" download libpugixml1v5 libpugixml-dev libqhull-r8.0 libqhull-dev libpng16-16 \
    libpng-dev zlib1g zlib1g-dev libembree3-3 libembree-dev libtbb12 libtbbmalloc2 libgtest-dev)
  local archive
  for archive in "$1"/archives/*.deb; do dpkg -x "$archive" "$1"; done
  touch "$1/done"
}

# GoogleTest from Debian's sources, for another C++ library than the system's.
clang_googletest() { # clang_googletest FOLDER
  [ ! -e "$1/lib/libgtest.a" ] || return 0
  cmake -G Ninja -S /usr/src/googletest -B "$1/googletest" -DCMAKE_TOOLCHAIN_FILE="$root/tools/cross/zig.cmake" \
    -DCMAKE_MAKE_PROGRAM=ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$1" -DBUILD_GMOCK=OFF
  cmake --build "$1/googletest" -j "$jobs" && cmake --install "$1/googletest"
}

run() { # run PLATFORM: builds and runs
  local compiler=${1%%-*} isa=${1#*-} build=$root/build/goldens/$1 libraries=$root/build/wheels/libraries
  local arm=$root/build/goldens/arm given=() emulator=()
  case $compiler-$isa in
    gcc-armv8)
      arm_libraries "$arm" || return
      given=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++
        -DCMAKE_C_COMPILER=aarch64-linux-gnu-gcc -DCMAKE_FIND_ROOT_PATH="$arm" -DCMAKE_LIBRARY_ARCHITECTURE=aarch64-linux-gnu
        -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY
        -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY -DEigen3_DIR=/usr/share/eigen3/cmake
        -DCMAKE_EXE_LINKER_FLAGS="-Wl,-rpath-link,$arm/usr/lib/aarch64-linux-gnu")
      emulator=(env QEMU_LD_PREFIX=/usr/aarch64-linux-gnu
        qemu-aarch64 -E LD_LIBRARY_PATH="$arm/usr/lib/aarch64-linux-gnu") ;;
    clang-*)
      [ -e "$libraries/done" ] || tools/wheels/libraries.sh "$libraries" || return
      clang_googletest "$libraries" || return
      export CCACHE_COMPILERTYPE=clang CMAKE_CXX_COMPILER_LAUNCHER=ccache
      given=(-DCMAKE_TOOLCHAIN_FILE="$root/tools/cross/zig.cmake" -DCMAKE_PREFIX_PATH="$libraries"
        -DCMAKE_MAKE_PROGRAM=ninja -DMANYHANDS_WERROR=OFF) ;;
  esac
  cmake -G Ninja -S . -B "$build" "${given[@]}" -DCMAKE_BUILD_TYPE=Release -DMANYHANDS_ISA="$isa" -DMANYHANDS_UNITY=ON \
    -DMANYHANDS_OTHER_LANES=OFF -DMANYHANDS_TEST_FILES=tests/physics/golden -DMANYHANDS_BENCHMARKS=OFF \
    -DMANYHANDS_EXAMPLES=OFF -DMANYHANDS_INSTALL=OFF || return
  cmake --build "$build" -j "$jobs" --target manyhands_tests || return
  "${emulator[@]}" "$build/manyhands_tests" --gtest_filter='Golden*' --gtest_brief=0
}

failed=0
mkdir -p build/goldens
for platform in "${platforms[@]}"; do
  log=build/goldens/$platform.log
  (run "$platform") >"$log" 2>&1 || failed=1
  grep -E '^\[ +(OK|FAILED|PASSED) +\].*(Golden|test)' "$log" | sed "s/^/$platform  /" || { echo "$platform  see $log"; failed=1; }
done
exit $failed
