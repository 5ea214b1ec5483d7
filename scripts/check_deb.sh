#!/usr/bin/env bash
# Installs a package on a bare Debian 12 (a folder made by debootstrap) by the steps of share/containers/Containerfile, and
# runs the demo there. As root; minutes.
#   scripts/check_deb.sh build/underbrush_0.1.0_amd64.deb [FOLDER]
# FOLDER is a bare Debian that is there already, or where to keep a new one; without it a temporary one.
set -euo pipefail
deb=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/bare_debian.sh"
bare_debian check_deb "${2:-}"
# The steps of the Containerfile, with the bare Debian as its image.
entry=
while read -r step words; do
  case $step in
    '' | '#'*) ;;
    FROM) [[ $words == */debian:12-slim ]] || { echo "check_deb: the image is $words" >&2; exit 1; } ;;
    COPY) (cd "$(dirname "$deb")" && cp ${words% *} "$root${words##* }") ;;   # the pattern is one for the shell
    RUN) inside sh -c "$words" < /dev/null | tail -n 3 ;;
    WORKDIR) inside mkdir -p "$words" ;;
    ENTRYPOINT) entry=$(python3 -c 'import json, sys; print(*json.loads(sys.argv[1]))' "$words") ;;
    *) echo "check_deb: the Containerfile has a step $step" >&2; exit 1 ;;
  esac
done < "$(dirname "${BASH_SOURCE[0]}")/../share/containers/Containerfile"

small=/srv/small.yaml
sed -e 's/^name: .*/name: small/' -e 's/^rate_hz: .*/rate_hz: 2/' -e 's/^firing_period_us: .*/firing_period_us: 4000/' \
  "$root/usr/share/underbrush/sensors/velodyne-vlp16.yaml" > "$root$small"
inside $entry --version
inside rm -rf /srv/demo
inside underbrush demo -o /srv/demo --sensor "$small" --sub-rays 1
for file in /srv/demo/report/index.html /usr/share/man/man1/underbrush.1.gz /usr/share/doc/underbrush/copyright \
  /usr/share/bash-completion/completions/underbrush /usr/share/zsh/site-functions/_underbrush \
  /usr/share/fish/vendor_completions.d/underbrush.fish /usr/share/underbrush/materials/materials.yaml \
  /usr/lib/underbrush/live_grpc.so /usr/share/underbrush/live/sensor_server.proto; do
  [ -s "$root$file" ] || { echo "check_deb: $file is missing" >&2; exit 1; }
done
inside apt-get -q -y remove underbrush > /dev/null
[ ! -e "$root/usr/share/underbrush" ] || { echo "check_deb: files are left after removal" >&2; exit 1; }
echo "check_deb: $(basename "$deb") installs, runs its demo and is removed without a trace"
