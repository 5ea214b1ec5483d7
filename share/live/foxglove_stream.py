"""Streams what the sensor server `underbrush live` measures to Foxglove, and into an MCAP file. It needs foxglove-sdk and
what underbrush_live.py beside it needs.

    python foxglove_stream.py ADDRESS --token FILE --trajectory poses.txt [--mcap drive.mcap] [--port 8765]

The vehicle drives along the poses (TUM: time x y z qx qy qz qw), from each to the next one of which the sensors fire.
With --port, Foxglove shows the scans as they are made (ws://127.0.0.1:PORT), in real time.
"""
from __future__ import annotations

import argparse
import pathlib
import time
from typing import Any

import foxglove
from foxglove import channels, messages
from underbrush_live import SensorServer, pose

#: The numbers of types in sensor_msgs/PointField, in their order from 1 on.
TYPES = [getattr(messages.PackedElementFieldNumericType, name)
         for name in ("Int8", "Uint8", "Int16", "Uint16", "Int32", "Uint32", "Float32", "Float64")]


class FoxgloveStream:
    """Clouds of a sensor server on /NAME/points for each sensor, in the sensor's frame, which /tf places in `world`.

    `mcap` is a new file, `port` that of a WebSocket server on this machine (0: a free one, `port` then says which).
    """

    def __init__(self, mcap: str | pathlib.Path | None = None, port: int | None = None) -> None:
        self.context = foxglove.Context()
        self.file = None if mcap is None else foxglove.open_mcap(mcap, context=self.context)
        self.server = None if port is None else foxglove.start_server(name="underbrush", port=port, context=self.context)
        self.port = self.server.port if self.server else None
        self.places = channels.FrameTransformChannel("/tf", context=self.context)
        self.points: dict[str, Any] = {}

    def send(self, cloud: Any) -> None:
        """Sends a `Cloud` of the server's answer, with the time of its firing."""
        at = cloud.world_from_sensor.world_from_body
        stamp_ns = round(1e9 * cloud.stamp_s)
        stamp = messages.Timestamp(sec=stamp_ns // 10**9, nsec=stamp_ns % 10**9)
        self.places.log(messages.FrameTransform(
            timestamp=stamp, parent_frame_id="world", child_frame_id=cloud.sensor,
            translation=messages.Vector3(x=at.x, y=at.y, z=at.z),
            rotation=messages.Quaternion(x=at.qx, y=at.qy, z=at.qz, w=at.qw)), log_time=stamp_ns)
        if cloud.sensor not in self.points:
            self.points[cloud.sensor] = channels.PointCloudChannel(f"/{cloud.sensor}/points", context=self.context)
        fields = [messages.PackedElementField(name=f.name, offset=f.offset, type=TYPES[f.datatype - 1])
                  for f in cloud.fields]
        self.points[cloud.sensor].log(messages.PointCloud(
            timestamp=stamp, frame_id=cloud.sensor, point_stride=cloud.point_step, fields=fields, data=cloud.data,
            pose=messages.Pose(position=messages.Vector3(x=0, y=0, z=0),
                               orientation=messages.Quaternion(x=0, y=0, z=0, w=1))), log_time=stamp_ns)

    def close(self) -> None:
        """Ends the file and the server."""
        if self.file:
            self.file.close()
        if self.server:
            self.server.stop()


def drive(server: SensorServer, rows: list[list[float]], stream: FoxgloveStream, in_time: bool) -> int:
    """Fires from each pose (time, position, quaternion) to the next; returns the number of clouds."""
    clouds, began = 0, time.monotonic()
    for row in rows[1:]:
        if in_time:
            time.sleep(max(0.0, row[0] - rows[0][0] - (time.monotonic() - began)))
        for part in server.parts(row[0], pose(row[1:4], row[4:]), layout="velodyne"):
            stream.send(part.cloud)
            clouds += 1
    return clouds


def main() -> None:
    """Streams a drive."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address", help="HOST:PORT that underbrush live prints")
    parser.add_argument("--token", required=True, type=pathlib.Path, help="file with the server's token")
    parser.add_argument("--trajectory", required=True, type=pathlib.Path, help="poses of the vehicle (TUM)")
    parser.add_argument("--mcap", type=pathlib.Path, help="the recording, a new file")
    parser.add_argument("--port", type=int, help="port of the WebSocket server (0: a free one)")
    arguments = parser.parse_args()
    lines = arguments.trajectory.read_text(encoding="utf-8").splitlines()
    rows = [[float(word) for word in line.split()] for line in lines if line.strip() and not line.startswith("#")]
    stream = FoxgloveStream(arguments.mcap, arguments.port)
    if stream.port:
        print(f"ws://127.0.0.1:{stream.port}", flush=True)
    token = arguments.token.read_text(encoding="utf-8").strip()
    server = SensorServer(arguments.address, token, rows[0][0], pose(rows[0][1:4], rows[0][4:]))
    print(drive(server, rows, stream, arguments.port is not None), "clouds")
    stream.close()


if __name__ == "__main__":
    main()
