#!/usr/bin/env bash
# A person looks at a scan and its model in the browser. SOURCE is the clone, PAGES a folder with the packages of
# web/package-lock.json, for the program that uses the browser. Run in an empty folder; users_test.py does so.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

underbrush import "$SOURCE/share/examples/marv_forest.pcd" --unknown-below-deg -13 -o whole.ply
underbrush segment whole.ply -o labelled.ply
underbrush fit labelled.ply --fitter hierarchical -o model > fit.txt

underbrush serve labelled.ply model --cache cache --json serve.json > serve.txt &
server=$!
trap 'kill "$server" 2> /dev/null || true' EXIT
for _ in $(seq 300); do [ -s serve.json ] && break; sleep 0.1; done
address=$(sed -n 's/.*"address": *"\([^"]*\)".*/\1/p' serve.json)
node "$here/look.mjs" "$PAGES" "$(command -v chromium)" "$address" .
kill "$server"
wait "$server" || [ $? -gt 127 ]    # ended by the signal
trap - EXIT
