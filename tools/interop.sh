#!/usr/bin/env bash
# Programs and libraries of others on our package as it is installed, in an environment of their own: build/interop.
# PyTorch brings several gigabytes, which .venv is spared.
set -euo pipefail
cd "$(dirname "$0")/.."
here=build/interop
export PIP_DISABLE_PIP_VERSION_CHECK=1

# Their own requirements want an older PyTorch and hub, which reading a dataset does not.
lerobot="lerobot==0.4.4 datasets==4.8.5"

site() { "$1/bin/python" -c 'import sysconfig; print(sysconfig.get_path("platlib"))'; }

requirements=$(.venv/bin/python tools/requirements.py interop; echo "# $lerobot")
if [ "$requirements" != "$(cat $here/requirements.txt 2>/dev/null)" ]; then
  echo "==> Installing PyTorch, Stable-Baselines3, panda-gym, Minari, LeRobot and Ray into $here (5 GB, three minutes)"
  .venv/bin/python -m venv --clear $here
  $here/bin/pip install --quiet --no-cache-dir -r <(echo "$requirements")
  # shellcheck disable=SC2086
  $here/bin/pip install --quiet --no-cache-dir --no-deps $lerobot
  echo "$requirements" >$here/requirements.txt
fi
rm -rf "$(site $here)"/manyhands*
cp -r "$(site .venv)"/manyhands* "$(site $here)"
# A process for each file: one has our PyBullet under its name, another the real one.
for tests in tests/interop/*.py tests/python/envs/test_sb3.py; do
  $here/bin/python -m pytest -q -p no:cacheprovider "$tests" "$@" || [ $? -eq 5 ] # 5: none was selected
done
