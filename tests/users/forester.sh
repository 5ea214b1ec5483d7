#!/usr/bin/env bash
# A forester has an airborne scan without its trajectory, and wants a map of canopy heights. PLOTS are files CELL=FILE.laz,
# where CELL is the size of the map's cells in m. Run in an empty folder; users_test.py does so.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

for plot in $PLOTS; do
  cell=${plot%%=*} file=${plot#*=}
  underbrush info "$file"
  underbrush import "$file" -o log.ply --force                 # estimates the trajectory, and says how well
  underbrush fit log.ply -o model --force > fit.txt
  underbrush rasters model -o maps --cell "$cell" --force
  python3 "$here/check_canopy.py" maps/canopy_height.tif "$file" "$cell"
done
