#!/usr/bin/env bash
# A validation engineer has OSI traces of a simulator, and checks that the lidar's FMU finds the car ahead in them. FMU is
# the archive that `make fmu` builds, TRACES the traces (.osi). Run in an empty folder; users_test.py does so.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

for trace in $TRACES; do
  underbrush osi info "$trace"
  python3 "$here/step_fmu.py" "$FMU" "$trace" found_sd_.osi               # in FMPy
  underbrush osi info found_sd_.osi
  underbrush osi replay "$trace" -o replayed.json                         # the same without a master
  underbrush osi convert "$trace" -o true.json
  for list in found_sd_.osi replayed.json; do
    underbrush score true.json "$list" --json score.json
    python3 "$here/check_objects.py" score.json
  done
done
