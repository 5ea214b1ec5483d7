#!/usr/bin/env python3
"""Situations that people reported, each a folder here with a small input, the command that a user gives, and the right
value: what the log must hold, by arithmetic on the input, or one clear line and an exit code that is not zero.

  cases_test.py --program build/bin/underbrush       the cases of the program
  cases_test.py --build build                        the cases of the Python front end, in the tests' environment
"""
import argparse
import gzip
import importlib.util
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
FRONT = []  # the command under test
ENVIRONMENT = dict(os.environ)
TYPES = {"double": "d", "float": "f", "uchar": "B", "ushort": "H", "uint": "I", "int": "i"}
PCD_TYPES = {"F4": "f", "F8": "d", "U1": "B", "U2": "H", "U4": "I", "I2": "h"}


def rows_of(path):
    """The rows of a log or of a binary PCD file, each as {column: number}."""
    data = path.read_bytes()
    if path.suffix == ".pcd":
        head, _, data = data.partition(b"DATA binary\n")
        lines = {line.split()[0]: line.split()[1:] for line in head.decode().splitlines()[1:]}
        columns = [(PCD_TYPES[kind + size], name) for name, kind, size in zip(*(lines[k] for k in
                   ("FIELDS", "TYPE", "SIZE")))]
        data = data[:int(lines["POINTS"][0]) * struct.calcsize("<" + "".join(kind for kind, _ in columns))]
    else:
        head, _, data = data.partition(b"end_header\n")
        columns = [(TYPES[line.split()[1]], line.split()[2]) for line in head.decode().splitlines()
                   if line.startswith("property")]
    layout = "<" + "".join(kind for kind, _ in columns)
    return [dict(zip((name for _, name in columns), row)) for row in struct.iter_unpack(layout, data)]


def floats(path, columns):
    """The first three of the columns of a file of 32-bit floats."""
    return [row[:3] for row in struct.iter_unpack(f"<{columns}f", path.read_bytes())]


def points(rows):
    return [(row["x"], row["y"], row["z"]) for row in rows]


def origins(rows):
    """Where the rays of a log begin; its columns nx, ny, nz lead from the point to there."""
    return sorted({tuple(round(row[c] + row["n" + c], 3) for c in "xyz") for row in rows})


