"""Packets of sensors inside ROS recordings: the same beams as in a room's closed form, with the recording's poses."""
from __future__ import annotations

import pathlib
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")

import hesai_unit as hesai  # noqa: E402
import livox_unit as livox  # noqa: E402
import packet_files as pf  # noqa: E402
import test_ouster as ouster  # noqa: E402
from bag_messages import Bag, bag, some_points  # noqa: E402
from packet_files import T0  # noqa: E402
from rosbags.typesys import get_types_from_msg  # noqa: E402
from velodyne_unit import UNITS, Truth, joined, observe, packets_of  # noqa: E402

from underbrush import LogReader  # noqa: E402
from underbrush.formats import FormatError, OptionMissing, beams, open_recording  # noqa: E402
from underbrush.formats.bag_packets import packets_in  # noqa: E402
from underbrush.import_recording import run  # noqa: E402

SCAN, PACKET = "velodyne_msgs/msg/VelodyneScan", "velodyne_msgs/msg/VelodynePacket"
STORAGES = ["ros1", "mcap", "sqlite3"]


def send_velodyne(out: Bag, packets: list[tuple[float, bytes]], topic: str = "/velodyne_packets", frame: str = "lidar",
                  ahead_s: float = 0.0) -> None:
    """Sends the packets in messages of 75; the recording's clock is ahead of the stamps."""
    store = out.store
    if SCAN not in store.types:
        store.register(get_types_from_msg(f"{'time' if out.ros1 else 'builtin_interfaces/Time'} stamp\nuint8[1206] data",
                                          PACKET))
        store.register(get_types_from_msg("std_msgs/Header header\nvelodyne_msgs/VelodynePacket[] packets", SCAN))
    time = store.types["builtin_interfaces/msg/Time"]
    for begin in range(0, len(packets), 75):
        part = packets[begin:begin + 75]
        out.send(topic, SCAN, part[-1][0] + ahead_s, store.types[SCAN](
            header=out.header(part[-1][0], frame),
            packets=[store.types[PACKET](stamp=time(sec=int(t), nanosec=round((t % 1) * 1e9)),
                                         data=np.frombuffer(data, np.uint8)) for t, data in part]))


def send_ouster(out: Bag, kind: str, packets: list[tuple[float, bytes]], topic: str, more: bytes = b"") -> None:
    if kind not in out.store.types:
        out.store.register(get_types_from_msg("uint8[] buf", kind))
    for time_s, data in packets:
        out.send(topic, kind, time_s, out.store.types[kind](buf=np.frombuffer(data + more, np.uint8)))


#: Messages of several packets -> the packet's fields besides its stamp.
MANY = {"hesai_ros_driver/msg/UdpFrame": "uint8[] data\nuint32 size", "pandar_msgs/msg/PandarScan": "uint8[] data\nuint32 size",
        "hesai_lidar/msg/PandarScan": "uint8[] data\nuint32 size", "nebula_msgs/msg/NebulaPackets": "uint8[] data",
        "pandar_msgs/msg/PandarScan of Tier IV": "uint8[1500] data\nuint32 size"}


def send_many(out: Bag, message: str, packets: list[tuple[float, bytes]], topic: str = "/packets") -> None:
    """Sends the packets in messages of seven."""
    kind, store = message.partition(" ")[0], out.store
    one = kind.rpartition("/")[0] + "/Packet"
    time = store.types["builtin_interfaces/msg/Time"]
    if kind not in store.types:
        stamp = f"{'time' if out.ros1 else 'builtin_interfaces/Time'} stamp\n"
        store.register(get_types_from_msg(stamp + MANY[message], one))
        store.register(get_types_from_msg("std_msgs/Header header\n" + one.replace("/msg/", "/") + "[] packets", kind))
    for begin in range(0, len(packets), 7):
        part = packets[begin:begin + 7]
        sent = []
        for t, data in part:
            full = data.ljust(1500, b"\0") if "1500" in MANY[message] else data
            size = {} if "size" not in MANY[message] else {"size": len(data)}
            sent.append(store.types[one](stamp=time(sec=int(t), nanosec=round((t % 1) * 1e9)),
                                         data=np.frombuffer(full, np.uint8), **size))
        out.send(topic, kind, part[-1][0], store.types[kind](header=out.header(part[-1][0], "hesai"), packets=sent))


def send_text(out: Bag, topic: str, text: str) -> None:
    out.send(topic, "std_msgs/msg/String", T0, out.store.types["std_msgs/msg/String"](data=text))


