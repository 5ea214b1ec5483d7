#!/usr/bin/env bash
# Runs a command with a folder of its own for temporary files, which is deleted afterwards. The folder lies in memory
# where that has room for it and runs programs, because some file systems are slow with thousands of short-lived files.
#
#   scripts/with_scratch.sh COMMAND...
set -euo pipefail
least_kb=8000000

in_memory() {
  [ -w /dev/shm ] && [ "$(df -Pk /dev/shm | awk 'NR == 2 { print $4 }')" -ge "$least_kb" ] || return 1
  folder=$(mktemp -d /dev/shm/underbrush.XXXXXX) || return 1
  cp "$(type -P true)" "$folder/true" && "$folder/true" 2> /dev/null && rm "$folder/true" && return
  rm -rf "$folder"
  return 1
}

[ -z "${TMPDIR:-}" ] && in_memory || folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export TMPDIR=$folder
"$@"