class Cases(unittest.TestCase):
    def run_case(self, *words):
        """Runs the command in the case's folder; `self.log` is its output."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        own = HERE / self._testMethodName.removeprefix("test_")
        self.folder = own if own.is_dir() else HERE
        self.out = pathlib.Path(folder.name)
        self.log = self.out / "log.ply"
        self.done = subprocess.run([*FRONT, *(w.replace("OUT", folder.name) for w in words)], cwd=self.folder,
                                   capture_output=True, text=True, check=False, timeout=120, env=ENVIRONMENT)
        self.said = self.done.stdout + self.done.stderr

    def refused(self, *words, code=3):
        """Checks for an exit code and one line that has these words."""
        self.assertEqual(self.done.returncode, code, self.said)
        self.assertEqual(self.done.stderr.count("\n"), 1, self.said)
        self.assertRegex(self.done.stderr, "^underbrush: ")
        self.assertFalse(self.log.exists())
        for word in words:
            self.assertIn(word, self.done.stderr)

    def rows(self, *words):
        """The rows of the log, once the command has said these words and ended well."""
        self.assertEqual(self.done.returncode, 0, self.said)
        for word in words:
            self.assertIn(word, self.said)
        return rows_of(self.log)

    def same_points(self, found, right, error=0.002):
        self.assertEqual(len(found), len(right))
        worst = max(map(math.dist, sorted(found), sorted(right)))
        if worst > error:  # Rounded points may be in another order.
            worst = max(min(math.dist(p, q) for q in right) for p in found)
        self.assertLess(worst, error)

    def hits(self):
        return sum("nan" not in str(row["x"]) and row.get("alpha", 255) != 0 for row in self.rows())


class Program(Cases):
    def test_cloudcompare_count(self):
        self.run_case("import", "cc.txt", "-o", "OUT/log.ply")
        lines = (self.folder / "cc.txt").read_text().splitlines()[2:]
        self.same_points(points(self.rows()), [tuple(map(float, line.split())) for line in lines])

    def test_csv_bom(self):
        self.run_case("import", "excel.csv", "-o", "OUT/log.ply")
        lines = (self.folder / "excel.csv").read_text(encoding="utf-8-sig").splitlines()[1:]
        self.same_points(points(self.rows()), [tuple(map(float, line.split(",")[:3])) for line in lines])

    def test_empty_frame(self):
        self.run_case("import", "emptyframe", "-o", "OUT/log.ply")
        rows = self.rows("empty")
        self.assertEqual((len(rows), {row["scan"] for row in rows}), (1000, {0, 2}))

    def test_euroc_poses_wxyz(self):
        self.run_case("import", "drive", "-o", "OUT/log.ply")
        half = math.sqrt(0.5)
        raw = points(rows_of(next((self.folder / "drive").glob("*.pcd"))))
        self.same_points(points(self.rows("qw")), [(half * (x - y), half * (x + y), z) for x, y, z in raw])

    def test_a_packed_file(self):
        plain = (HERE / "csv_bom/excel.csv").read_bytes()
        with tempfile.TemporaryDirectory() as folder:
            packed = pathlib.Path(folder, "excel.csv.gz")
            packed.write_bytes(gzip.compress(plain))
            self.run_case("import", str(packed), "-o", "OUT/log.ply")
            lines = plain.decode("utf-8-sig").splitlines()[1:]
            self.same_points(points(self.rows()), [tuple(map(float, line.split(",")[:3])) for line in lines])
            for broken, word in ((gzip.compress(plain)[:-20], "cut off"), (plain, "no file of gzip"),
                                 (gzip.compress(b"a,b\n1,2\n"), "excel.csv.gz: header: no column 'x'")):
                packed.write_bytes(broken)
                self.run_case("import", str(packed), "-o", "OUT/log.ply")
                self.refused(word)

    def test_gltf_instanced(self):
        self.run_case("simulate", "instanced.gltf", "--like", "like.ply", "-o", "OUT/log.ply")
        self.refused("EXT_mesh_gpu_instancing")

    def test_helios_dup_times(self):
        self.run_case("import", "trj_dup.xml", "-o", "OUT/s")
        self.assertEqual(self.done.returncode, 0, self.said)
        poses = [line.split() for line in (self.out / "s/leg-0.txt").read_text().splitlines() if line[0] != "#"]
        self.assertEqual([float(poses[0][0]), float(poses[-1][0])], [100, 101.2])
        self.assertEqual(len(poses), 13)

    def test_helios_geotiff(self):
        self.run_case("simulate", "tif.xml", "--like", "like.ply", "-o", "OUT/log.ply")
        self.rows("242 hits")

    def test_helios_header(self):
        self.run_case("import", "trj_header_idx.xml", "-o", "OUT/s")
        self.assertEqual(self.done.returncode, 0, self.said)
        lines = (line.split() for line in (self.out / "s/leg-0.txt").read_text().splitlines() if line[0] != "#")
        self.same_points([tuple(map(float, next(lines)))], [(100, -3, 0, 3, 0, 0, 0, 1)], 1e-3)

    def test_kitti360(self):
        self.run_case("import", "k360", "--poses", "k360/poses.txt", "-o", "OUT/log.ply")
        rows = self.rows()
        self.assertEqual([o[0] for o in origins(rows)], [1, 2, 4])
        first = min(row["time"] for row in rows)
        self.assertEqual(sorted({round(row["time"] - first, 3) for row in rows}), [0, 0.1, 0.3])

    def test_kitti_calib_no_tr(self):
        self.run_case("import", "drive", "-o", "OUT/log.ply")
        self.refused("calib.txt", "Tr", "camera")

    def test_mac_appledouble(self):
        self.run_case("import", "drive", "-o", "OUT/log.ply")
        raw = [floats(self.folder / f"drive/velodyne/{k:06}.bin", 4) for k in range(2)]
        self.same_points(points(self.rows()), raw[0] + [(x + 5, y, z) for x, y, z in raw[1]])

    def test_national_grid(self):
        self.run_case("import", "rd.pcd", "-o", "OUT/log.ply")
        self.refused("coordinates those of the world", "--points-in-world")

    def test_normals_as_rays(self):
        self.run_case("import", "map.ply", "-o", "OUT/log.ply")
        self.refused("normals", "--format scan")

    def test_nuscenes_bin5(self):
        self.run_case("import", "sweep.pcd.bin", "-o", "OUT/log.ply")
        rows = self.rows("5 columns")
        self.same_points(points(rows), floats(self.folder / "sweep.pcd.bin", 5))
        self.assertGreater(len({row["ring"] for row in rows}), 1)

    def test_obj_bom(self):
        self.run_case("simulate", "bom2.obj", "--like", "like.ply", "-o", "OUT/log.ply")
        self.rows("242 hits")

    def test_obj_concave(self):
        self.run_case("simulate", "concave.obj", "--like", "like.ply", "-o", "OUT/log.ply")
        self.rows("52 hits")

    def drive(self, name, unit_s, *said):
        """Checks that each point of a drive at (6, 0.5, 0) m/s stands where the sensor saw it at the point's time."""
        self.run_case("import", "drive", "--deskew", "velodyne-vlp16", "-o", "OUT/log.ply")
        starts = [float(t) for t in (self.folder / "drive/times.txt").read_text().split()]
        right = []
        for k, start in enumerate(starts):
            for row in rows_of(self.folder / f"drive/{k:06}.pcd"):
                after = start - 1581624663 + row[name] * unit_s
                right.append((row["x"] + 6 * after, row["y"] + 0.5 * after, row["z"] + 1.8))
        self.same_points(points(self.rows(*said)), right, 0.01)

    def test_time_0_to_1(self):
        self.drive("t", 0.1, "share")

    def test_time_ms(self):
        self.drive("time", 1e-3, "ms")

    def test_time_offset_time(self):
        self.drive("offset_time", 1e-9)

    def test_times_of_another_name(self):
        """A column of times whose name is not known is named."""
        with tempfile.TemporaryDirectory() as folder:
            for file in (HERE / "time_ms/drive").iterdir():
                pathlib.Path(folder, file.name).write_bytes(file.read_bytes().replace(b" time", b" curv", 1))
            self.run_case("import", folder, "--deskew", "velodyne-vlp16", "-o", "OUT/log.ply")
            self.rows("the points have no times (not known as times: curv)")

    def test_units_mm(self):
        self.run_case("import", "mm_i2.pcd", "-o", "OUT/log.ply")
        self.rows("underbrush: warning", "--unit mm")
        self.run_case("import", "mm_i2.pcd", "--unit", "mm", "-o", "OUT/log.ply")
        raw = points(rows_of(self.folder / "mm_i2.pcd"))
        self.same_points(points(self.rows()), [(x / 1e3, y / 1e3, z / 1e3) for x, y, z in raw], 1e-4)

    def test_veloview_csv(self):
        self.run_case("import", "frame.csv", "-o", "OUT/log.ply")
        lines = (self.folder / "frame.csv").read_text().splitlines()[1:]
        rows = self.rows()
        self.same_points(points(rows), [tuple(map(float, line.split(",")[:3])) for line in lines])
        self.assertEqual({row["ring"] for row in rows}, {3})

    def test_xyz_plain(self):
        self.run_case("import", "plot.xyz", "-o", "OUT/log.ply")
        lines = (self.folder / "plot.xyz").read_text().splitlines()
        self.same_points(points(self.rows("x y z")), [tuple(map(float, line.split()))[:3] for line in lines])