def drive(out: Bag, frame: str) -> None:
    """The sensor moves ahead at 10 m/s, turned left by a right angle."""
    for k in range(12):
        out.transform("/tf", T0 - 0.2 + 0.1 * k, "map", frame, [k - 2.0, 5, 2], [0, 0, np.sqrt(0.5), np.sqrt(0.5)])


def vlp16(path: pathlib.Path, storage: str, **options: Any) -> Truth:
    unit = UNITS["vlp16"]
    truth = observe(unit, 24 * 200)
    with bag(path, storage) as out:
        drive(out, "lidar")
        send_velodyne(out, packets_of(unit, truth, 0x37), **options)
    return truth


@pytest.mark.parametrize("storage", STORAGES)
def test_velodyne_packets_are_beams_in_the_world(tmp_path: pathlib.Path, storage: str) -> None:
    truth = vlp16(tmp_path / "bag", storage)
    recording = open_recording(tmp_path / "bag")
    assert recording.sensor == "velodyne-vlp16" and recording.organised
    found = "\n".join(recording.found())
    assert "packets of a sensor, decoded with their misses, frame lidar" in found
    assert "Velodyne" in found and "poses from /tf: map -> lidar" in found
    back = {name: np.concatenate([piece[name] for piece in beams(recording)])
            for name in ("origin", "direction", "range_m", "time_s", "ring", "scan")}
    assert not recording.skipped and len(back["ring"]) == len(truth.ring)
    np.testing.assert_array_equal(back["ring"], truth.ring)
    np.testing.assert_allclose(back["time_s"], truth.time_s, atol=2e-6)
    np.testing.assert_allclose(back["range_m"], np.where(truth.strongest > 0, truth.strongest * 0.002, np.inf), atol=1e-4)
    along = np.column_stack([10 * (truth.time_s - T0), np.full(len(truth.ring), 5), np.full(len(truth.ring), 2)])
    np.testing.assert_allclose(back["origin"], along, atol=1e-4)
    turned = np.column_stack([-truth.direction[:, 1], truth.direction[:, 0], truth.direction[:, 2]])
    np.testing.assert_allclose(back["direction"], turned, atol=3e-4)  # Azimuths are in steps of 0.01 degrees.
    assert back["scan"][-1] == 3


@pytest.mark.parametrize("message", MANY)
@pytest.mark.parametrize("storage", ["ros1", "mcap"])
@pytest.mark.parametrize("name", ["xt32", "pandar40p"])
def test_hesai_packets_of_all_drivers(tmp_path: pathlib.Path, storage: str, message: str, name: str) -> None:
    unit = hesai.UNITS[name]
    truth = hesai.observe(unit, unit.blocks * 50)
    with bag(tmp_path / "bag", storage) as out:
        drive(out, "hesai")
        send_many(out, message, hesai.packets_of(unit, truth))
    angles = hesai.correction(tmp_path / "c.csv", unit) if unit.needs_file else None
    recording = open_recording(tmp_path / "bag", metadata=angles)
    assert recording.sensor == unit.sensor and recording.organised and not recording.skipped
    scans = list(recording.scans())
    order = np.argsort(unit.laser_us, kind="stable")
    np.testing.assert_array_equal(joined(scans, "ring"), np.tile(order, unit.blocks * 50))
    np.testing.assert_allclose(joined(scans, "beam_time_s"), truth.time_s[:, order].ravel(), atol=2e-6)
    np.testing.assert_allclose(joined(scans, "direction"), truth.direction[:, order].reshape(-1, 3), atol=3e-4)
    counts = truth.counts[:, 0, order].ravel()
    np.testing.assert_allclose(joined(scans, "range_m"), np.where(counts, counts * 0.004, np.inf), atol=1e-4)


def test_livox_packets_in_a_bag(tmp_path: pathlib.Path) -> None:
    """Cartesian points without a return have no direction, so that the recording has no misses."""
    for name, organised in (("mid360 spherical", True), ("mid360 high", False)):
        with bag(tmp_path / name) as out:
            send_many(out, "nebula_msgs/msg/NebulaPackets", livox.packets_of(name, 30))
        recording = open_recording(tmp_path / name)
        assert recording.sensor == "livox-mid360" and recording.organised == organised
        assert ("with their misses" in recording.found()[1]) == organised
        assert sum(map(len, recording.scans())) == (livox.observe(livox.KINDS[name], 30).depth_mm.any(axis=1).sum()
                                                    if not organised else 30 * 96)


