#!/usr/bin/env bash
# Installs the Python package from a clean clone on a bare Debian 12 (a folder made by debootstrap) and runs the Python
# lines of README.md and the guide; then packs a wheel that bundles its libraries, removes the compiler and the
# libraries, and runs the same lines with the wheel in a second environment. As root; it compiles, so it takes minutes.
#   scripts/check_wheel.sh [FOLDER]
# FOLDER is a bare Debian that is there already, or where to keep a new one; without it a temporary one.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/bare_debian.sh"
bare_debian check_wheel "${1:-}"
take_pip
rm -rf "$root/srv/first" "$root/srv/second"
take_clone
in_clone "scripts/setup.sh build python"

echo "check_wheel: pip install . (compiles)"
start=$SECONDS
inside python3 -m venv /srv/first
in_clone "/srv/first/bin/pip install -q . --config-settings=build-dir=build/pip"
echo "check_wheel: installed after $((SECONDS - start)) s"
in_clone "python3 python/tests/environment.py lines --build /srv/first"
in_clone "python3 python/tests/environment.py repaired --build build/pip"

inside apt-get -q -y -o Dpkg::Use-Pty=0 purge g++ cpp cmake ninja-build 'libtbb*' 'libyaml-cpp*' 'libnlopt*' 'libtinygltf*' 'libstb*' \
  'liblzf*' > /dev/null
inside apt-get -q -y -o Dpkg::Use-Pty=0 autoremove --purge > /dev/null
if inside sh -c 'command -v gcc || command -v c++ || command -v cmake'; then
  echo "check_wheel: a compiler is left" >&2
  exit 1
fi
inside python3 -m venv /srv/second
in_clone "/srv/second/bin/pip install -q build/pip/wheel/*.whl"
in_clone "python3 python/tests/environment.py lines --build /srv/second"
inside /srv/second/bin/underbrush --version
echo "check_wheel: the package installs from a clean clone, and its wheel without a compiler and without libraries"
