#!/usr/bin/env bash
# The libraries that go into wheels, static, from Debian's source packages: tools/wheels/libraries.sh FOLDER
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
mkdir -p "$1"
prefix=$(cd "$1" && pwd)
export PATH="$root/.venv/bin:$PATH" CC="$root/tools/cross/cc" CXX="$root/tools/cross/c++"
export AR="$root/tools/cross/ar" RANLIB="$root/tools/cross/ranlib"
export CFLAGS='-O2 -fPIC -fvisibility=hidden -ffunction-sections -fdata-sections'
export CXXFLAGS=$CFLAGS
jobs=${JOBS:-$(nproc)}
suite=bookworm

# The newest sources of the suite, checked by apt against Debian's signatures.
fetch() {
  mkdir -p apt/lists/partial
  echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian $suite main" \
    >apt/sources.list
  local apt=(apt-get -qq -o Dir::Etc::sourcelist="$PWD/apt/sources.list" -o Dir::Etc::sourceparts=/dev/null
    -o Dir::State::lists="$PWD/apt/lists" -o APT::Sandbox::User="$(id -un)")
  "${apt[@]}" update
  "${apt[@]}" source --tar-only --download-only pugixml qhull libpng1.6 zlib
  local archive
  for archive in *.orig.tar.*; do
    mkdir -p "${archive%%_*}"
    tar xf "$archive" -C "${archive%%_*}" --strip-components=1
  done
}

build() { # build SOURCE TARGETS OPTIONS...
  local source=$1 targets=$2
  shift 2
  cmake -G Ninja -S "$source" -B "build/$source" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
    -DCMAKE_TOOLCHAIN_FILE="$root/tools/cross/zig.cmake" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_MAKE_PROGRAM="$root/.venv/bin/ninja" \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_POLICY_VERSION_MINIMUM=3.10 -DBUILD_SHARED_LIBS=OFF "$@"
  cmake --build "build/$source" -j "$jobs" --target $targets
}

build_zlib() {
  (cd zlib && ./configure --static --prefix="$prefix" && make -j "$jobs" libz.a && make install)
}

mkdir -p "$prefix/src"
cd "$prefix/src"
fetch
build_zlib
build libpng1.6 png_static -DPNG_SHARED=OFF -DPNG_TESTS=OFF
build pugixml all
build qhull all
for library in libpng1.6 pugixml qhull; do cmake --install "build/$library"; done
