#!/usr/bin/env python3
"""Tests of `underbrush serve`: what it answers about files, and how it ends."""
import json
import os
import pathlib
import signal
import socket
import struct
import tempfile

import cli_test
import serving

class Serve(serving.Serving):
    def test_lists_what_was_named(self):
        files = self.server.json_of("api/files")["files"]
        self.assertEqual([f["kind"] for f in files], ["log", "model", "primitives", "scene", "score"])
        self.assertEqual([f["name"] for f in files], ["log.ply", "model", "primitives", "scene", "score.json"])
        self.assertEqual(self.server.get("")[0], 200)
        self.assertIn("default-src 'none'", self.server.get("")[1]["Content-Security-Policy"])

    def test_an_octree_is_read_by_ranges(self):
        state = self.server.octree(0)
        self.assertEqual(state["state"], "ready")
        header = self.server.get("api/octree/data?file=0", headers={"Range": "bytes=0-63"})
        self.assertEqual((header[0], len(header[2])), (206, 64))
        self.assertEqual(header[1]["Content-Range"], f"bytes 0-63/{state['bytes']}")
        magic, version, nodes, points = struct.unpack_from("<8sIIQ", header[2])
        self.assertEqual((magic, version, nodes), (b"UBOCTREE", 1, state["nodes"]))
        info = json.loads(cli_test.call("info", "log.ply", "--json", "-", cwd=self.folder).stdout)
        self.assertEqual(points, info["hits"])
        table = self.server.get("api/octree/data?file=0",
                                headers={"Range": f"bytes={state['nodes_at']}-{state['nodes_at'] + 24 * nodes - 1}"})
        self.assertEqual(sum(struct.unpack_from("<QI", table[2], 24 * k)[1] for k in range(nodes)), points)
        for bad in ("bytes=5-1", "bytes=-5", "bytes=0-1,3-4", "bytes=a-b", "lines=1-2", "bytes=9999999999-"):
            self.assertIn(self.server.get("api/octree/data?file=0", headers={"Range": bad})[0], (400, 416), bad)
        self.assertEqual(self.server.get("api/octree/data?file=0")[0], 400)

    def test_a_sample_is_there_before_the_octree(self):
        status, _, body = self.server.get("api/preview?file=0")
        points, zero = struct.unpack_from("<II", body)
        octree = self.server.octree(0)["octree"]
        self.assertEqual((status, zero, len(body)), (200, 0, 32 + 29 * points))
        self.assertEqual(points, octree["points"])  # a short log is its own sample
        self.assertEqual(list(struct.unpack_from("<3d", body, 8)), octree["origin_m"])
        columns = 32 + 12 * points
        rows = struct.unpack_from(f"<{points}I", body, columns + 8 * points)
        rings = struct.unpack_from(f"<{points}H", body, columns + 12 * points)
        for k in (0, points // 2, points - 1):
            beam = self.server.json_of(f"api/beam?file=0&row={rows[k]}")
            place = struct.unpack_from("<3f", body, 32 + 12 * k)
            for at, origin, end in zip(place, octree["origin_m"], beam["end_m"]):
                self.assertAlmostEqual(at + origin, end, delta=1e-4)
            self.assertEqual(rings[k], beam["ring"])
        self.assertEqual(self.server.get("api/preview?file=1")[0], 400)

    def test_beams_of_a_scan_and_of_a_row(self):
        self.server.octree(0)
        body = self.server.get("api/beams?file=0&run=0")[2]
        count, step = struct.unpack_from("<II", body)
        self.assertEqual((len(body), step), (8 + 32 * count, 1))
        for k in (0, count // 2, count - 1):
            *points, row, hit = struct.unpack_from("<6f2I", body, 8 + 32 * k)
            beam = self.server.json_of(f"api/beam?file=0&row={row}")
            self.assertEqual((beam["hit"], beam["row"]), (hit == 1, row))
            self.assertLess(max(abs(p) for p in points), 1e3)
        self.assertEqual(self.server.get("api/beam?file=0&row=99999999")[0], 400)
        self.assertEqual(self.server.get("api/beams?file=0&run=100000")[0], 400)

    def test_a_trace_ends_where_the_simulation_does(self):
        """The law of the trace: its range is the one that `simulate` writes for the beam."""
        for file, world in ((1, "model"), (3, "scene")):
            cli_test.call("simulate", world, "--like", "log.ply", "-o", "sim.ply", "--seed", "5", cwd=self.folder)
            with Simulated(self.folder) as simulated:
                self.assertGreater(self.compare(simulated, file), 20)

    def compare(self, simulated, world):
        self.server.octree(0)
        ended = 0
        for row in range(3, 800, 11):
            trace = self.server.json_of(f"api/trace?file=0&row={row}&world={world}&seed=5")
            ranges = [m["range_m"] for m in trace["met"]]
            self.assertEqual(ranges, sorted(ranges))
            first = next((k for k, m in enumerate(trace["met"]) if m["accepts"]), None)
            self.assertEqual(trace["ends_at"], first)
            beam = simulated.json_of(f"api/beam?file=0&row={row}")
            if trace["simulated_range_m"] is None:
                self.assertFalse(beam["hit"])
            else:
                self.assertAlmostEqual(beam["range_m"], trace["simulated_range_m"], delta=1e-5)
                ended += 1
        return ended

    def test_worlds(self):
        for file, kind in ((1, "model"), (2, "primitives"), (3, "scene")):
            world = self.server.json_of(f"api/world?file={file}")
            self.assertEqual(world["kind"], kind)
            for k, model in enumerate(world["models"][:5]):
                body = self.server.get(f"api/ellipsoids?file={file}&model={k}")[2]
                self.assertEqual(len(body), 52 * model["ellipsoids"])
                for part in ("ground", "surface"):
                    mesh = self.server.get(f"api/{part}?file={file}&model={k}")[2]
                    vertices, triangles = struct.unpack_from("<II", mesh)
                    self.assertEqual(triangles, model[f"{part}_triangles"])
                    self.assertEqual(len(mesh), 8 + 12 * vertices + 24 * triangles)
            self.assertEqual(self.server.get(f"api/ellipsoids?file={file}&model=100000")[0], 400)
        score = json.loads(pathlib.Path(self.folder, "score.json").read_text())
        self.assertEqual(self.server.json_of("api/score?file=4"), score)

    def test_primitives_stand_apart_from_each_other(self):
        world = self.server.json_of("api/world?file=2")
        boxes = []
        for instance in world["instances"]:
            box = world["models"][instance["model"]]["box_m"]
            boxes.append([[at + box[end][k] for k, at in enumerate(instance["at_m"][:2])] for end in ("min", "max")])
        for k, (low, high) in enumerate(boxes):
            for other_low, other_high in boxes[:k]:
                gaps = [max(other_low[c] - high[c], low[c] - other_high[c]) for c in (0, 1)]
                self.assertGreaterEqual(max(gaps), 1 - 1e-6)

    def test_a_question_that_does_not_fit(self):
        for path in ("api/score?file=0", "api/world?file=0", "api/octree?file=1", "api/world?file=-1",
                     "api/world?file=99", "api/world", "api/world?file=1x", "api/trace?file=0&row=1&world=0"):
            with self.subTest(path):
                status, _, body = self.server.get(path)
                self.assertEqual(status, 400)
                self.assertTrue(json.loads(body)["error"])
        self.assertEqual(self.server.get("api/nothing")[0], 404)


class Simulated:
    """A server of its own for the log sim.ply."""
    def __init__(self, folder):
        self.server = serving.Server(folder, "sim.ply")

    def __enter__(self):
        self.server.octree(0)
        return self.server

    def __exit__(self, *_):
        self.server.end()


class ServeEnds(serving.Serving):
    def test_on_ctrl_c(self):
        with tempfile.TemporaryDirectory() as cache:
            server = serving.Server(self.folder, "log.ply", cache=cache)
            held = socket.create_connection(("127.0.0.1", server.port))
            server.octree(0)
            code, _, errors = server.end()
            held.close()
            self.assertEqual((code, errors), (-signal.SIGINT, "underbrush: interrupted\n"))
            self.assertEqual([p.suffix for p in pathlib.Path(cache).iterdir()], [".octree"])
            with self.assertRaises(OSError):
                socket.create_connection(("127.0.0.1", server.port), timeout=1)

    def test_in_the_middle_of_a_build(self):
        with tempfile.TemporaryDirectory() as cache:
            server = serving.Server(self.folder, "log.ply", cache=cache)
            server.json_of("api/octree?file=0")
            code, _, _ = server.end()
            self.assertEqual(code, -signal.SIGINT)
            self.assertTrue(all(p.suffix == ".octree" for p in pathlib.Path(cache).iterdir()), os.listdir(cache))

    def test_an_octree_is_built_when_it_is_asked_for(self):
        with tempfile.TemporaryDirectory() as cache:
            server = serving.Server(self.folder, "log.ply", cache=cache)
            self.assertEqual(server.json_of("api/octree?file=0&build=0"), {"state": "absent"})
            self.assertEqual(os.listdir(cache), [])
            self.assertEqual(server.octree(0)["state"], "ready")
            server.end()
            server = serving.Server(self.folder, "log.ply", cache=cache)
            self.assertNotEqual(server.json_of("api/octree?file=0&build=0")["state"], "absent")
            server.end()

    def test_what_cannot_be_served(self):
        empty = pathlib.Path(self.folder, "empty")
        empty.mkdir(exist_ok=True)
        pathlib.Path(self.folder, "note.json").write_text("{}")
        for path, word in (("empty", "no log"), ("nowhere.ply", "nowhere.ply"), ("note.json", "scores")):
            done = cli_test.call("serve", path, "--cache", "cache", cwd=self.folder)
            self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
            self.assertIn(word, done.stderr)
        done = cli_test.call("serve", "log.ply", "--port", str(self.server.port), cwd=self.folder)
        self.assertEqual(done.returncode, 4, done.stderr)


if __name__ == "__main__":
    cli_test.main()
