#!/usr/bin/env python3
"""One answer: the program, the library and the server give the same bits for the same request, on a log that has every
feature at once (every_feature.py), and the tracer of the FMU the same ranges for the rays that OSI knows.
python/tests/test_one_answer.py does the same with Python.

  one_answer_test.py --program build/bin/underbrush --library build/tests/answer_of_library --tracer
    build/tests/answer_of_tracer
"""
import argparse
import json
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
import cli_test  # noqa: E402
import every_feature  # noqa: E402
import serving  # noqa: E402

LIBRARY = TRACER = None
NO_BEAM = 0xffffffff


def program(*words, cwd=None):
    done = cli_test.call(*words, cwd=cwd)
    if done.returncode:
        raise AssertionError(done.stderr)
    return done.stdout


def ranges_of(file):
    """The ranges of the rows of a log; 0 for a miss."""
    rows = every_feature.Rows(file)
    return [sum(r[rows.at["n" + a]] ** 2 for a in "xyz") ** 0.5 if r[rows.at["alpha"]] else 0.0 for r in rows.rows]


def library_ranges(folder, model, log):
    """The ranges of the library's answer to a log, to the bit; 0 for a miss. The files of logs have rounded vectors."""
    subprocess.run([LIBRARY, "simulate", model, log, "library.ply", "5", ""], cwd=folder, check=True)
    return [r if math.isfinite(r) else 0.0
            for (r,) in struct.iter_unpack("<f", (folder / "library.ply.ranges").read_bytes())]


def body(file):
    """A PLY file without the comments, of which one has its provenance."""
    head, end, rows = pathlib.Path(file).read_bytes().partition(b"end_header\n")
    return re.sub(rb"^comment .*\n", b"", head, flags=re.MULTILINE) + end + rows


