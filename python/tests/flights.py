"""Generated airborne surveys: flights over a forest on rolling ground, whose sensor positions are known."""
from __future__ import annotations

import pathlib
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Way = Callable[[Floats], Floats]

ORIGIN = np.array([481000.0, 3812000.0, 0.0])


def straight(height_m: float, speed: float = 60.0, sway_m: float = 0.0, north_m: float = 0.0) -> Way:
    """A flight to the east, which sways to the side and up and down in 20 s."""
    def way(time: Floats) -> Floats:
        phase = 2 * np.pi * time / 20
        return np.column_stack([speed * time, north_m + sway_m * np.sin(phase),
                                height_m + ground(speed * time, 0 * time) + 0.3 * sway_m * np.cos(phase)])
    return way


def ground(x: Floats, y: Floats) -> Floats:
    """Height of the ground, m."""
    return np.asarray(200 + 5 * np.sin(x / 80) + 4 * np.cos(y / 60))


def survey(way: Way, seconds: float, *, start_s: float = 0.0, pulses_s: int = 2000, field_deg: float = 15.0,
           roll_deg: float = 0.0, pitch_deg: float = 0.0, several: float = 0.4, seed: int = 1) -> dict[str, Floats]:
    """Points of a flight: `xyz`, `time`, `number`, `count`, `angle` (degrees from the nadir, positive to the right).

    Pulses leave at even times in 30 sweeps a second. A part of them, `several`, have two to four returns on their line
    down to the ground; the last is there.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * pulses_s)) / pulses_s
    angle = field_deg * (2 * np.abs(2 * ((30 * time) % 1) - 1) - 1)
    seen = np.deg2rad(angle + roll_deg)
    origin = way(time)
    forward = way(time + 0.5) - way(time - 0.5)
    forward = forward[:, :2] / np.linalg.norm(forward[:, :2], axis=1, keepdims=True)
    right = forward[:, ::-1] * [1, -1]
    level = np.tan(seen)[:, None] * right + np.tan(np.deg2rad(pitch_deg)) * forward
    down = np.column_stack([level, -np.ones(len(time))])
    down /= np.linalg.norm(down, axis=1, keepdims=True)
    reach = np.zeros(len(time))
    for _ in range(20):  # The range of the ground, by fixed-point iterations.
        at = origin + reach[:, None] * down
        reach += (at[:, 2] - ground(at[:, 0], at[:, 1])) / -down[:, 2]
    count = np.where(rng.random(len(time)) < several, rng.integers(2, 5, len(time)), 1)
    pulse = np.repeat(np.arange(len(time)), count)
    number = np.arange(len(pulse)) - np.repeat(np.cumsum(count) - count, count) + 1
    above = np.where(number == count[pulse], 0, (count[pulse] - number) * rng.uniform(1.5, 6, len(pulse)))
    xyz = origin[pulse] + (reach[pulse] - above)[:, None] * down[pulse]
    order = np.lexsort((number, pulse))
    return {"xyz": (xyz + ORIGIN)[order], "time": start_s + time[pulse][order], "number": number[order].astype(float),
            "count": count[pulse][order].astype(float), "angle": angle[pulse][order]}


def write(path: pathlib.Path, *surveys: dict[str, Floats], scale: float = 0.01, angles: str = "whole",
          shuffled: bool = False) -> pathlib.Path:
    """Writes surveys as LAS 1.2; scan angles are `whole` degrees or `none`."""
    import laspy
    points = {name: np.concatenate([one[name] for one in surveys]) for name in surveys[0]}
    if shuffled:
        order = np.random.default_rng(2).permutation(len(points["time"]))
        points = {name: column[order] for name, column in points.items()}
    header = laspy.LasHeader(point_format=1, version="1.2")
    header.scales, header.offsets = np.full(3, scale), ORIGIN
    las = laspy.LasData(header)
    las.xyz = points["xyz"]
    las.gps_time = points["time"]
    las.return_number, las.number_of_returns = (points[name].astype(np.uint8) for name in ("number", "count"))
    if angles == "whole":
        las.scan_angle_rank = np.rint(points["angle"]).astype(np.int8)
    las.write(path)
    return path


_SENSOR = """\
name: airborne
kind: raster
shots_per_s: 3600
firings_per_packet: 100
raster: {azimuth_deg: [90, -90], elevation_deg: [-76, -90], step_deg: [180, 0.35], order: columns, serpentine: true}
min_range_m: 50
max_range_m: 1500
range_sigma_m: 0.02
divergence_mrad: [0.5, 0.5]
aperture_mm: 20
sub_rays: [5, 5]
wavelength_nm: 1064
receiver: {pulse_ns: 3, detects: {range_m: 1500, reflectance: 0.1}, returns: all, max_echoes: 5}
"""


def simulated(folder: pathlib.Path, height_m: float, seconds: float, seed: int) -> tuple[pathlib.Path, Way]:
    """A LAZ file of a flight that Underbrush simulates over a generated forest, and the sensor's way.

    The aircraft sways, rolls, pitches and flies with a crab angle. Scan angles are those at the nadir, in whole
    degrees, with the roll, and coordinates are rounded to 1 cm, as in files of surveys.
    """
    import underbrush
    from underbrush.formats.log import columns_of
    from underbrush.formats.trajectory import from_angles
    from underbrush.formats.write_las import LasWriter

    (folder / "airborne.yaml").write_text(_SENSOR)
    _write_forest(folder / "forest.obj", seconds * 60, height_m * 0.3, seed)
    way, time = straight(height_m, sway_m=5), np.linspace(-0.5, seconds + 0.5, int(20 * seconds) + 20)
    sway = np.sin(2 * np.pi * time / 7)
    rotation = from_angles(np.deg2rad(1.5 * sway), np.deg2rad(3 + 0.5 * sway), np.deg2rad(5 + sway))
    trajectory = underbrush.Trajectory(time, way(time), rotation)
    log = underbrush.simulate(folder / "forest.obj", sensor=underbrush.Sensor(str(folder / "airborne.yaml")),
                              trajectory=trajectory, super_sample="sensor", seed=seed)
    columns = columns_of(log)
    heading = np.array([np.cos(np.deg2rad(5)), np.sin(np.deg2rad(5))])
    to_right = log.direction[:, :2] @ np.array([heading[1], -heading[0]])
    columns["scan_angle"] = np.rint(np.rad2deg(np.arctan2(to_right, -log.direction[:, 2])))
    with LasWriter(folder / "flight.laz", resolution_m=0.01) as out:
        out.write(columns)
    return folder / "flight.laz", way


def _write_forest(path: pathlib.Path, length_m: float, half_width_m: float, seed: int) -> None:
    """Rolling ground and trees, whose leaves are triangles of a quarter of a square metre."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(-40, length_m + 41, 10.0), np.arange(-half_width_m, half_width_m + 1, 10.0))
    vertices = np.column_stack([x.ravel(), y.ravel(), ground(x.ravel(), y.ravel())])
    k = np.arange(x.size).reshape(x.shape)
    a, b, c, d = k[:-1, :-1].ravel(), k[:-1, 1:].ravel(), k[1:, 1:].ravel(), k[1:, :-1].ravel()
    quads = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    count = int(length_m * half_width_m * 2 / 60)
    foot = np.column_stack([rng.uniform(-20, length_m + 20, count), rng.uniform(-half_width_m, half_width_m, count)])
    tall = rng.uniform(8, 22, count)
    middle = np.repeat(np.column_stack([foot, ground(*foot.T) + 0.65 * tall]), 40, axis=0)
    middle += rng.normal(size=middle.shape) * np.repeat(np.column_stack([0.15 * tall, 0.15 * tall, 0.2 * tall]), 40,
                                                        axis=0)
    leaves = middle[:, None] + rng.normal(0, 0.5, (len(middle), 3, 3))
    triangles = np.arange(len(leaves) * 3).reshape(-1, 3) + len(vertices)
    with path.open("w", encoding="utf-8") as out:
        for v in np.concatenate([vertices, leaves.reshape(-1, 3)]):
            out.write("v {:.3f} {:.3f} {:.3f}\n".format(*v))
        for material, faces in (("ground", quads), ("leaf", triangles)):
            out.write(f"o {material}\nusemtl {material}\n")
            out.writelines("f {} {} {}\n".format(*face) for face in faces + 1)
