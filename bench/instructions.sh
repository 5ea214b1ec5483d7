#!/bin/sh
# Instructions a ray of one pass over the forest of 10^5 ellipsoids (AVX2), counted by callgrind: the
# same on a busy machine as on an idle one. Fails above LIMIT (default: the figure in
# docs/performance.md and a tenth).
#   bench/instructions.sh [BENCH_TRACE [LIMIT]]
set -eu
bench=${1:-build/bin/bench_trace}
limit=${2:-870}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
valgrind --tool=callgrind --callgrind-out-file="$folder/out" --collect-atstart=no \
  --toggle-collect='*counted_pass*' "$bench" --passes 1 >"$folder/stdout" 2>"$folder/stderr" ||
  { cat "$folder/stderr" >&2; exit 1; }
rays=$(sed -n 's/^\([0-9]*\) rays.*/\1/p' "$folder/stdout")
total=$(sed -n 's/^summary: *//p' "$folder/out")
each=$((total / rays))
echo "$each instructions a ray ($total for $rays rays; limit $limit)"
[ -n "${KEEP:-}" ] && cp "$folder/out" "$KEEP"
[ "$each" -le "$limit" ]
