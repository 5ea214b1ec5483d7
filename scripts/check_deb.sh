#!/usr/bin/env bash
# Installs a package on a bare Debian 12 (a folder made by debootstrap) and runs the demo there. As root; minutes.
#   scripts/check_deb.sh build/underbrush_0.1.0_amd64.deb [FOLDER]
# FOLDER is a bare Debian that is there already, or where to keep a new one; without it a temporary one.
set -euo pipefail
deb=$(realpath "$1")
source "$(dirname "${BASH_SOURCE[0]}")/bare_debian.sh"
bare_debian check_deb "${2:-}"
cp "$deb" "$root/tmp/"
inside apt-get -q -y update > /dev/null
inside apt-get -q -y install --no-install-recommends "/tmp/$(basename "$deb")" | tail -n 3

small=/srv/small.yaml
sed -e 's/^name: .*/name: small/' -e 's/^rate_hz: .*/rate_hz: 2/' -e 's/^firing_period_us: .*/firing_period_us: 4000/' \
  "$root/usr/share/underbrush/sensors/velodyne-vlp16.yaml" > "$root$small"
inside underbrush --version
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