class Limits(Cases):
    """Values in a wrong unit are refused in one line, before they cost time or memory."""

    def test_wrong_units(self):
        like = "obj_bom/like.ply"
        for verb, option, value in (
                ("fit", "--range-noise", "20"), ("fit", "--tile", "0.1"), ("fit", "--surface-cell", "0.0003"),
                ("fit", "--ground-spacing", "0.001"), ("fit", "--tau", "1000"), ("fit", "--mixture-rounds", "100000"),
                ("segment", "--tile", "0.1"), ("segment", "--tree-height", "5000"), ("import", "--max-range", "1e9"),
                ("movers", "--cell-deg", "0.001")):
            with self.subTest(verb=verb, option=option):
                self.run_case(verb, like, option, value, "-o", "OUT/log.ply")
                self.refused(option, code=2)

    def test_names_of_other_formats(self):
        """A log is not written under the name of another format, which a reader of the name would believe."""
        like = "obj_bom/like.ply"
        for words in (("import", like), ("movers", like), ("segment", like)):
            for name in ("x.las", "x.LAZ", "x.mcap", "x.npz", "x.pcd", "x.csv"):
                with self.subTest(words=words, name=name):
                    self.run_case(*words, "-o", f"OUT/{name}")
                    self.refused("logs are written as .ply", code=2)
                    self.assertFalse((self.out / name).exists())
        for words, said in ((("perceive", like, "--pipeline", "real"), "lists of objects are written as"),
                            (("osi", "replay", "views.osi"), "lists of objects are written as"),
                            (("osi", "record", like), "traces are written as .osi")):
            for name in ("x.mcap", "x.ply", "x.JSON", "x.txt"):
                with self.subTest(words=words, name=name):
                    self.run_case(*words, "-o", f"OUT/{name}")
                    self.refused(said, code=2)
                    self.assertFalse((self.out / name).exists())
        self.run_case("split", like, "--every", "2", "--train", "OUT/a.ply", "--test", "OUT/b.pcd")
        self.refused("b.pcd", code=2)
        self.assertEqual(list(self.out.iterdir()), [])

    def test_an_object_of_many_members(self):
        """Finding a member takes time with their number, which is therefore limited."""
        for count, said in ((400_000, "more than 10000 members"), (9_000, "has no member")):
            with self.subTest(count=count), tempfile.TemporaryDirectory() as model:
                members = ",".join(f'"k{k}": [{{"a": 1}}]' for k in range(count))
                pathlib.Path(model, "model.json").write_text("{" + members + "}", encoding="utf-8")
                self.run_case("info", model)
                self.refused(said)

    def test_what_is_meant(self):
        """A verb, option or sensor that is misspelt, and a model in place of a log, are named with what to do."""
        like = "obj_bom/like.ply"
        for words, code, said in (
                (("fti", like), 2, "did you mean 'fit'?"), (("fit", like, "--fiter", "x"), 2, "did you mean --fitter?"),
                (("import", "time_ms/drive", "--deskew", "VLP16"), 2, "did you mean 'velodyne-vlp16'?"),
                (("fit", "units_mm/mm_i2.pcd"), 3, "underbrush import mm_i2.pcd"),
                (("fit", "obj_concave/concave.obj"), 3, "is a mesh"), (("simulate", like, "--like", like), 3, "underbrush fit LOG")):
            with self.subTest(words=words):
                self.run_case(*words, "-o", "OUT/log.ply")
                self.refused(said, code=code)
        for words, said in ((("fit", like, "--fiter", "surface"), "did you mean --fitter?"), (("fit", like), "--output is required"),
                            (("fit", like, "--outptu", "x"), "did you mean --output?"), (("--versoin",), "did you mean --version?")):
            with self.subTest(words=words):
                self.run_case(*words)
                self.refused(said, code=2)


