#!/usr/bin/env bash
# Installs what is missing on Debian 12, with apt, as root or through sudo.
#   scripts/setup.sh build          what the program needs
#   scripts/setup.sh build test     what the tests need as well (the default)
#   scripts/setup.sh live           what the sensor server needs besides the program
#   scripts/setup.sh python         what the Python package needs besides the program
#   scripts/setup.sh docs package   what the documentation site and the Debian package need
#   scripts/setup.sh results        what the comparison of documented figures needs besides the tests
set -euo pipefail

build="g++ cmake ninja-build make git pkg-config
  libtbb-dev libeigen3-dev libnanoflann-dev libcli11-dev
  nlohmann-json3-dev libyaml-cpp-dev libfmt-dev libxxhash-dev libpng-dev liblzf-dev libnlopt-dev
  libtinygltf-dev libcpp-httplib-dev libprotozero-dev libpugixml-dev libzstd-dev zlib1g-dev"
live="libgrpc++-dev libprotobuf-dev protobuf-compiler protobuf-compiler-grpc"
test="$live libembree-dev chromium libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev liblzma-dev
  clang clang-tidy clang-format libclang-rt-14-dev doxygen jq valgrind slurm-wlm python3 python3-numpy python3-dev
  python3-venv"
docs="doxygen python3 python3-venv"
package="$live dpkg-dev file debootstrap"
results="python3-venv xz-utils"
python="python3-dev python3-venv"

wanted=""
for group in "${@:-build test}"; do
  for name in $group; do
    case $name in
      build) wanted+=" $build" ;;
      test) wanted+=" $test" ;;
      docs) wanted+=" $docs" ;;
      package) wanted+=" $package" ;;
      results) wanted+=" $results" ;;
      live) wanted+=" $live" ;;
      python) wanted+=" $python" ;;
      *) echo "setup: no group '$name'; there are: build test live docs package results python" >&2; exit 2 ;;
    esac
  done
done

if ! command -v dpkg-query > /dev/null; then
  echo "setup: not a Debian system, nothing installed. Needed (Debian's names):" $wanted >&2
  exit 0
fi
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p')
missing=$(comm -23 <(tr -s ' \n' '\n' <<< "$wanted" | sed '/^$/d' | sort -u) <(sort -u <<< "$installed"))
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" != 0 ]; then
  as_root="sudo"
  [ -t 0 ] || as_root="sudo -n"   # nobody there to type a password
  if ! command -v sudo > /dev/null || ! $as_root true 2> /dev/null; then
    echo "setup: neither root nor sudo. As root: apt-get install" $missing >&2
    exit 1
  fi
fi

echo "setup: installing" $missing
log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 \
    -o Dpkg::Use-Pty=0 "$@" < /dev/null >> "$log" 2>&1
}
if ! { apt update && apt install --no-install-recommends $missing; }; then
  tail -n 20 "$log" >&2
  echo "setup: apt-get failed, see above" >&2
  exit 1
fi
