#!/usr/bin/env bash
# Walks the ways of four new users (tests/users) on a bare Debian 12 (a folder made by debootstrap), with the steps of
# README.md and the guide alone: a clone, the Python package and the FMU. As root; it compiles, so it takes minutes.
#   scripts/check_users.sh [FOLDER]
# FOLDER is a bare Debian that is there already, or where to keep a new one; without it a temporary one.
# DATA is the folder of real logs, without which two of the ways are skipped.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/bare_debian.sh"
bare_debian check_users "${1:-}"
take_pip
take_clone
for name in osi trees_laz; do
  [ ! -d "${DATA:-}/$name" ] || { mkdir -p "$root/srv/data"; cp -rL "$DATA/$name" "$root/srv/data/"; }
done
registry=$(npm config get registry 2> /dev/null || true)   # as this machine has it
[ -z "$registry" ] || pip+=("NPM_CONFIG_REGISTRY=$registry")
[ ! -e "$root/srv/certificates.pem" ] || pip+=(NODE_EXTRA_CA_CERTS=/srv/certificates.pem)
inside apt-get -q -y update > /dev/null
inside apt-get -q -y -o Dpkg::Use-Pty=0 install --no-install-recommends git make ca-certificates > /dev/null

echo "check_users: the Python package and the FMU (compile)"
start=$SECONDS
in_clone "scripts/setup.sh build python"
inside python3 -m venv /srv/venv
in_clone "/srv/venv/bin/pip install -q '.[formats]' --config-settings=build-dir=build/pip"
in_clone "make fmu"
echo "check_users: built after $((SECONDS - start)) s"
inside apt-get -q -y -o Dpkg::Use-Pty=0 install --no-install-recommends chromium nodejs npm > /dev/null
inside /srv/venv/bin/pip install -q fmpy 'mcap-ros2-support>=0.5'
in_clone "PATH=/srv/venv/bin:\$PATH UNDERBRUSH_DATA=/srv/data tests/users/users_test.py --installed --build build"
echo "check_users: the ways of four new users end well on a bare Debian"