class Python(Cases):
    def test_bag_pose_covariance(self):
        self.run_case("import", "bag_pc", "-o", "OUT/log.ply")
        self.assertEqual(len(self.rows()), 978)

    def test_bag_raw_packets(self):
        self.run_case("import", "bag_raw", "-o", "OUT/log.ply")
        self.refused("packets")

    def test_bag_ring_f32(self):
        self.run_case("import", "bag_ringf32", "-o", "OUT/log.ply")
        self.assertEqual({row["ring"] for row in self.rows()}, set(range(13)))

    def test_bag_stamp_0(self):
        self.run_case("import", "bag_stamp0", "-o", "OUT/log.ply")
        self.refused("beams outside the times of the poses", "--clock bag")

    def test_bag_time_us(self):
        self.run_case("import", "bag_u32us", "-o", "OUT/log.ply")
        times = [row["time"] for row in self.rows("µs")]
        self.assertAlmostEqual(max(times) - min(times), 0.1975, places=3)

    def test_common_options(self):
        self.run_case("import", "scan.las", "--position", "532100,5412300,311.8", "--threads", "2", "-o", "OUT/log.ply")
        self.assertEqual(len(self.rows()), 734)

    def test_las_sorted_returns(self):
        self.run_case("import", "t0_sorted.las", "--position", "532100.000,5412300.000,311.800", "-o", "OUT/log.ply")
        self.assertNotIn("the file lacks", self.said)
        self.assertIn("gps_time", self.said)

    def test_las_zero(self):
        self.run_case("import", "zero.las", "--position", "0,0,0", "-o", "OUT/log.ply")
        self.refused("no points in it")

    def test_mcap_crashed(self):
        self.run_case("import", "crashed.mcap", "-o", "OUT/log.ply")
        self.assertGreater(len(self.rows("was not closed", "8 whole messages")), 100)
        with tempfile.TemporaryDirectory() as folder:
            cut = pathlib.Path(folder, "cut.mcap")
            cut.write_bytes((self.folder / "crashed.mcap").read_bytes()[:12000])
            self.run_case("import", str(cut), "-o", "OUT/log.ply")
            self.refused("no topic with point clouds", "the recording was not closed")

    def test_overwrites(self):
        notes = HERE / "overwrites/notes.txt"
        with tempfile.TemporaryDirectory() as folder:
            own = pathlib.Path(folder, "notes.txt")
            own.write_bytes(notes.read_bytes())
            self.run_case("import", "scan.las", "--position", "532100,5412300,311.8", "-o", str(own))
            self.refused("notes.txt", "--force", code=4)
            self.assertEqual(own.read_bytes(), notes.read_bytes())
            self.run_case("import", "scan.las", "--position", "532100,5412300,311.8", "-o", str(own), "--force")
            self.assertEqual((self.done.returncode, own.read_bytes()[:3]), (0, b"ply"), self.said)

    def test_pcap_two_sensors(self):
        self.run_case("import", "pc_two.pcap", "--position", "0,0,1.8", "-o", "OUT/log.ply")
        self.refused("--topic 192.168.1.201:2368", "--topic 192.168.1.202:2368")


def front_of(build):
    """The command of the package in the tests' environment; None where pip cannot make that."""
    spec = importlib.util.spec_from_file_location("environment", HERE.parents[1] / "python/tests/environment.py")
    environment = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(environment)
    try:
        python = environment.of_tests(build)
    except environment.Missing as missing:
        print(missing)
        sys.exit(77)
    ENVIRONMENT["PYTHONPATH"] = str(build / "python/package")
    return [str(python), "-m", "underbrush.cli"]


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path)
    given, words = parser.parse_known_args()
    FRONT = [str(given.program.resolve())] if given.program else front_of(given.build.resolve())
    unittest.main(argv=[sys.argv[0], *(words or (["Program", "Limits"] if given.program else ["Python"]))])
