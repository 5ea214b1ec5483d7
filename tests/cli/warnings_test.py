#!/usr/bin/env python3
"""Warnings about logs that are not what they seem: poses that do not fit the scans, and fits that learn nothing."""
import json
import math
import pathlib
import random
import re
import struct
import sys
import tempfile

import cli_test

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "cases"))
import cases_test  # noqa: E402

NAMES = "x,y,z,ox,oy,oz,hit,time,intensity,ring,scan,packet,flags"


def turned(yaw, x, y):
    return math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y


class Warnings(cli_test.Failing):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def call(self, *words):
        done = cli_test.call(*words, cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def write_drive(self, turn=0.05, bend=0.03, step=1.0, scans=10):
        """Makes scans on a bend, 1 m apart, of 150 poles (seed 7), and their poses, right and inverted."""
        rnd = random.Random(7)
        poles = [(rnd.uniform(-35, 45), rnd.uniform(-35, 35)) for _ in range(150)]
        way = [(turn * k, step * k, bend * k * k) for k in range(scans)]
        (self.folder / "velodyne").mkdir()
        right, inverted = [], []
        for k, (yaw, x, y) in enumerate(way):
            points = []
            for px, py in poles:
                points += [(*turned(-yaw, px - x, py - y), 0.2 * up, 0.5) for up in range(-8, 20)]
            (self.folder / f"velodyne/{k:06}.bin").write_bytes(b"".join(struct.pack("<4f", *p) for p in points))
            for rows, turn, (tx, ty) in ((right, yaw, (x, y)), (inverted, -yaw, turned(-yaw, -x, -y))):
                c, s = math.cos(turn), math.sin(turn)
                rows.append(f"{c} {-s} 0 {tx} {s} {c} 0 {ty} 0 0 1 0\n")
        (self.folder / "right.txt").write_text("".join(right))
        (self.folder / "inverted.txt").write_text("".join(inverted))

    def test_poses_that_are_inverted_do_not_fit_the_scans(self):
        self.write_drive()
        done = self.call("import", ".", "--poses", "right.txt", "-o", "log.ply")
        self.assertEqual(done.stderr, "")
        done = self.call("import", ".", "--poses", "inverted.txt", "-o", "log.ply", "--json", "-")
        self.assertRegex(done.stderr, r"\Aunderbrush: warning: by the poses only \d+ % of a scan's points lie where "
                         r"the next one has some, and (9\d|100) % if they are inverted: are they sensor from world\?\n\Z")
        self.assertEqual(len(json.loads(done.stdout)["warnings"]), 1)

    def test_poses_whose_motion_is_not_that_of_the_scans(self):
        """All of one place, in km, without rotations, with axes swapped, and of another lag."""
        self.write_drive(turn=0.03, bend=0.02, step=1.2)
        rows = [list(map(float, line.split())) for line in (self.folder / "right.txt").read_text().splitlines()]

        def warned(of_row, cause):
            (self.folder / "wrong.txt").write_text("".join(" ".join(map(str, of_row(row))) + "\n" for row in rows))
            done = self.call("import", ".", "--poses", "wrong.txt", "-o", "log.ply")
            self.assertRegex(done.stderr, rf"\Aunderbrush: warning: by the poses the sensor {cause}.*: are .*\n\Z")
            self.assertRegex(done.stderr, r"[0-9]+ % if it moves by 1\.2 m and turns by 2°:|3\.\d m and turns by 5°")

        unturned = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
        warned(lambda row: unturned, "stands still")
        warned(lambda row: [v / 1000 if k % 4 == 3 else v for k, v in enumerate(row)], "stands still")
        warned(lambda row: [row[k] if k % 4 == 3 else v for k, v in enumerate(unturned)], "moves by")
        warned(lambda row: [*row[:3], row[7], *row[4:7], row[3], *row[8:]], "moves by")
        warned(lambda row: [row[0], row[4], row[8], row[3], row[1], row[5], row[9], row[7], *row[8:]], "moves by")
        scan = (self.folder / "velodyne/000000.bin").read_bytes()
        for k in range(10):
            (self.folder / f"velodyne/{k:06}.bin").write_bytes(scan)
        (self.folder / "still.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * 10)
        self.assertEqual(self.call("import", ".", "--poses", "still.txt", "-o", "log.ply").stderr, "")

    def write_hall(self, elevations, step_deg):
        """Two scans, 0.6 m apart, of a sensor 1.8 m above the floor of an empty hall of 24 by 18 by 3.5 m."""
        (self.folder / "velodyne").mkdir(exist_ok=True)
        for k in range(5):
            points = []
            for azimuth in range(0, 3600, int(10 * step_deg)):
                for elevation in elevations:
                    a, e = math.radians(azimuth / 10), math.radians(elevation)
                    d = math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)
                    walls = zip(d, (0.6 * k, 0, 1.8), ((-12, 12), (-9, 9), (0, 3.5)))
                    r = min((wall[c > 0] - o) / c for c, o, wall in walls if abs(c) > 1e-9)
                    points.append((*(r * c for c in d), 0.5))
            (self.folder / f"velodyne/{k:06}.bin").write_bytes(b"".join(struct.pack("<4f", *p) for p in points))
        (self.folder / "poses.txt").write_text("".join(f"1 0 0 {0.6 * k} 0 1 0 0 0 0 1 0\n" for k in range(5)))

    def test_circles_on_a_flat_ceiling_show_no_motion(self):
        """They lie where the ones before do if the sensor stands, which is not how it moves; few points tell nothing."""
        for elevations, step_deg in ((range(-15, 16, 2), 0.4), (range(-30, 31, 2), 0.4), (range(-15, 16, 2), 12)):
            with self.subTest(elevations=elevations, step_deg=step_deg):
                self.write_hall(elevations, step_deg)
                self.assertEqual(self.call("import", ".", "--poses", "poses.txt", "-o", "log.ply").stderr, "")

    def test_the_last_ring_on_flat_ground_is_no_maximum_range(self):
        """Its points have one range and elevation; those of beams without a return have one range only."""
        for elevations, said in (((-15, -10, -5), ""), ((-15, -10, -5, 0, 5), "beams without a return?")):
            points = []
            for k in range(900):
                for elevation in elevations:
                    a, e = math.radians(0.4 * k), math.radians(elevation)
                    r = min(30, -1.8 / math.sin(e) if e < 0 else 30)
                    points.append((r * math.cos(e) * math.cos(a), r * math.cos(e) * math.sin(a), r * math.sin(e), 0.5))
            (self.folder / "scan.bin").write_bytes(b"".join(struct.pack("<4f", *p) for p in points))
            stderr = self.call("import", "scan.bin", "--columns", "x,y,z,intensity", "-o", "log.ply").stderr
            self.assertEqual(stderr.count("\n"), len(said) > 0, stderr)
            self.assertIn(said, stderr)

    def test_a_slow_sensor_whose_poses_are_all_the_same(self):
        """At 0.6 m/s a scan shows motion against one that is many scans earlier."""
        self.write_drive(turn=0, bend=0, step=0.06, scans=40)
        for name, said in (("right.txt", ""), ("still.txt", r"stands still, .* the one \d+ scans later .*all poses the same")):
            (self.folder / "still.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n" * 40)
            done = self.call("import", ".", "--poses", name, "-o", "log.ply")
            self.assertRegex(done.stderr, said or r"\A\Z")
            self.assertEqual(done.stderr.count("\n"), len(said) > 0, done.stderr)

    def test_times_of_points_that_count_back(self):
        """A sensor at 6 m/s passes a wall; its points' times count back from their scan's stamp, or up to it."""
        (self.folder / "poses.txt").write_text("".join(f"{50 + 0.1 * k} {0.6 * k} 0 1.8 0 0 0 1\n" for k in range(-3, 5)))
        (self.folder / "times.txt").write_text("50\n50.1\n50.2\n")
        scans = self.folder / "scans"
        scans.mkdir()
        (scans / "times.txt").write_text("50\n50.1\n50.2\n")

        def written(time_of, words):
            right = []
            for k in range(3):
                rows = []
                for j in range(720 * 16):
                    before = 0.1 * (1 - (j // 16) / 720)  # s before the stamp; the sensor turns clockwise
                    azimuth, e = math.pi - 2 * math.pi * (j // 16) / 720, math.radians(-15 + 2 * (j % 16))
                    p = [20 * math.cos(e) * math.cos(azimuth), 20 * math.cos(e) * math.sin(azimuth), 20 * math.sin(e)]
                    rows.append(struct.pack("<5f", *p, j % 16, time_of(before)))
                    right.append(p[0] + 0.6 * k - 6 * before)
                head = ("FIELDS x y z ring time\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 1 1\n"
                        f"WIDTH {len(rows)}\nHEIGHT 1\nPOINTS {len(rows)}\nDATA binary\n")
                (scans / f"{k}.pcd").write_bytes(head.encode() + b"".join(rows))
            done = self.call("import", "scans", "--poses", "poses.txt", "--deskew", "velodyne-vlp16", *words, "-o", "log.ply")
            found = sorted(row["x"] for row in cases_test.rows_of(self.folder / "log.ply"))
            return max(abs(a - b) for a, b in zip(found, sorted(right))), done.stderr

        for time_of, words, said in ((lambda t: -t, (), False), (lambda t: t, (), True), (lambda t: t, ("before",), False),
                                     (lambda t: 0.1 - t, ("until",), False), (lambda t: -t, ("until",), False)):
            with self.subTest(words):
                off, stderr = written(time_of, ("--point-times", *words) if words else ())
                self.assertEqual("--point-times before" in stderr, said, stderr)
                self.assertEqual(off < 0.01, not said)

    def test_a_sensor_that_hangs_upside_down(self):
        """Poses that have the turn are right; those without it have the ground above the sensor."""
        (self.folder / "velodyne").mkdir()
        for k in range(2):
            points = [(0.5 * i, 0.5 * j, 1.8) for i in range(-20, 20) for j in range(-20, 20)]
            points += [(5 - k, -7, 1.8 - 0.1 * i) for i in range(30)]
            (self.folder / f"velodyne/{k:06}.bin").write_bytes(b"".join(struct.pack("<4f", *p, 0.5) for p in points))
        for turn, said in (("1 0 0 {} 0 -1 0 0 0 0 -1 0\n", ""), ("1 0 0 {} 0 1 0 0 0 0 1 0\n", "hang upside down?")):
            (self.folder / "poses.txt").write_text("".join(turn.format(k) for k in range(2)))
            done = self.call("import", ".", "--poses", "poses.txt", "-o", "log.ply")
            self.assertEqual(done.stderr.count("\n"), len(said) > 0, done.stderr)
            self.assertIn(said, done.stderr)

    def test_a_log_in_another_unit(self):
        """Its rays are as long in m once it is imported with its unit, and a warning names the option."""
        rows = [NAMES] + [f"{15000 + 10 * k},{k % 16},1000,0,0,2000,1,{k * 1e-5:.6f},0.5,{k % 16},0,{k // 16},0"
                          for k in range(640)]
        (self.folder / "mm.csv").write_text("\n".join(rows) + "\n")
        done = self.call("import", "mm.csv", "-o", "long.ply")
        self.assertIn("in mm? Then --unit mm", done.stderr)
        self.call("import", "mm.csv", "--unit", "mm", "-o", "right.ply")
        self.call("import", "long.ply", "--unit", "mm", "-o", "again.ply")
        (self.folder / "ground.obj").write_text("v -99 -99 -1\nv 99 -99 -1\nv 99 99 -1\nv -99 99 -1\nf 1 2 3 4\n")
        for words in (("fit", "long.ply", "-o", "out"), ("segment", "long.ply", "-o", "out.ply"),
                      ("movers", "long.ply", "-o", "out.ply"), ("score", "long.ply", "long.ply"),
                      ("perceive", "long.ply", "--pipeline", "real", "-o", "out.csv"),
                      ("simulate", "ground.obj", "--like", "long.ply", "-o", "out.ply")):
            with self.subTest(words[0]):
                done = cli_test.call(*words, cwd=self.folder)
                self.assertEqual((done.returncode, done.stderr.count("\n")), (3, 1), done.stderr)
                self.assertIn("--unit mm", done.stderr)
                self.assertFalse((self.folder / words[-1]).exists() and words[0] != "score")
        self.assertIn("--unit mm", self.call("info", "long.ply").stderr)
        long, right, again = (json.loads(self.call("info", f"{name}.ply", "--json", "-").stdout)
                              for name in ("long", "right", "again"))
        self.assertAlmostEqual(long["range_m"]["p50"], 1000 * right["range_m"]["p50"], delta=20)
        self.assertAlmostEqual(again["range_m"]["p50"], right["range_m"]["p50"], delta=0.02)

    def write_log(self, firings, name, *words):
        """Makes a log of ground and of a hedge 10 to 20 m away with gaps (seed 3). Returns the ranges, 0 of a miss."""
        rnd, rows, ranges = random.Random(3), [NAMES], []
        for k in range(16 * firings):
            azimuth, elevation = 2 * math.pi * (k // 16) / firings, math.radians(-15 + 2 * (k % 16))
            d = [math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation)]
            miss = rnd.random() < 0.3
            ranges.append(2 / -d[2] if d[2] < -0.05 else 0 if miss else 10 + 10 * rnd.random())
            end = [o + (ranges[-1] or 100) * c for o, c in zip((0, 0, 2), d)]
            rows.append(",".join(map(str, [*end, 0, 0, 2, int(ranges[-1] > 0), f"{k * 1e-5:.6f}", 0.5, k % 16, 0,
                                           k // 16, 0])))
        (self.folder / "log.csv").write_text("\n".join(rows) + "\n")
        self.call("import", "log.csv", "-o", name, *words)
        return ranges

    def warnings_of_fit(self, log):
        return json.loads(self.call("fit", log, "-o", "model", "--json", "-").stdout)["warnings"]

    def test_a_sound_log_gives_no_warning(self):
        self.write_log(200, "log.ply")
        self.assertEqual(self.warnings_of_fit("log.ply"), [])

    def assert_far(self, warning, limit_m, ranges):
        """The warning counts the returns beyond the limit, of all but the beams that are held out, at most a tenth."""
        found = re.match(r"(\d+) of (\d+) returns are beyond the log's maximum range of (\d+) m, .*--max-range", warning)
        self.assertTrue(found, warning)
        far, returns, limit = map(int, found.groups())
        hits = sum(r > 0 for r in ranges)
        self.assertEqual(limit, limit_m)
        self.assertTrue(0.9 * hits < returns <= hits, warning)
        self.assertAlmostEqual(far / returns, sum(r > limit_m for r in ranges) / hits, delta=0.02)

    def test_returns_beyond_the_maximum_range_are_counted(self):
        ranges = self.write_log(200, "log.ply", "--max-range", "12")
        warnings = self.warnings_of_fit("log.ply")
        self.assertEqual(len(warnings), 1, warnings)
        self.assert_far(warnings[0], 12, ranges)

    def test_a_fit_that_learns_nothing_says_so(self):
        for firings, cause in ((200, "the log has few beams"),
                               (2000, "check poses, ranges and misses of the log")):
            with self.subTest(firings):
                ranges = self.write_log(firings, "log.ply", "--max-range", "1")
                warnings = self.warnings_of_fit("log.ply")
                self.assertEqual(len(warnings), 3, warnings)
                self.assert_far(warnings[0], 1, ranges)
                self.assertIn("every step of the fit was undone", warnings[1])
                self.assertIn(cause, warnings[1])
                self.assertIn("the roughness of the log is not a number, so no grain was learnt", warnings[2])

    def test_another_sensor_on_the_path_of_a_log(self):
        """--trajectory takes a log; --like with another sensor keeps the log's beams, and says so."""
        self.write_drive()
        self.call("import", ".", "--poses", "right.txt", "-o", "log.ply")
        (self.folder / "ground.obj").write_text("v -99 -99 -1\nv 99 -99 -1\nv 99 99 -1\nv -99 99 -1\nf 1 2 3 4\n")
        words = ("simulate", "ground.obj", "--sensor", "velodyne-vlp16", "-o", "out.ply", "--json", "-")
        self.assertEqual(json.loads(self.call(*words, "--like", "log.ply").stdout).get("warnings", []), [])
        found = json.loads(self.call(*words, "--trajectory", "log.ply").stdout)
        self.assertGreater(found["beams"], 9 * 25000)  # 0.9 s from the first scan to the last.
        (self.folder / "UPPER.PLY").write_bytes((self.folder / "log.ply").read_bytes())
        self.assertEqual(json.loads(self.call(*words, "--trajectory", "UPPER.PLY", "--force").stdout)["beams"],
                         found["beams"])
        words = ("simulate", "ground.obj", "--sensor", "ouster-os1-64", "-o", "again.ply", "--json", "-")
        (warning,) = json.loads(self.call(*words, "--like", "out.ply").stdout)["warnings"]
        self.assertIn("a velodyne-vlp16; of --sensor ouster-os1-64 only the instrument is taken", warning)
        self.assertIn("--sensor ouster-os1-64 --trajectory out.ply", warning)

    def test_no_line_has_an_empty_name_of_a_sensor(self):
        """The log of the model names none."""
        self.write_drive()
        self.call("import", ".", "--poses", "right.txt", "-o", "log.ply")
        text = ""
        for words in (("info", "log.ply"), ("fit", "log.ply", "-o", "model"), ("info", "model"),
                      ("simulate", "model", "--like", "log.ply", "--element-ids", "-o", "like.ply"),
                      ("simulate", "model", "--sensor", "velodyne-vlp16", "--trajectory", "log.ply", "-o", "other.ply"),
                      ("score", "log.ply", "like.ply", "--model", "model")):
            done = self.call(*words)
            text += done.stdout + done.stderr
        self.assertIn("not used: they are of beams of the model's log with one echo", text)
        self.assertIn("learnt from a log of an unknown sensor", text)
        self.assertNotRegex(text, r"\b(of|by|are|is) +(with|in|and|is)\b|\b(of|by) *[,;:.(]|''|\"\"|sensor +\n")

    def test_a_log_without_misses_names_the_option(self):
        rows = [NAMES] + [f"{5 + 0.01 * k},{k % 16},1,0,0,2,1,{k * 1e-5:.6f},0.5,{k % 16},0,{k // 16},0"
                          for k in range(640)]
        (self.folder / "hits.csv").write_text("\n".join(rows) + "\n")
        self.call("import", "hits.csv", "-o", "hits.ply")
        self.assertIn("--infer-misses SENSOR", "\n".join(self.warnings_of_fit("hits.ply")))


if __name__ == "__main__":
    cli_test.main()
