#!/usr/bin/env bash
# A perception engineer has a bag with transforms and odometry, and wants to know what another lidar would have measured
# on the same drive. Run in an empty folder, with `underbrush` and its packages on the PATH; users_test.py does so.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

python3 "$here/make_drive.py" drive                                      # a ROS 2 bag
underbrush info drive
underbrush import drive --infer-misses velodyne-vlp16 -o log.ply
underbrush fit log.ply -o model > fit.txt
underbrush simulate model --sensor ouster-os1-64 --trajectory log.ply -o os1.mcap
underbrush info os1.mcap
python3 "$here/check_drive.py" log.ply os1.mcap
