#!/usr/bin/env bash
# The comparison simulator of [tallavajhula18] §V in one command: a scene of plant meshes where a log has
# plants, over the ground mesh of the log.
#
#   scripts/mesh_primitives.sh LOG SCENE [--primitives SET] [--min-range M] [--tile M]
#                               [--ground-method NAME] [--seed N] [--threads N]
#
# SET is a folder of primitives that `underbrush meshes` wrote; without it the plants are generated. The
# program is `underbrush` of the path, or build/bin/underbrush, or $UNDERBRUSH.
set -euo pipefail

fail() { echo "mesh_primitives: $1" >&2; exit 2; }
[ $# -ge 2 ] || fail "usage: scripts/mesh_primitives.sh LOG SCENE [OPTIONS], see the head of the script"
log=$1 scene=$2 primitives=mesh_primitives
shift 2
both=() all=()
while [ $# -gt 0 ]; do
  [ $# -ge 2 ] || fail "$1 takes a value"
  case $1 in
    --primitives) primitives=$2 ;;
    --min-range | --tile | --ground-method) both+=("$1" "$2") ;;
    --seed | --threads) all+=("$1" "$2") ;;
    *) fail "no option $1" ;;
  esac
  shift 2
done

built=$(dirname "${BASH_SOURCE[0]}")/../build/bin/underbrush
program=$(realpath "${UNDERBRUSH:-$(command -v underbrush || echo "$built")}")
log=$(realpath -m "$log") scene=$(realpath -m "$scene")
if [ "$primitives" != mesh_primitives ]; then primitives=$(realpath "$primitives"); fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"   # relative names, so that equal scenes have equal provenance
run() { "$program" "$@" "${all[@]}"; }

run fit "$log" --fitter ground_mesh "${both[@]}" -o ground
run segment "$log" "${both[@]}" -o labelled.ply
run annotate labelled.ply --ground ground -o site.json
run compose site.json "$primitives" -o "$scene"
