"""A ROS 2 node that answers the odometry of a vehicle with the point clouds of a running sensor server.

    ros2 run underbrush_live_ros node --ros-args -p address:=127.0.0.1:PORT -p token_file:=FILE

From each message on /odom (nav_msgs/Odometry, in the frame of the world) to the next one all sensors fire, and each
publishes /NAME/points (sensor_msgs/PointCloud2, in the frame NAME) and its place in the world on /tf.
"""
from __future__ import annotations

import pathlib
import sys
from typing import Any

import rclpy
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2, PointField
from tf2_ros import TransformBroadcaster

sys.path.append(str(pathlib.Path(__file__).resolve().parent))
from underbrush_live import SensorServer, pose  # noqa: E402


def cloud_message(cloud: Any, stamp: Any) -> PointCloud2:
    """A `Cloud` of the server as a message."""
    out = PointCloud2()
    out.header.stamp, out.header.frame_id = stamp, cloud.sensor
    out.height, out.width, out.point_step = cloud.height, cloud.width, cloud.point_step
    out.row_step, out.is_bigendian, out.is_dense = cloud.width * cloud.point_step, False, False
    for f in cloud.fields:
        field = PointField()
        field.name, field.offset, field.datatype, field.count = f.name, f.offset, f.datatype, 1
        out.fields.append(field)
    out.data = cloud.data
    return out


class LiveNode(Node):
    """Fires between the messages of an odometry."""

    def __init__(self) -> None:
        super().__init__("underbrush_live")
        self.declare_parameter("address", "")
        self.declare_parameter("token_file", "")
        self.declare_parameter("layout", "velodyne")
        self.server: SensorServer | None = None
        self.clouds: dict[str, Any] = {}
        self.places = TransformBroadcaster(self)
        self.create_subscription(Odometry, "odom", self.moved, 10)

    def moved(self, message: Odometry) -> None:
        """The vehicle is at the pose of a message now; the first one begins."""
        stamp, at = message.header.stamp, message.pose.pose
        time_s = stamp.sec + 1e-9 * stamp.nanosec
        p, q = at.position, at.orientation
        here = pose((p.x, p.y, p.z), (q.x, q.y, q.z, q.w))
        if self.server is None:
            token = pathlib.Path(self.get_parameter("token_file").value).read_text(encoding="utf-8").strip()
            self.server = SensorServer(self.get_parameter("address").value, token, time_s, here)
            self.began = stamp
            return
        if time_s <= self.server.time_s:
            return
        for part in self.server.parts(time_s, here, layout=self.get_parameter("layout").value):
            self.publish(part.cloud, self.began)
        self.began = stamp

    def publish(self, cloud: Any, stamp: Any) -> None:
        """Publishes the points of a sensor and where it was when it began to fire."""
        place = TransformStamped()
        place.header.stamp, place.header.frame_id, place.child_frame_id = stamp, "world", cloud.sensor
        at = cloud.world_from_sensor.world_from_body
        t, r = place.transform.translation, place.transform.rotation
        t.x, t.y, t.z = at.x, at.y, at.z
        r.x, r.y, r.z, r.w = at.qx, at.qy, at.qz, at.qw
        self.places.sendTransform(place)
        if cloud.sensor not in self.clouds:
            self.clouds[cloud.sensor] = self.create_publisher(PointCloud2, f"{cloud.sensor}/points", 10)
        self.clouds[cloud.sensor].publish(cloud_message(cloud, stamp))


def main() -> None:
    """Runs the node until it is ended."""
    rclpy.init()
    rclpy.spin(LiveNode())


if __name__ == "__main__":
    main()
