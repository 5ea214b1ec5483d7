#!/usr/bin/env bash
# Runs a command with a folder of its own for temporary files, which is deleted afterwards. The folder lies in TMPDIR
# where that is set, and else in memory where 8 GB are free there and programs may run: some file systems are slow with
# thousands of short-lived files.
#
#   scripts/with_scratch.sh COMMAND...
set -euo pipefail
least_kb=8000000

in_memory() {
  [ -w /dev/shm ] && [ "$(df -Pk /dev/shm | awk 'NR == 2 { print $4 }')" -ge "$least_kb" ] || return 1
  [ "$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)" -ge "$least_kb" ] || return 1
  folder=$(mktemp -d /dev/shm/underbrush.XXXXXX) || return 1
  cp "$(type -P true)" "$folder/true" && "$folder/true" 2> /dev/null && rm "$folder/true" && return
  rm -rf "$folder"
  return 1
}

[ -z "${TMPDIR:-}" ] && in_memory || folder=$(mktemp -d)
trap 'rm -rf "$folder" || :' EXIT

set -m  # The command has a group of its own, all of which gets the signals.
TMPDIR=$folder "$@" &
command=$!
trap 'kill -INT -- "-$command"' INT
trap 'kill -TERM -- "-$command"' TERM HUP
status=0
wait "$command" || status=$?
while kill -0 "$command" 2> /dev/null; do  # A signal ended the wait, not yet the command.
  status=0
  wait "$command" || status=$?
done
exit "$status"
