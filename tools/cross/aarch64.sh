#!/usr/bin/env bash
# Debian's libraries for ARM, unpacked into a folder for tools/cross/aarch64.cmake: tools/cross/aarch64.sh FOLDER
# The compiler and qemu are the machine's own: g++-aarch64-linux-gnu, qemu-user.
set -euo pipefail
mkdir -p "$1/apt/lists/partial" "$1/apt/archives"
cd "$1"
touch apt/status
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main" \
  >apt/sources.list
apt=(apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::Etc::sourcelist="$PWD/apt/sources.list"
  -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$PWD/apt/lists" -o Dir::State::status="$PWD/apt/status"
  -o Dir::Cache="$PWD/apt" -o APT::Sandbox::User="$(id -un)")
"${apt[@]}" update
(cd apt/archives && "${apt[@]}" download libpugixml-dev libpugixml1v5 libqhull-dev \
  libqhull-r8.0 libqhull8.0 libqhullcpp8.0 libpng-dev libpng16-16 zlib1g-dev zlib1g libgtest-dev libeigen3-dev)
for package in apt/archives/*.deb; do dpkg-deb -x "$package" .; done
