"""Ouster's packets: closed forms in a room for all kinds of profiles, lost columns, metadata, and real captures."""
from __future__ import annotations

import hashlib
import json
import math
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import mutate_packets
import packet_files as pf
from packet_files import T0, Floats, Pixel
from underbrush.errors import FormatError
from underbrush.formats.ouster_metadata import Metadata
from underbrush.formats.packets import PacketRecording
from underbrush.formats.pcap import Capture
from underbrush.formats.scans import Scan

ROWS, COLUMNS = 32, 64
N_M = 0.02767  #: Distance of the beams' origin from the axis.


def beams() -> tuple[Floats, Floats]:
    """Directions and origins (columns, rows, 3) of the invented sensor in its own frame, one beam after the other.

    The lidar is turned by half a turn in the sensor and stands 5, -3 and 36.18 mm from its origin.
    """
    data = json.loads(pf.ouster_metadata(ROWS, COLUMNS, "LEGACY"))
    direction, origin = np.empty((COLUMNS, ROWS, 3)), np.empty((COLUMNS, ROWS, 3))
    for column in range(COLUMNS):
        encoder = 2 * math.pi * (1 - column / COLUMNS)
        for row in range(ROWS):
            azimuth = encoder - math.radians(data["beam_azimuth_angles"][row])
            up = math.radians(data["beam_altitude_angles"][row])
            lidar = (math.cos(azimuth) * math.cos(up), math.sin(azimuth) * math.cos(up), math.sin(up))
            direction[column, row] = (-lidar[0], -lidar[1], lidar[2])
            origin[column, row] = (-N_M * math.cos(encoder) + 0.005, -N_M * math.sin(encoder) - 0.003, 0.03618)
    return direction, origin


DIRECTION, ORIGIN = beams()
MISS = DIRECTION[..., 2] > math.sin(math.radians(12))
NEAR_MM: npt.NDArray[np.int64] = np.where(
    MISS, 0, np.round((pf.room_range(DIRECTION, ORIGIN) + N_M) * 1000 / 8).astype(int) * 8)
FAR_MM = np.where((np.arange(ROWS) % 3 == 0) & ~MISS, NEAR_MM + 480, np.where(np.arange(ROWS) % 3 == 1, NEAR_MM, 0))


