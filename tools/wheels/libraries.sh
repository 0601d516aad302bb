#!/usr/bin/env bash
# The libraries that go into wheels, static, from Debian's source packages: tools/wheels/libraries.sh FOLDER
# Of Embree only what traces triangles on AVX2, which is 0.9 MB of the extension where all of it are 44.
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
  "${apt[@]}" source --tar-only --download-only embree pugixml qhull libpng1.6 zlib
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

build_embree() {
  # Two operators that print name members that are not there: newer compilers look at them though nobody calls them.
  sed -i 's/ << "QuadraticBezierCurve.*;/;/' embree/kernels/subdiv/bezier_curve.h
  sed -i 's/return cout << "Line" << M.*/return cout;/' embree/kernels/geometry/pointi.h
  # And what traces curves, which takes as long to compile as all the rest.
  sed -i '/curve_intersector_virtual/d' embree/kernels/CMakeLists.txt
  local off=() part
  for part in ISA_SSE2 ISA_SSE42 ISA_AVX ISA_AVX512 ISPC_SUPPORT TUTORIALS FILTER_FUNCTION GEOMETRY_QUAD GEOMETRY_CURVE \
    GEOMETRY_SUBDIVISION GEOMETRY_USER GEOMETRY_INSTANCE GEOMETRY_GRID GEOMETRY_POINT; do off+=("-DEMBREE_$part=OFF"); done
  build embree all -DEMBREE_STATIC_LIB=ON -DEMBREE_TASKING_SYSTEM=INTERNAL -DEMBREE_MAX_ISA=NONE -DEMBREE_ISA_AVX2=ON \
    -DFLAGS_AVX2='-mf16c -mavx2 -mfma -mlzcnt -mbmi -mbmi2 -mpopcnt' "${off[@]}"
  # Its own installation asks for manuals that Debian leaves out.
  cp build/embree/*.a "$prefix/lib/"
  cp -r embree/include/embree3 "$prefix/include/"
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
build_embree