@pytest.mark.parametrize("storage", STORAGES)
def test_the_command_imports_packets(tmp_path: pathlib.Path, storage: str, capsys: pytest.CaptureFixture[str]) -> None:
    truth = vlp16(tmp_path / "bag", storage)
    assert run([str(tmp_path / "bag"), "-o", str(tmp_path / "log.ply")]) == 0
    hits = int((truth.strongest > 0).sum())
    assert f"{len(truth.ring)} rows: {hits} hits, {len(truth.ring) - hits} misses" in capsys.readouterr().out
    info = LogReader(tmp_path / "log.ply").info
    assert info.sensor == "velodyne-vlp16" and info.has_misses
    assert [round(scan.time_s - T0, 3) for scan in info.scans] == [0.0, 0.003, 0.103, 0.203]


def test_the_clock_of_the_recording(tmp_path: pathlib.Path) -> None:
    vlp16(tmp_path / "bag", "mcap", ahead_s=50.0)
    first = next(open_recording(tmp_path / "bag").scans())
    assert first.beam_time_s is not None and first.beam_time_s[0] == pytest.approx(T0, abs=1e-3)
    first = next(open_recording(tmp_path / "bag", clock="bag").scans())
    assert first.beam_time_s is not None and first.beam_time_s[0] == pytest.approx(T0 + 50, abs=2e-3)


@pytest.mark.parametrize(("storage", "kind", "more"), [
    ("ros1", "ouster_ros/msg/PacketMsg", b"\0"), ("mcap", "ouster_sensor_msgs/msg/PacketMsg", b""),
    ("sqlite3", "ouster_msgs/msg/PacketMsg", b"")])
def test_ouster_packets_with_the_recordings_metadata(tmp_path: pathlib.Path, storage: str, kind: str,
                                                    more: bytes) -> None:
    data = ouster.packets("LEGACY", [7, 8, 9])
    with bag(tmp_path / "bag", storage) as out:
        drive(out, "os_sensor")
        send_text(out, "/chatter", "no metadata")
        send_text(out, "/ouster/metadata", ouster.meta("LEGACY"))
        send_ouster(out, kind, [(t, b"\1" * 48) for t, _ in data], "/ouster/imu_packets", more)
        send_ouster(out, kind, data, "/ouster/lidar_packets", more)
    recording = open_recording(tmp_path / "bag")
    scans = list(recording.scans())
    expected = list(ouster.PacketRecording(ouster.save(tmp_path, data, ouster.meta("LEGACY"))).scans())
    assert len(scans) == 3 and not recording.skipped
    for name in ("direction", "range_m", "origin", "ring", "intensity", "beam_time_s"):
        np.testing.assert_allclose(joined(scans, name), joined(expected, name), atol=1e-6, err_msg=name)
    beam = np.cumsum(joined(scans, "echo") <= 1) - 1
    np.testing.assert_allclose(joined(scans, "direction"), ouster.DIRECTION.reshape(-1, 3)[beam % (32 * 64)], atol=1e-12)
    assert "poses from /tf: map -> os_sensor; 12 of them within 11.0 x 0.0 x 0.0 m" in recording.found()


def test_what_ousters_packets_need_is_named(tmp_path: pathlib.Path) -> None:
    data = ouster.packets("LEGACY", [7, 8])
    kind = "ouster_sensor_msgs/msg/PacketMsg"
    with bag(tmp_path / "bag") as out:
        send_ouster(out, kind, data, "/left/lidar_packets")
        send_ouster(out, kind, data, "/right/lidar_packets")
        send_text(out, "/left/metadata", ouster.meta("LEGACY"))
        send_text(out, "/right/metadata", ouster.meta("RNG19_RFL8_SIG16_NIR16"))
    recording = open_recording(tmp_path / "bag")
    with pytest.raises(OptionMissing, match="add --topic /left/lidar_packets or --topic /right/lidar_packets"):
        next(recording.scans())
    assert len(list(open_recording(tmp_path / "bag", topic="/left/lidar_packets").scans())) == 2
    with pytest.raises(FormatError, match="6464 bytes from /right/lidar_packets do not fit the metadata /right/metadata"):
        open_recording(tmp_path / "bag", topic="/right/lidar_packets")
    (tmp_path / "given.json").write_text(ouster.meta("LEGACY"))
    right = open_recording(tmp_path / "bag", topic="/right/lidar_packets", metadata=tmp_path / "given.json")
    assert len(list(right.scans())) == 2
    with bag(tmp_path / "bare") as out:
        send_ouster(out, kind, data, "/lidar_packets")
    with pytest.raises(FormatError, match="6464 bytes from /lidar_packets look like an Ouster's.*add --metadata bare.json"):
        open_recording(tmp_path / "bare")