def pixels(column: int, dual: bool) -> list[Pixel]:
    """With dual returns the strongest one is the far one in odd columns."""
    out: list[Pixel] = []
    for row in range(ROWS):
        pair = [int(NEAR_MM[column, row]), int(FAR_MM[column, row])]
        if column % 2 and dual:
            pair.reverse()
        out.append((pair[0], pair[1], (pair[0] // 10, pair[1] // 10), (pair[0] % 251, pair[1] % 251), 16 * (row % 7)))
    return out


def packets(profile: str, frames: list[int], lost: tuple[tuple[int, int], ...] = (), period_s: float = 0.1,
            **options: Any) -> list[tuple[float, bytes]]:
    """Times and data of the packets of frames; `lost` are (place of the frame, column) that are not valid."""
    out = []
    for place, frame in enumerate(frames):
        for begin in range(0, COLUMNS, 16):
            columns = []
            for column in range(begin, begin + 16):
                time_s = 1000 + (place + column / COLUMNS) * period_s
                columns.append((round(time_s * 1e9), column, pixels(column, "DUAL" in profile),
                                (place, column) not in lost))
            sent_s = T0 + (place + (begin + 15) / COLUMNS) * period_s  # With the last column.
            out.append((sent_s, pf.ouster_packet(profile, frame, columns, **options)))
    return out


def save(folder: pathlib.Path, data: list[tuple[float, bytes]], metadata: str | None = None, mtu: int = 65535,
         name: str = "a") -> pathlib.Path:
    if metadata is not None:
        (folder / f"{name}.json").write_text(metadata)
    path = folder / f"{name}.pcap"
    path.write_bytes(pf.pcap([(time_s, ip) for number, (time_s, packet) in enumerate(data)
                              for ip in pf.udp(packet, port=7502, identity=number, mtu=mtu)]))
    return path


def meta(profile: str, **more: Any) -> str:
    return pf.ouster_metadata(ROWS, COLUMNS, profile, **more)


def joined(scans: list[Scan], name: str) -> npt.NDArray[Any]:
    return np.concatenate([getattr(scan, name) for scan in scans])


@pytest.mark.parametrize("profile", pf.PIXELS)
def test_every_beam_in_a_room(tmp_path: pathlib.Path, profile: str) -> None:
    path = save(tmp_path, packets(profile, [7, 8, 9]), meta(profile), mtu=1500)
    recording = PacketRecording(path)
    scans = list(recording.scans())
    assert len(scans) == 3 and not recording.skipped
    for number, scan in enumerate(scans):
        assert scan.echo is not None and scan.range_m is not None and scan.direction is not None
        assert scan.origin is not None and scan.beam_time_s is not None and scan.intensity is not None
        assert scan.ring is not None
        beam = np.cumsum(scan.echo <= 1) - 1
        assert beam[-1] + 1 == ROWS * COLUMNS
        column, row = beam // ROWS, beam % ROWS
        assert (scan.ring == row).all() and (scan.extra["column"] == column).all()
        assert scan.direction == pytest.approx(DIRECTION[column, row], abs=1e-12)
        assert scan.origin == pytest.approx(ORIGIN[column, row], abs=1e-12)
        assert scan.beam_time_s == pytest.approx(T0 + (number + column / COLUMNS) * 0.1, abs=1e-6)
        near, far = NEAR_MM[column, row], FAR_MM[column, row]
        if "DUAL" in profile:
            two = (near > 0) & (far > near)
            assert (scan.echoes == (near > 0) + two.astype(int)).all()
            mm = np.where(scan.echo == 2, far, near)
            assert (scan.echo == 2).sum() == (two & (scan.echo == 1)).sum() > 0
        else:
            mm = near
            assert (scan.echo == (mm > 0)).all()
        assert scan.range_m == pytest.approx(np.where(mm > 0, mm / 1000 - N_M, np.inf), abs=1e-5)
        wall = mm == near
        hit = wall & (mm > 0)
        points = scan.origin[hit] + scan.direction[hit] * scan.range_m[hit][:, None]
        assert pf.off_walls(points).max() < 0.0041
        unit = mm // 10 if "SIG16" in profile or profile == "LEGACY" else mm % 251
        assert (scan.intensity == unit).all()
        assert (scan.extra["reflectivity"][mm > 0] == (mm % 251)[mm > 0]).all()
        assert (scan.extra["near_ir"] == 16 * (row % 7)).all()
    assert f"packets: {profile}, 32 rows x 64 columns" in recording.found()


def test_lost_packets_and_columns_are_counted(tmp_path: pathlib.Path) -> None:
    data = packets("LEGACY", [65534, 65535, 0, 1], lost=((1, 3), (2, 63)))
    del data[9]  # Columns 16 to 31 of the third frame.
    recording = PacketRecording(save(tmp_path, data[1:-1], meta("LEGACY")))  # It begins and ends inside a frame.
    scans = list(recording.scans())
    assert [len(scan) // ROWS for scan in scans] == [48, 63, 47, 48]
    assert recording.skipped == {"missing columns (lost packets or marked as not valid)": 1 + 17}
    recording = PacketRecording(save(tmp_path, packets("LEGACY", [4, 8, 9]), meta("LEGACY")))
    assert len(list(recording.scans())) == 3
    assert recording.skipped == {"frames that were lost whole": 3}


def test_late_and_doubled_packets(tmp_path: pathlib.Path) -> None:
    data = packets("RNG19_RFL8_SIG16_NIR16", [5, 6, 7, 8])
    late = data[:3] + data[4:6] + [data[3]] + data[6:] + [data[1]]  # One comes in the next frame, one much too late.
    late.insert(2, data[0])  # One comes twice, not in a row.
    recording = PacketRecording(save(tmp_path, late, meta("RNG19_RFL8_SIG16_NIR16")))
    scans = list(recording.scans())
    assert [len(scan) // ROWS for scan in scans] == [64] * 4
    assert recording.skipped == {"columns received twice": 16, "columns that came more than a frame late": 16}
    for scan in scans:
        assert scan.beam_time_s is not None and (np.diff(scan.beam_time_s) >= 0).all()


def test_a_restarted_sensor_goes_on(tmp_path: pathlib.Path) -> None:
    recording = PacketRecording(save(tmp_path, packets("LEGACY", [4000, 4001, 1, 2]), meta("LEGACY")))
    assert [len(scan) // ROWS for scan in recording.scans()] == [64] * 4


def test_a_window_of_columns_over_the_rear(tmp_path: pathlib.Path) -> None:
    """Columns 48 to 15 are sent; the window runs over the end of the frame."""
    data = [packet for number, packet in enumerate(packets("LEGACY", [3, 4])) if number % 4 in (0, 3)]
    order = [data[1], data[0], data[3], data[2]]
    recording = PacketRecording(save(tmp_path, order, meta("LEGACY", column_window=[48, 15])))
    scans = list(recording.scans())
    assert [scan.extra["column"][0] for scan in scans] == [48, 48]
    assert [len(scan) // ROWS for scan in scans] == [32, 32] and not recording.skipped


def test_new_metadata_and_headers(tmp_path: pathlib.Path) -> None:
    profile = "FUSA_RNG15_RFL8_NIR8_DUAL"
    nested = meta(profile, nested=True)
    data = packets("RNG15_RFL8_NIR8_DUAL", [70000, 70001], fusa=True)
    recording = PacketRecording(save(tmp_path, data, nested))
    scans = list(recording.scans())
    assert len(scans) == 2 and not recording.skipped
    assert joined(scans, "direction")[0] == pytest.approx(DIRECTION[0, 0])
    flat = Metadata.read(save(tmp_path, data, meta(profile), name="b").with_suffix(".json"))
    again = Metadata.read(tmp_path / "a.json")
    assert repr(flat) == repr(again)
    full = json.loads(meta("LEGACY"))
    full["beam_to_lidar_transform"] = [1, 0, 0, 27.67, 0, 1, 0, 0, 0, 0, 1, 10, 0, 0, 0, 1]
    recording = PacketRecording(save(tmp_path, packets("LEGACY", [1]), json.dumps(full), name="c"))
    scan = next(iter(recording.scans()))
    assert scan.origin is not None and scan.range_m is not None
    assert scan.origin[0] == pytest.approx(ORIGIN[0, 0] + [0, 0, 0.01])
    hit = np.isfinite(scan.range_m)
    assert NEAR_MM[0][hit[:ROWS]] / 1000 - scan.range_m[:ROWS][hit[:ROWS]] == pytest.approx(
        math.hypot(0.02767, 0.01), abs=1e-5)


def test_packets_of_another_sensor_on_the_same_port(tmp_path: pathlib.Path) -> None:
    one, other = (packets("RNG15_RFL8_NIR8", [1, 2], serial=serial) for serial in (123, 456))
    both = [packet for pair in zip(one, other) for packet in pair]
    recording = PacketRecording(save(tmp_path, both, meta("RNG15_RFL8_NIR8")))
    assert sum(map(len, recording.scans())) == 2 * ROWS * COLUMNS
    assert recording.skipped == {"packets of another sensor or kind": 8}


@pytest.mark.parametrize("clock", ["set", "free", "jumps"])
def test_clocks(tmp_path: pathlib.Path, clock: str) -> None:
    data = packets("LEGACY", [1, 2, 3])
    truth = np.repeat([T0 + (frame + column / COLUMNS) * 0.1 for frame in range(3) for column in range(COLUMNS)], ROWS)

    def moved(number: int, packet: bytes) -> bytes:
        add = round((T0 - 1000.25) * 1e9) if clock == "set" or clock == "jumps" and number >= 6 else 0
        size = len(packet) // 16
        return b"".join((int.from_bytes(packet[k:k + 8], "little") + add).to_bytes(8, "little") + packet[k + 8:k + size]
                        for k in range(0, len(packet), size))

    data = [(time_s, moved(number, packet)) for number, (time_s, packet) in enumerate(data)]
    recording = PacketRecording(save(tmp_path, data, meta("LEGACY")))
    times = joined(list(recording.scans()), "beam_time_s")
    off_s = {"set": [-0.25] * 3, "free": [0.0] * 3, "jumps": [0.0, 0.0, -0.25]}[clock]  # A set clock is believed.
    assert (times - truth)[::ROWS * COLUMNS] == pytest.approx(off_s, abs=1e-6)
    assert ("number of jumps: 1" in " ".join(recording.found())) == (clock == "jumps")


def test_what_is_missing_is_told_in_one_line(tmp_path: pathlib.Path) -> None:
    path = save(tmp_path, packets("LEGACY", [1]))
    with pytest.raises(FormatError, match=r"look like an Ouster's, which need its metadata: add --metadata a.json"):
        PacketRecording(path)
    (tmp_path / "other.json").write_text(meta("LEGACY"))
    with pytest.raises(FormatError, match=r"beside it lie other.json"):
        PacketRecording(path)
    assert PacketRecording(path, tmp_path / "other.json").sensor == ""  # The catalogue has no OS0-32.
    (tmp_path / "other.json").write_text(meta("RNG15_RFL8_NIR8"))
    with pytest.raises(FormatError, match=r"packets of 6464 bytes from .* do not fit the metadata .*other.json"):
        PacketRecording(path, tmp_path / "other.json")
    (tmp_path / "a_0.json").write_text(meta("LEGACY"))
    assert sum(map(len, PacketRecording(path).scans())) == ROWS * COLUMNS
    (tmp_path / "a_0.json").write_text("no metadata")
    with pytest.raises(FormatError, match=r"a_0.json: is no metadata"):
        PacketRecording(path)


@pytest.mark.parametrize("text, reason", [
    ("", "Expecting value"), ("[]", "no object"), ("{}", "'beam_altitude_angles' is missing"),
    ('{"beam_altitude_angles": [1, 2], "beam_azimuth_angles": [1]}', "same length"),
    ('{"beam_altitude_angles": [NaN], "beam_azimuth_angles": [1]}', "no sound number"),
    ('{"beam_altitude_angles": [1], "beam_azimuth_angles": [1], "lidar_mode": "10x10"}', "out of range"),
    ('{"beam_altitude_angles": [1], "beam_azimuth_angles": [1], "columns_per_frame": 99999999}', "out of range"),
    ('{"beam_altitude_angles": [1], "beam_azimuth_angles": [1], "udp_profile_lidar": "X"}', "profile X is not known"),
    ('{"beam_altitude_angles": [1], "beam_azimuth_angles": [1], "lidar_to_sensor_transform": [1]}', "reshape"),
    ("[" * 100000, "recursion"),
])
def test_bad_metadata_has_one_line(tmp_path: pathlib.Path, text: str, reason: str) -> None:
    path = tmp_path / "m.json"
    path.write_text(text)
    with pytest.raises(FormatError, match=reason) as error:
        Metadata.read(path)
    assert "m.json" in str(error.value) and "\n" not in str(error.value)


def test_mutants_are_read_or_refused(tmp_path: pathlib.Path) -> None:
    """A few of those that `mutate_packets.py` makes."""
    assert sum(mutate_packets.run("ouster", 90, 20, tmp_path).values()) == 90


# Real captures.

REAL = [("OS-0-32-U1_v2.2.0_1024x10", "OS-0-32-U1_v2.2.0_1024x10", 64, 1, 33.6, ""),
        ("OS-1-128_v2.3.0_1024x10_lb_n3", "OS-1-128_v2.3.0_1024x10", 192, 3, 18.0, "ouster-os1-128"),
        ("OS-1-64_1024x10_fw20", "OS-1-64_sensor_config_reduced", 64, 1, 74.4, "ouster-os1-64")]


@pytest.mark.parametrize("name, metadata, count, scans, misses, sensor", REAL)
def test_real_captures(name: str, metadata: str, count: int, scans: int, misses: float, sensor: str) -> None:
    folder = pf.data_folder()
    recording = PacketRecording(folder / f"{name}.pcap", folder / f"{metadata}.json")
    all_scans = list(recording.scans())
    assert len(all_scans) == scans and recording.sensor == sensor
    echo = joined(all_scans, "echo")
    beam_count = int((echo <= 1).sum())
    assert beam_count == scans * 1024 * (int(joined(all_scans, "ring").max()) + 1)
    assert 100 * (echo == 0).sum() / beam_count == pytest.approx(misses, abs=0.05)
    assert f"{count} packets" in recording.found()[1]
    assert set(recording.skipped) == {"datagrams to other ports or of other senders"}  # The inertial sensor's.
    assert np.linalg.norm(joined(all_scans, "direction"), axis=1) == pytest.approx(1)


def test_real_fields_have_the_makers_hashes() -> None:
    """The maker's digest has the MD5 of every field, pixel rows of each packet after each other, and of the images."""
    folder, name = pf.data_folder(), "OS-0-32-U1_v2.2.0_1024x10"
    digest = json.loads((folder / f"{name}_digest.json").read_text())
    metadata = Metadata.read(folder / f"{name}.json")
    data = [datagram.data for datagram in Capture(folder / f"{name}.pcap").datagrams()
            if len(datagram.data) == metadata.packet.itemsize]
    columns = np.frombuffer(b"".join(data), dtype=metadata.packet)["columns"]
    fields = {key.upper(): columns["pixels"][key] for key, _, _ in metadata.profile.fields}
    for key in ("RANGE", "RANGE2"):
        fields[key] = fields[key] & np.uint32((1 << 19) - 1)
    for key, values in fields.items():
        by_packet = values.transpose(0, 2, 1).tobytes()
        image = values.transpose(2, 0, 1).tobytes()
        assert hashlib.md5(by_packet).hexdigest() == digest["packet_hash"][key], key
        assert hashlib.md5(image).hexdigest() == digest["scans"][0][key], key
    assert hashlib.md5(columns["time_ns"].tobytes()).hexdigest() == digest["packet_hash"]["TIMESTAMP"]
    assert hashlib.md5(columns["id"].tobytes()).hexdigest() == digest["packet_hash"]["MEASUREMENT_ID"]

    # The scan has the same ranges, both returns in order of range.
    scan = next(iter(PacketRecording(folder / f"{name}.pcap").scans()))
    assert scan.range_m is not None and scan.echo is not None and scan.ring is not None
    images = [np.zeros((32, 1024), dtype=np.uint32) for _ in range(2)]
    hit = scan.echo > 0
    for echo, ranges in zip((1, 2), images):
        rows = scan.echo == echo
        ranges[scan.ring[rows], scan.extra["column"][rows]] = np.round((scan.range_m[rows] + 0.02767) * 1000)
    assert (scan.range_m[~hit] == np.inf).all()
    both = np.sort(np.stack([fields[key].transpose(2, 0, 1).reshape(32, 1024) for key in ("RANGE", "RANGE2")]), axis=0)
    once = (both[0] == both[1]) | (both[0] == 0)
    assert (images[0] == np.where(once, both[1], both[0])).all()
    assert (images[1] == np.where(once, 0, both[1])).all()


def test_real_points_through_the_makers_formula() -> None:
    """Points by the formula of the maker's manual, written out for single pixels."""
    folder, name = pf.data_folder(), "OS-0-32-U1_v2.2.0_1024x10"
    data = json.loads((folder / f"{name}.json").read_text())
    scan = next(iter(PacketRecording(folder / f"{name}.pcap").scans()))
    assert scan.range_m is not None and scan.direction is not None and scan.origin is not None and scan.ring is not None
    transform = np.array(data["lidar_to_sensor_transform"]).reshape(4, 4)
    n = data["lidar_origin_to_beam_origin_mm"]
    for index in np.flatnonzero(np.isfinite(scan.range_m))[::97]:
        row, column = int(scan.ring[index]), int(scan.extra["column"][index])
        r = float(scan.range_m[index]) * 1000 + n
        encoder = 2 * math.pi * (1 - column / 1024)
        azimuth = -2 * math.pi * data["beam_azimuth_angles"][row] / 360
        up = 2 * math.pi * data["beam_altitude_angles"][row] / 360
        x = (r - n) * math.cos(encoder + azimuth) * math.cos(up) + n * math.cos(encoder)
        y = (r - n) * math.sin(encoder + azimuth) * math.cos(up) + n * math.sin(encoder)
        z = (r - n) * math.sin(up)
        point = (transform @ [x, y, z, 1])[:3] / 1000
        assert scan.origin[index] + scan.direction[index] * scan.range_m[index] == pytest.approx(point, abs=1e-6)
