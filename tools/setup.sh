#!/usr/bin/env bash
# Sets this machine up, step by step; the Makefile calls it.
#   tools/setup.sh system PACKAGE...   Debian/Ubuntu packages, only the missing ones
#   tools/setup.sh venv                .venv with the build tools
#   tools/setup.sh python NAME...      requirements of pyproject.toml into .venv (see tools/requirements.py)
#   tools/setup.sh browser             Chromium for the viewer's tests: Debian's, elsewhere Playwright's own
set -euo pipefail
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
export PIP_DISABLE_PIP_VERSION_CHECK=1

say() { printf '\033[1m==> %s\033[0m\n' "$*"; }
fail() { printf 'manyhands: %s\n' "$*" >&2; exit 1; }
installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }

install_system_packages() {
  command -v dpkg-query >/dev/null || { say "No Debian or Ubuntu here: please provide the equivalent of $*"; return; }
  local missing=() package
  for package in "$@"; do installed "$package" || missing+=("$package"); done
  # A Python that is not the system's brings its own headers and venv.
  "$python" -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3-venv)
  "$python" -c 'import sysconfig, os; os.stat(sysconfig.get_path("include") + "/Python.h")' 2>/dev/null ||
    missing+=(python3-dev)
  [ ${#missing[@]} -gt 0 ] || return 0

  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    sudo -n true 2>/dev/null || fail "system packages are missing. Install them and run make again:

    sudo apt-get update && sudo apt-get install -y ${missing[*]}
"
    as_root=(sudo -n)
  fi
  say "Installing system packages: ${missing[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0)
  "${apt[@]}" update
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null
}

make_venv() {
  "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' ||
    fail "Python 3.10 or newer is needed, $python is $("$python" -V). Name another: make PYTHON=python3.12"
  say "Making .venv with the build tools"
  "$python" -m venv --clear .venv
  .venv/bin/python -c 'import tomllib' 2>/dev/null || .venv/bin/pip install --quiet tomli
  install_requirements build core  # numpy must be whole when stubs are made, whatever else is fetched meanwhile
}

install_requirements() {
  .venv/bin/python tools/requirements.py "$@" | .venv/bin/pip install --quiet --no-compile -r /dev/stdin
}

# Ubuntu's package of that name is a snap, which containers cannot run; Playwright's own build needs its download site.
install_browser() {
  local name
  for name in chromium chromium-browser google-chrome; do
    if command -v "$name" >/dev/null && "$name" --version >/dev/null 2>&1; then return 0; fi
  done
  if grep -qsx 'ID=debian' /etc/os-release; then
    install_system_packages chromium
  else
    say "Installing Playwright's Chromium"
    .venv/bin/playwright install --with-deps chromium-headless-shell ||
      say "No browser: the viewer's page is not tested"
  fi
}

command=${1:-}
shift || true
case $command in
  system) install_system_packages "$@" ;;
  venv) make_venv ;;
  python) say "Installing Python packages: $*"; install_requirements "$@" ;;
  browser) install_browser ;;
  *) fail "usage: tools/setup.sh system PACKAGE... | venv | python NAME... | browser" ;;
esac