def test_point_clouds_come_first_and_the_topic_chooses(tmp_path: pathlib.Path) -> None:
    unit = UNITS["hdl32e"]
    truth = observe(unit, 720)
    with bag(tmp_path / "bag") as out:
        out.cloud("/points", T0, some_points())
        send_velodyne(out, packets_of(unit, truth, 0x37))
    assert [len(scan) for scan in open_recording(tmp_path / "bag").scans()] == [64]
    recording = open_recording(tmp_path / "bag", topic="/velodyne_packets")
    assert sum(map(len, recording.scans())) == len(truth.ring)
    with pytest.raises(ValueError, match="no point clouds in /none: /points, /velodyne_packets"):
        open_recording(tmp_path / "bag", topic="/none")


@pytest.mark.parametrize("storage", STORAGES)
def test_broken_messages_of_packets_are_counted(tmp_path: pathlib.Path, storage: str) -> None:
    unit = UNITS["hdl32e"]
    packets = packets_of(unit, observe(unit, 1800), 0x37)
    with bag(tmp_path / "bag", storage) as out:
        send_velodyne(out, packets[:75])
        out.raw("/velodyne_packets", SCAN, packets[75][0], b"\0\1\0\0nonsense" * 3)
        send_velodyne(out, packets[75:])
    recording = open_recording(tmp_path / "bag")
    assert sum(map(len, recording.scans())) == 32 * 1800
    assert recording.skipped == {"messages that cannot be read": 1}


@pytest.mark.parametrize("kind", ["rslidar_msg/msg/RslidarPacket", "livox_msgs/msg/LivoxPackets"])
def test_packets_of_other_makers_are_refused_by_name(tmp_path: pathlib.Path, kind: str) -> None:
    with bag(tmp_path / "bag") as out:
        out.store.register(get_types_from_msg("uint8[] data", kind))
        out.send("/raw", kind, T0, out.store.types[kind](data=np.zeros(1000, np.uint8)))
    with pytest.raises(FormatError, match=rf"packets of a kind that is not decoded, in /raw \({kind}\): have the driver"):
        open_recording(tmp_path / "bag")


def test_a_scan_without_packets_is_refused_by_name(tmp_path: pathlib.Path) -> None:
    with bag(tmp_path / "bag") as out:
        out.store.register(get_types_from_msg("uint8 nothing", SCAN))
        out.raw("/raw", SCAN, T0, b"\0\1\0\0" + b"\0" * 8 + b"\1\0\0\0" + b"\0" * 8)
    with pytest.raises(FormatError, match=rf"and no packet of a lidar in /raw \({SCAN}\)"):
        open_recording(tmp_path / "bag")


def test_points_lie_on_the_walls(tmp_path: pathlib.Path) -> None:
    """The points of packets in a recording lie on the walls of the room that they show."""
    vlp16(tmp_path / "bag", "mcap")
    for scan in open_recording(tmp_path / "bag").scans():
        assert scan.direction is not None and scan.range_m is not None
        hit = np.isfinite(scan.range_m)
        assert pf.off_walls(scan.direction[hit] * scan.range_m[hit, None]).max() < 0.006


@pytest.mark.parametrize("ros1", [False, True])
def test_no_damage_of_a_message_does_more_than_refuse_it(ros1: bool) -> None:
    head = (b"" if ros1 else b"\0\1\0\0") + b"\0" * (12 if ros1 else 8) + b"\5\0\0\0lidar"
    head += b"" if ros1 else b"\0" * 3
    good = head + b"\2\0\0\0" + (b"\1\0\0\0\2\0\0\0" + b"\xff" * 1206 + (b"" if ros1 else b"\0\0")) * 2
    packets, frame = packets_in(SCAN, good, 0.0, ros1, False)
    assert frame == "lidar" and [len(packet.data) for packet in packets] == [1206, 1206]
    assert packets[0].time_s == pytest.approx(1 + 2e-9)
    rng = np.random.default_rng(5)
    for size in range(0, len(good) - 2, 13):
        with pytest.raises(ValueError, match="too short"):
            packets_in(SCAN, good[:size], 0.0, ros1, False)
    for _ in range(300):
        bad = bytearray(good)
        bad[int(rng.integers(len(head) + 4))] = int(rng.integers(256))
        for kind in (SCAN, "ouster_ros/msg/PacketMsg", *(message.partition(" ")[0] for message in MANY)):
            try:
                packets_in(kind, bytes(bad), 0.0, ros1, True)
            except ValueError as error:
                assert "too short" in str(error)
