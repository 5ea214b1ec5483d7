# Sourced by scripts that try an installation on a bare Debian 12: makes it with debootstrap in a folder, as root.
#   bare_debian NAME [FOLDER]     sets `root`: FOLDER, which may hold one already, or a temporary one that is removed
#   take_pip                      takes pip's settings along (PIP_*, /etc/pip.conf)
#   take_clone                    clones this repository to /srv/underbrush there
#   inside COMMAND…               runs a command there; in_clone COMMANDS runs a line of bash in the clone
# MIRROR names another mirror of Debian.
pip=()

bare_debian() {
  root=${2:-$(mktemp -d)}
  trap "leave_debian '${2:-}'" EXIT
  local mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' | grep -m 1 '/debian/\?$')}   # as this machine has it
  [ "$(id -u)" = 0 ] || { echo "$1: needs root, for debootstrap and chroot" >&2; exit 1; }
  [ -e "$root/usr/bin/apt-get" ] || debootstrap --variant=minbase bookworm "$root" "$mirror" > "$root.log" 2>&1 ||
    { tail "$root.log" >&2; exit 1; }
  cp /etc/resolv.conf /etc/hosts "$root/etc/"
}

leave_debian() {
  ! mountpoint -q "$root/proc" || umount "$root/proc"
  [ -n "$1" ] || rm -rf --one-file-system "$root"
}

take_pip() {
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"   # compilers and shells look there
  [ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
  mapfile -t pip < <(env | grep -E '^PIP_' | grep -vE '^PIP_(CERT|FIND_LINKS)=' || true)
  if [ -n "${PIP_CERT:-}" ]; then
    mkdir -p "$root/etc/ssl/certs"
    cp -L "$PIP_CERT" "$root/srv/certificates.pem"
    pip+=(PIP_CERT=/srv/certificates.pem)
  fi
}

take_clone() {
  rm -rf "$root/srv/underbrush"
  git clone -q --no-hardlinks "$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)" "$root/srv/underbrush"
}

inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/srv DEBIAN_FRONTEND=noninteractive "${pip[@]}" "$@"
}

in_clone() { inside bash -euo pipefail -c "cd /srv/underbrush && $1"; }
