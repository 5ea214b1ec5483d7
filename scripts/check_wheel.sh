#!/usr/bin/env bash
# Installs the Python package from a clean clone on a bare Debian 12 (a folder made by debootstrap) and runs the Python
# lines of README.md and the guide; then packs a wheel that bundles its libraries, removes the compiler and the
# libraries, and runs the same lines with the wheel in a second environment. As root; it compiles, so it takes minutes.
#   scripts/check_wheel.sh [FOLDER]
# FOLDER is a bare Debian that is there already, or where to keep a new one; without it a temporary one.
# MIRROR names another mirror of Debian; pip's settings (PIP_*, /etc/pip.conf) are taken along.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
root=${1:-$(mktemp -d)}
leave() {
  ! mountpoint -q "$root/proc" || umount "$root/proc"
  [ -n "$1" ] || rm -rf --one-file-system "$root"
}
trap 'leave "${1:-}"' EXIT
mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' | grep -m 1 '/debian/\?$')}   # as this machine has it
[ "$(id -u)" = 0 ] || { echo "check_wheel: needs root, for debootstrap and chroot" >&2; exit 1; }

[ -e "$root/usr/bin/apt-get" ] || debootstrap --variant=minbase bookworm "$root" "$mirror" > "$root.log" 2>&1 ||
  { tail "$root.log" >&2; exit 1; }
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"   # compilers and shells look there
cp /etc/resolv.conf /etc/hosts "$root/etc/"
[ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
mapfile -t pip < <(env | grep -E '^PIP_' | grep -vE '^PIP_(CERT|FIND_LINKS)=' || true)
if [ -n "${PIP_CERT:-}" ]; then
  mkdir -p "$root/etc/ssl/certs"
  cp -L "$PIP_CERT" "$root/srv/certificates.pem"
  pip+=(PIP_CERT=/srv/certificates.pem)
fi
inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/srv DEBIAN_FRONTEND=noninteractive "${pip[@]}" "$@"
}
rm -rf "$root/srv/underbrush" "$root/srv/first" "$root/srv/second"
git clone -q --no-hardlinks "$here" "$root/srv/underbrush"
in_clone() { inside bash -euo pipefail -c "cd /srv/underbrush && $1"; }
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
