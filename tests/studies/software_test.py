#!/usr/bin/env python3
"""Tests of what scripts/software_study.py computes with. Skipped with one line where NumPy is not installed."""
import importlib.util
import math
import pathlib
import struct
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
if importlib.util.find_spec("numpy") is None:
    print("skipped: NumPy is not installed")
    sys.exit(SKIPPED)
sys.path.insert(0, str(ROOT / "scripts"))
import numpy as np  # noqa: E402
from software import figures, ground, logs, odometry, sources, verdict  # noqa: E402

HEADER = """ply
format binary_little_endian 1.0
comment underbrush log {{}}
comment underbrush scan 4 0 1 2 3 0 0 0.7071067811865476 0.7071067811865476
element vertex {rows}
property double x
property double y
property double z
property double time
property float nx
property float ny
property float nz
property uchar alpha
property ushort ring
property uint scan
end_header
"""


def turned(axis, angle, translation=(0.0, 0.0, 0.0)):
    """A pose by Rodrigues' formula."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    out = np.eye(4)
    out[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    out[:3, 3] = translation
    return out


def path(steps=12, seed=1):
    """Steps of a drive that turns, and the poses that they lead to."""
    draw = np.random.default_rng(seed)
    moves = [turned(draw.normal(size=3), 0.2 * draw.random(), draw.normal(size=3)) for _ in range(steps)]
    poses = [turned((1, 2, 3), 0.7, (5.0, -3.0, 1.0))]
    for move in moves:
        poses.append(poses[-1] @ move)
    return moves, poses


def log_of(range_m, direction, ring=None, scan=None, poses=None, origin=None):
    direction = np.asarray(direction, float)
    n = len(direction)
    scan = np.zeros(n, int) if scan is None else np.asarray(scan)
    return logs.Log(np.zeros((n, 3)) if origin is None else np.asarray(origin, float),
                    direction / np.linalg.norm(direction, axis=1, keepdims=True), np.asarray(range_m, float),
                    scan.astype(float), np.zeros(n, int) if ring is None else np.asarray(ring), scan,
                    poses or {int(k): np.eye(4) for k in set(scan)})


class Odometry(unittest.TestCase):
    def test_an_exact_estimate_has_no_error_in_any_world(self):
        _, true = path()
        world = turned((0, 1, 1), 1.1, (100.0, 0.0, -7.0))
        errors = odometry.relative_errors(true, [world @ pose for pose in true])
        self.assertEqual(errors.shape, (12, 6))
        self.assertLess(np.abs(errors).max(), 1e-12)

    def test_a_known_fault_of_each_step_is_the_error(self):
        moves, true = path()
        fault, estimated = turned((0, 0, 1), 0.01, (0.03, 0.0, -0.04)), [np.eye(4)]
        for move in moves:
            estimated.append(estimated[-1] @ move @ fault)
        errors = odometry.relative_errors(true, estimated)
        np.testing.assert_allclose(errors, np.tile([0.03, 0, -0.04, 0, 0, 0.01], (12, 1)), atol=1e-12)
        self.assertAlmostEqual(odometry.rmse(errors[:, :3]), 0.05)
        self.assertAlmostEqual(odometry.rmse(errors[:, 3:]), 0.01)

    def test_a_fault_of_one_pose_is_in_two_steps(self):
        _, true = path()
        estimated = [pose.copy() for pose in true]
        estimated[5][:3, 3] += (0, 0, 0.5)
        wrong = np.linalg.norm(odometry.relative_errors(true, estimated)[:, :3], axis=1)
        np.testing.assert_allclose(wrong, [0.5 if k in (4, 5) else 0 for k in range(12)], atol=1e-12)

    def test_rotation_vector_is_axis_times_angle(self):
        for angle in (0.0, 1e-7, 0.3, 3.0):
            axis = np.array([2, -1, 2]) / 3
            np.testing.assert_allclose(odometry.rotation_vector(turned(axis, angle)[:3, :3]), axis * angle, atol=1e-9)

    def test_correlation_sees_shape_and_neither_size_nor_bias(self):
        draw = np.random.default_rng(3)
        one, other = draw.normal(size=(3000, 3)), draw.normal(size=(3000, 3))
        self.assertAlmostEqual(odometry.correlation(one, one), 1)
        self.assertAlmostEqual(odometry.correlation(one, 7 - 0.2 * one), -1)
        self.assertAlmostEqual(odometry.correlation(one + 5, one - 5), 1)
        self.assertLess(abs(odometry.correlation(one, other)), 0.05)
        self.assertAlmostEqual(odometry.correlation(one, one + other), math.sqrt(0.5), delta=0.03)

    def test_figures_of_errors_half_as_large(self):
        real = np.random.default_rng(4).normal(size=(40, 6))
        found = figures.odometry_figures(real, [real / 2, real / 2, real / 2])["rotation"]
        self.assertAlmostEqual(found["ratio"], 0.5)
        self.assertAlmostEqual(found["correlation"], 1)
        np.testing.assert_allclose(found["ratio_interval"], (0.5, 0.5))


class Logs(unittest.TestCase):
    def write(self, folder, rows, claimed=None):
        file = pathlib.Path(folder, "log.ply")
        file.write_bytes(HEADER.format(rows=claimed or len(rows)).encode()
                         + b"".join(struct.pack("<dddd3fBHI", *row) for row in rows))
        return file

    def test_a_log_is_read_and_its_cloud_is_in_the_frame_of_the_sensor(self):
        rows = [(1, 4, 3, 9, 0, -2, 0, 7, 5, 4), (1, 2, 103, 9, 0, 0, -100, 0, 6, 4)]
        with tempfile.TemporaryDirectory() as folder:
            log = logs.read(self.write(folder, rows))
            with self.assertRaises(ValueError):
                logs.read(self.write(folder, rows, 3))
        np.testing.assert_allclose(log.origin, [[1, 2, 3], [1, 2, 3]])
        np.testing.assert_allclose(log.direction, [[0, 1, 0], [0, 0, 1]])
        np.testing.assert_array_equal(log.range_m, [2, np.nan])
        self.assertEqual(log.scans(), [(4, slice(0, 2))])
        # The sensor stands at (1, 2, 3) and is turned to the left by a quarter.
        np.testing.assert_allclose(logs.clouds(log)[0], [[2, 0, 0]], atol=1e-7)

    def test_rounded_times_come_back_straight(self):
        true = [50 + 0.1035 * k for k in range(80)]
        straight = logs.straight_times([round(t, 2) for t in true])
        np.testing.assert_allclose(np.diff(straight), 0.1035)
        np.testing.assert_allclose(straight, true, atol=0.002)
        with self.assertRaises(ValueError):
            logs.straight_times([*true[:40], *true[41:]])

    def test_other_ranges_of_the_same_beams(self):
        log = log_of([5, 40, 5, 40, np.nan], [[1, 0, 0]] * 5)
        ours = log.answered(np.array([5.1, 40.1, 6, np.nan, 3]))
        found = [mix.range_m for mix in sources.mixed(log, ours).values()]
        np.testing.assert_array_equal(found[0], [5.1, 40.1, 5, 40, np.nan])
        np.testing.assert_array_equal(found[1], [5.1, 40.1, 6, 40, 3])
        np.testing.assert_array_equal(found[2], [5, 40, 6, np.nan, 3])
        even, odd = sources.half_of_beams(log)
        np.testing.assert_array_equal(even, [np.nan, 40, np.nan, 40, np.nan])
        np.testing.assert_array_equal(odd, [5, np.nan, 5, np.nan, np.nan])


class Ground(unittest.TestCase):
    def test_share_and_agreement(self):
        log = log_of([1, 1, 1, np.nan, np.nan], [[0, 0, -1]] * 5)
        other = log.answered(np.array([1, 1, np.nan, 1, np.nan]))
        real, found = np.array([1, 1, 0, 0, 0], bool), np.array([1, 0, 0, 1, 0], bool)
        self.assertAlmostEqual(ground.share(real, log), 2 / 3)
        self.assertAlmostEqual(ground.agreement(real, log, found, other), 2 / 4)
        self.assertAlmostEqual(ground.agreement(real, log, found, other, ~np.isnan(other.range_m)), 1 / 3)

    def test_the_sensor_stands_above_a_floor_with_bushes(self):
        draw = np.random.default_rng(5)
        points = np.column_stack([draw.uniform(-8, 8, (20000, 2)), np.full(20000, -1.73)])
        points[::3, 2] += draw.random(len(points[::3]))
        self.assertAlmostEqual(ground.sensor_height(points), 1.73)


class Verdict(unittest.TestCase):
    def found(self, ratio, correlation, difference):
        part = {"ratio": ratio, "correlation": correlation}
        scans = {"ground_share_ratio": 1.0, "ground_agreement": 0.9, "difference_ratio": difference}
        return verdict.checks({"odometry": {"drive": {"ours": {"translation": part, "rotation": part}}},
                               "scans": {"still": {"ours": scans, "floor": {**scans, "ground_agreement": 0.95}}}},
                              "ours", "floor", "still")

    def test_all_thresholds_count(self):
        self.assertEqual(verdict.verdict(self.found(1.0, 0.8, 1.2)), "holds")
        self.assertEqual(len(self.found(1.0, 0.8, 1.2)), 7)
        for ratio, correlation, difference, broken in ((0.8, 0.8, 1, 2), (1.2, 0.8, 1, 2), (1, 0.6, 1, 2),
                                                       (1, 0.8, 1.3, 1), (math.nan, 0.8, 1, 2)):
            checks = self.found(ratio, correlation, difference)
            self.assertTrue(verdict.verdict(checks).startswith("falls short: "))
            self.assertEqual(sum(not check.holds() for check in checks), broken)


if __name__ == "__main__":
    unittest.main()
