#!/usr/bin/env python3
"""Tests of what `underbrush serve` tells of beams: traces, waveforms, range images, the sensor's path and errors."""
import csv
import json
import math
import pathlib
import struct

import cli_test
import serving


class ServeBeams(serving.Serving):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.server.end()
        like = ("--like", "log.ply", "--seed", "5")
        instrument = ("--super-sample", "sensor", "--sensor", "velodyne-vlp16", "--waveform-count", "1000000")
        for words in (("scene", *like, "-o", "sim.ply"),
                      ("scene", *like, "-o", "echoes.ply", *instrument, "--waveforms", "scene.csv"),
                      ("model", *like, "-o", "other.ply", *instrument, "--waveforms", "model.csv")):
            done = cli_test.call("simulate", *words, cwd=cls.folder)
            assert done.returncode == 0, done.stderr
        cls.server = serving.Server(cls.folder, "log.ply", "model", "scene", "sim.ply", "echoes.ply")
        for log in (0, 3, 4):
            cls.server.octree(log)

    def image(self, words):
        """Returns (width, height, rows, measured, other) of a range image; `other` is None where there is none."""
        status, _, body = self.server.get(f"api/range_image?file=0&run=0{words}")
        self.assertEqual(status, 200, body)
        width, height, both = struct.unpack_from("<III", body)
        self.assertEqual(len(body), 12 + 12 * width * height)
        pixels = list(struct.iter_unpack("<Iff", body[12:]))
        rows, measured, other = (list(column) for column in zip(*pixels))
        return width, height, rows, measured, other if both else None

    def beam(self, row, file=0):
        return self.server.json_of(f"api/beam?file={file}&row={row}")

    def test_a_range_image_shows_each_beam(self):
        width, height, rows, measured, other = self.image("")
        self.assertIsNone(other)
        there = [k for k, row in enumerate(rows) if row < 2**32 - 1]
        self.assertEqual(len({rows[k] for k in there}), len(there))  # a beam has one pixel
        elevation = []
        for y in range(height):
            line = [k for k in there if k // width == y][::7]
            beams = [self.beam(rows[k]) for k in line[:3]]
            self.assertEqual(len({beam["ring"] for beam in beams}), 1)
            elevation.append(sum(beam["direction"][2] for beam in beams) / len(beams))
            for k, beam in zip(line, beams):
                self.assertAlmostEqual(measured[k], beam["range_m"] or 0, delta=1e-5)
        self.assertEqual(elevation, sorted(elevation, reverse=True))
        # The azimuth falls to the right.
        line = [self.beam(rows[k])["direction"] for k in there if k // width == 0][:12:3]
        turns = [math.remainder(math.atan2(b[1], b[0]) - math.atan2(a[1], a[0]), 2 * math.pi)
                 for a, b in zip(line, line[1:])]
        self.assertLess(max(turns), 0)

    def test_a_simulated_image_is_what_the_command_writes(self):
        """The law of the image: its ranges are those of `simulate --like`, beam by beam, however they are asked for."""
        _, _, rows, measured, simulated = self.image("&world=2&seed=5")
        _, _, same, again, written = self.image("&other=3")
        self.assertEqual((rows, measured), (same, again))
        self.assertGreater(sum(r > 0 for r in simulated), 100)
        self.assertLess(max(abs(a - b) for a, b in zip(simulated, written)), 1e-5)
        _, _, _, _, echoes = self.image("&other=4")  # a log of several echoes a beam: the first ones count
        self.assertGreater(sum(abs(a - b) < 0.5 for a, b in zip(simulated, echoes)), 0.5 * len(echoes))

    def test_the_waveform_of_a_beam_is_what_the_command_writes(self):
        """The law of the waveform: it is that of `simulate --super-sample sensor`."""
        for world, name in ((1, "model"), (2, "scene")):
            ranges = self.compare_waveforms(world, f"{name}.csv")
            self.assertGreater(sum(len(r) > 0 for r in ranges.values()), 3)
        for row in range(0, 800, 7):  # the log of the echoes has the same
            written = self.beam(row, file=4)
            if written["beam"] in ranges:
                for a, b in zip(ranges[written["beam"]], written["echoes_m"], strict=True):
                    self.assertAlmostEqual(a, b, delta=1e-5)

    def compare_waveforms(self, world, file):
        """Compares some beams with a table of `--waveforms`; returns their echoes by the number of the beam."""
        wanted, ranges = {}, {}
        with open(pathlib.Path(self.folder, file), encoding="utf-8") as table:
            for line in csv.DictReader(table):
                wanted.setdefault(int(line["beam"]), []).append((float(line["range_m"]), float(line["signal"])))
        for row in range(0, 800, 41):
            beam = self.beam(row)["beam"]
            told = self.server.json_of(f"api/echoes?file=0&row={row}&world={world}&seed=5&sensor=velodyne-vlp16")
            self.assertEqual(told["sensor"], "velodyne-vlp16")
            signal = list(zip(told["range_m"], told["signal"]))
            self.assertEqual(len(signal), len(wanted.get(beam, [])))
            for (r, s), (r2, s2) in zip(signal, wanted.get(beam, [])):
                self.assertAlmostEqual(r, r2, delta=1e-3)
                self.assertAlmostEqual(s, s2, delta=1e-3 * max(1, abs(s2)))
            ranges[beam] = [echo["range_m"] for echo in told["echoes"]]
        return ranges

    def test_only_sensors_of_the_catalogue(self):
        self.assertIn("velodyne-vlp16", self.server.json_of("api/files")["sensors"])
        pathlib.Path(self.folder, "own.yaml").write_text("title: own\n")
        for name in ("own.yaml", "/etc/passwd", "../own.yaml", "velodyne"):
            status, _, body = self.server.get(f"api/echoes?file=0&row=1&world=2&sensor={name}")
            self.assertEqual((status, json.loads(body)["error"]), (400, "the catalogue has no such sensor"))

    def test_the_path_of_the_sensor(self):
        origin = self.server.json_of("api/octree?file=0")["octree"]["origin_m"]
        body = self.server.get("api/trajectory?file=0")[2]
        count, = struct.unpack_from("<I", body)
        places = list(struct.iter_unpack("<4f", body[4:]))
        self.assertEqual(len(places), count)
        rows = self.server.json_of("api/octree?file=0")["octree"]["rows"]
        step = -(-rows // 4000)
        self.assertEqual(count, -(-rows // step))
        for k in (0, count // 3, count - 1):
            beam = self.beam(k * step)
            for axis in range(3):
                self.assertAlmostEqual(places[k][1 + axis] + origin[axis], beam["origin_m"][axis], delta=1e-3)

    def test_errors_of_ranges_and_packets(self):
        """The law of the packet error: its mean over the packets is what `score` calls packet_error_m."""
        state = self.server.octree(0)
        table = self.server.get("api/octree/data?file=0", headers={
            "Range": f"bytes={state['nodes_at']}-{state['nodes_at'] + 24 * state['nodes'] - 1}"})[2]
        packets, errors = {}, 0
        for k in range(state["nodes"]):
            at, points = struct.unpack_from("<QI", table, 24 * k)
            if points == 0:
                continue
            rows = struct.unpack(f"<{points}I", self.server.get("api/octree/data?file=0", headers={
                "Range": f"bytes={at + 20 * points}-{at + 24 * points - 1}"})[2])
            pairs = list(struct.iter_unpack("<2f", self.server.get(f"api/errors?file=0&other=3&nodes={k}")[2]))
            self.assertEqual(len(pairs), points)
            for row, (error, packet) in zip(rows, pairs):
                if packet < 1e8:
                    packets.setdefault(packet, row)
                errors += error < 1e8
        score = json.loads(cli_test.call("score", "log.ply", "sim.ply", "--json", "-", cwd=self.folder).stdout)
        summary = next(iter(score["models"].values()))
        self.assertEqual(errors, summary["true_hits"])
        self.assertAlmostEqual(sum(packets) / len(packets), summary["packet_error_m"], delta=1e-4)

    def test_questions_that_do_not_fit(self):
        for path in ("api/range_image?file=0&run=99999", "api/range_image?file=1&run=0", "api/range_image?file=0",
                     "api/range_image?file=0&run=0&other=1", "api/range_image?file=0&run=0&world=0",
                     "api/echoes?file=0&row=1&world=0", "api/echoes?file=0&row=99999999&world=2", "api/trajectory?file=1"):
            with self.subTest(path):
                self.assertEqual(self.server.get(path)[0], 400)


if __name__ == "__main__":
    cli_test.main()