class OneAnswer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        every_feature.make(program, cls.folder)
        cls.report = json.loads(program("simulate", "model", "--like", "test.ply", "-o", "sim.ply", "--seed", 5,
                                        "--json", "-", cwd=cls.folder))
        cls.server = serving.Server(cls.folder, "test.ply", "model", words=["--seed", "5"])
        cls.server.octree(0)

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        cls.temporary.cleanup()

    def test_the_log_has_every_feature(self):
        model = json.loads((self.folder / "model/model.json").read_text())
        self.assertEqual(model["sensor"], "coarse")
        self.assertEqual(len(model["channels"]), 16)
        self.assertGreater(len(model["keyframes"]["frames"]), 1)
        self.assertIn("light", model)
        self.assertIn("observed_space", model)
        self.assertGreater(len(model["grain_m"]["classes"]), 3)
        self.assertTrue(self.report["keyframes"])
        self.assertEqual(self.report["channel_offsets"], 16)
        self.assertGreater(self.report["misses"], 1000)
        without = json.loads(program("simulate", "model", "--like", "test.ply", "--element-ids", "--seed", 5, "-o",
                                     "no_keyframes.ply", "--json", "-", cwd=self.folder))
        self.assertFalse(without["keyframes"])
        differ = sum(a != b for a, b in zip(ranges_of(self.folder / "sim.ply"),
                                            ranges_of(self.folder / "no_keyframes.ply")))
        self.assertGreater(differ, 500)

    def test_the_library_answers_as_the_program(self):
        for words, options in ((["--seed", 5], ["5", ""]), (["--draw", "median"], ["1", "median"])):
            program("simulate", "model", "--like", "test.ply", "-o", "program.ply", *words, "--force", cwd=self.folder)
            subprocess.run([LIBRARY, "simulate", "model", "test.ply", "library.ply", *options], cwd=self.folder, check=True)
            self.assertEqual(body(self.folder / "program.ply"), body(self.folder / "library.ply"), words)

    def test_the_library_fits_as_the_program(self):
        program("fit", "train.ply", "-o", "program_fit", cwd=self.folder)
        subprocess.run([LIBRARY, "fit", "train.ply", "library_fit"], cwd=self.folder, check=True)
        files = sorted(f.name for f in (self.folder / "program_fit").iterdir() if f.is_file())
        self.assertIn("keyframes.ply", files)
        self.assertIn("observed_space.ply", files)
        for name in files:
            of_program, of_library = ((self.folder / f"{who}_fit" / name) for who in ("program", "library"))
            if name == "model.json":
                models = [json.loads(file.read_text()) for file in (of_program, of_library)]
                for model in models:
                    model.pop("provenance", None)
                self.assertEqual(*models)
            else:
                self.assertEqual(body(of_program), body(of_library), name)

    def test_the_library_scores_as_the_program(self):
        of_program = json.loads(program("score", "test.ply", "sim.ply", "--model", "model", "--json", "-",
                                        cwd=self.folder))["models"]["sim"]
        done = subprocess.run([LIBRARY, "score", "test.ply", "sim.ply", "model"], cwd=self.folder, check=True,
                              capture_output=True, text=True)
        self.assertEqual(json.loads(done.stdout)["models"]["library"], of_program)
        self.assertGreater(of_program["beams"], 1000)
        self.assertLess(of_program["nll_per_beam"], 5)

    def test_the_range_images_of_the_server_are_those_of_the_program(self):
        ranges = library_ranges(self.folder, "model", "test.ply")
        self.assertGreater(self.compared_images(self.server, 0, 1, "sim.ply", ranges), 0.5 * len(ranges))

    def compared_images(self, server, log, world, simulated, ranges):
        """Compares the range images of a log with the ranges of a simulated one; returns the number of beams."""
        rows = every_feature.Rows(self.folder / simulated)
        compared = 0
        for run in range(1 + max(rows.column("scan")) // 2):
            status, _, image = server.get(f"api/range_image?file={log}&run={run}&world={world}&seed=5")
            self.assertEqual(status, 200)
            width, height, both = struct.unpack_from("<3I", image)
            self.assertTrue(both)
            for row, _, answer in struct.iter_unpack("<I2f", image[12:]):
                if row == NO_BEAM:
                    continue
                self.assertEqual(answer, ranges[row])
                compared += 1
            self.assertEqual(len(image), 12 + 12 * width * height)
        return compared

    def test_logs_without_a_name_are_told_apart_by_their_channels(self):
        every_feature.make_unnamed(self.folder)
        server = serving.Server(self.folder, "unnamed.ply", "renumbered.ply", "unnamed", words=["--seed", "5"])
        self.addCleanup(server.end)
        for file, (log, serves) in enumerate((("unnamed", True), ("renumbered", False))):
            report = json.loads(program("simulate", "unnamed", "--like", f"{log}.ply", "--seed", 5, "-o",
                                        f"{log}_sim.ply", "--json", "-", cwd=self.folder))
            self.assertEqual(report["keyframes"], serves)
            ranges = library_ranges(self.folder, "unnamed", f"{log}.ply")
            self.assertEqual(body(self.folder / f"{log}_sim.ply"), body(self.folder / "library.ply"))
            server.octree(file)
            self.assertGreater(self.compared_images(server, file, 2, f"{log}_sim.ply", ranges), 1000)
            ends = [server.json_of(f"api/trace?file={file}&row={row}&world=2&seed=5")["ends_by"]
                    for row in range(7, len(ranges), len(ranges) // 100)]
            self.assertEqual("keyframe" in ends, serves)

    def test_the_server_explains_the_answer_of_the_program(self):
        ranges = library_ranges(self.folder, "model", "test.ply")
        ends = {"element": 0, "keyframe": 0, "unknown space": 0, "miss": 0}
        for row in range(7, len(ranges), len(ranges) // 800):
            trace = self.server.json_of(f"api/trace?file=0&row={row}&world=1&seed=5")
            self.assertEqual(trace["simulated_range_m"] or 0.0, ranges[row], trace)
            ends[trace["ends_by"]] += 1
            self.assertEqual(trace["ends_at"] is not None, trace["ends_by"] == "element")
        self.assertGreater(ends.pop("unknown space"), 3)
        self.assertGreater(min(ends.values()), 20, ends)

    def test_the_tracer_of_the_fmu_answers_rays_as_simulate_without_keyframes_offsets_and_light(self):
        """OSI's rays have no sensor with a name, so `simulate` uses neither keyframes nor offsets for them."""
        def answers(model):
            done = subprocess.run([TRACER, model, "coarse.yaml", "test.ply", "5"], cwd=self.folder, check=True,
                                  capture_output=True, text=True)
            return json.loads(done.stdout)
        shutil.copytree(self.folder / "model", self.folder / "noiseless")
        manifest = self.folder / "noiseless/model.json"
        model = json.loads(manifest.read_text())
        noise_m = model["range_noise_m"]
        manifest.write_text(json.dumps({**model, "range_noise_m": 0}))
        exact = answers("noiseless")
        self.assertGreater(exact["rays"], 50000)
        self.assertTrue(0.5 * exact["rays"] < exact["returns"] < 0.9 * exact["rays"], exact)
        self.assertEqual(exact["other"], 0, exact)
        # The noise of the sensor has other random numbers: the differences are those of two draws.
        noisy = answers("model")
        self.assertEqual((noisy["returns"], noisy["both"]), (exact["returns"], exact["returns"]))
        self.assertGreater(noisy["other"], 0.9 * noisy["returns"])
        self.assertLess(abs(noisy["rms_m"] / (math.sqrt(2) * noise_m) - 1), 0.05)
        self.assertLess(noisy["farthest_m"], 6 * math.sqrt(2) * noise_m)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--library", required=True)
    parser.add_argument("--tracer", required=True)
    arguments, rest = parser.parse_known_args()
    cli_test.PROGRAM, LIBRARY, TRACER = (str(pathlib.Path(p).resolve())
                                         for p in (arguments.program, arguments.library, arguments.tracer))
    unittest.main(argv=[sys.argv[0], *rest])
