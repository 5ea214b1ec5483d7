#!/usr/bin/env python3
"""Tests of `underbrush serve`: what it answers, and what it refuses. Nothing that it was not started for is read, no
request without the token is answered, and neither odd requests nor slow or large ones cost more than a moment."""
import http.client
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import unittest
import urllib.parse

import cli_test


class Server:
    """A running server; `address` is split into its port and its token."""
    def __init__(self, folder, *paths, cache="cache", words=()):
        self.json = pathlib.Path(folder, "serve.json")
        self.json.unlink(missing_ok=True)
        self.process = subprocess.Popen(
            [cli_test.PROGRAM, "serve", *paths, "--cache", cache, "--json", str(self.json), *words], cwd=folder, text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.lines = [self.process.stdout.readline()]
        while self.lines[-1] and not self.lines[-1].startswith("open "):
            self.lines.append(self.process.stdout.readline())
        if not self.lines[-1]:
            raise AssertionError(self.process.communicate()[1])
        for _ in range(200):  # the file follows the line
            if self.json.exists():
                break
            time.sleep(0.02)
        self.report = json.loads(self.json.read_text())
        self.address = self.report["address"]
        self.port = int(self.address.split(":")[2].split("/")[0])
        self.token = self.address.split("/")[3]

    def get(self, path, method="GET", token=None, headers=None, host=None, timeout=30):
        """Returns (status, headers, body)."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        connection.putrequest(method, f"/{self.token if token is None else token}/{path}", skip_host=True)
        connection.putheader("Host", host or f"127.0.0.1:{self.port}")
        for name, value in (headers or {}).items():
            connection.putheader(name, value)
        connection.endheaders()
        reply = connection.getresponse()
        body = reply.read()
        connection.close()
        return reply.status, dict(reply.getheaders()), body

    def json_of(self, path):
        status, _, body = self.get(path)
        if status != 200:
            raise AssertionError(f"{path}: {status} {body}")
        return json.loads(body)

    def octree(self, file):
        """Waits for an octree and returns its state."""
        for _ in range(600):
            state = self.json_of(f"api/octree?file={file}")
            if state["state"] != "building":
                return state
            time.sleep(0.05)
        raise AssertionError("no octree after 30 s")

    def raw(self, text, wait=5.0):
        """Sends bytes as they are and returns what comes back until the server closes."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=wait) as connection:
            try:
                connection.sendall(text)
                connection.shutdown(socket.SHUT_WR)
                out = b""
                while True:
                    got = connection.recv(65536)
                    if not got:
                        return out
                    out += got
            except (ConnectionError, TimeoutError):
                return b""

    def resident_bytes(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return 1024 * int(status.split("VmRSS:")[1].split()[0])

    def end(self):
        self.process.send_signal(signal.SIGINT)
        out, errors = self.process.communicate(timeout=30)
        return self.process.returncode, out, errors


def make_files(folder):
    """Makes a log, a model, primitives, a scene and a score in a folder."""
    cli_test.write_log(folder)
    for verb in ("segment", "fit", "extract", "annotate", "compose", "simulate", "score"):
        words = cli_test.JOBS[verb] + (["--json", "score.json"] if verb == "score" else [])
        done = cli_test.call(verb, *words, cwd=folder)
        assert done.returncode == 0, done.stderr


class Serving(unittest.TestCase):
    """A folder with a log, a model, primitives, a scene and a score, which all tests of a class share."""
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        make_files(cls.folder)
        cls.server = Server(cls.folder, "log.ply", "model", "primitives", "scene", "score.json")

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        cls.temporary.cleanup()


class Serve(Serving):
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
        self.server = Server(folder, "sim.ply")

    def __enter__(self):
        self.server.octree(0)
        return self.server

    def __exit__(self, *_):
        self.server.end()


class ServeSafely(Serving):
    def test_only_this_host(self):
        for host in ("example.org", f"example.org:{self.server.port}", "127.0.0.1", "localhost:1", "0.0.0.0:80",
                     f"127.0.0.1:{self.server.port}.example.org"):
            self.assertEqual(self.server.get("api/files", host=host)[0], 403, host)
        self.assertEqual(self.server.get("api/files", host=f"localhost:{self.server.port}")[0], 200)
        for head in (b"GET /%s/api/files HTTP/1.1\r\n\r\n",
                     b"GET /%s/api/files HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nHost: example.org\r\n\r\n"):
            values = (self.server.token.encode(), self.server.port)[:head.count(b"%")]
            self.assertIn(b" 403 ", self.server.raw(head % values).split(b"\r\n")[0])

    def test_only_with_the_token(self):
        token = self.server.token
        self.assertRegex(token, r"^[0-9a-f]{32}$")
        for other in ("", "api", "0" * 32, token[:-1], token + "0", token.upper() + "x", token + "/.."):
            self.assertIn(self.server.get("api/files", token=other)[0], (403, 404), other)
        with socket.create_connection(("127.0.0.1", self.server.port)) as connection:
            connection.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % self.server.port)
            reply = connection.recv(65536)
        self.assertIn(b" 403 ", reply.split(b"\r\n")[0])
        self.assertNotIn(token.encode(), reply)

    def test_only_on_the_loopback_interface(self):
        listening = pathlib.Path("/proc/net/tcp").read_text().splitlines()
        wanted = f":{self.server.port:04X}"
        addresses = [line.split()[1] for line in listening if line.split()[1].endswith(wanted) and " 0A " in line]
        self.assertEqual(addresses, ["0100007F" + wanted])

    def test_no_path_leads_out(self):
        for path in ("../../etc/passwd", "..%2f..%2fetc%2fpasswd", "%2e%2e/%2e%2e/etc/passwd", "/etc/passwd",
                     "api/../../../../etc/passwd", "api/files/../../secret", "log.ply", "api/score?file=../log.ply",
                     "api/octree/data?file=/etc/passwd", "app.js/../../../etc/passwd", "%00", "app.js%00.html"):
            status, _, body = self.server.get(path)
            self.assertIn(status, (400, 403, 404), path)
            self.assertNotIn(b"root:", body)

    def test_links_are_resolved(self):
        with tempfile.TemporaryDirectory() as folder:
            shown = pathlib.Path(folder, "shown")
            shown.mkdir()
            shutil.copy(pathlib.Path(self.folder, "log.ply"), shown / "log.ply")
            shutil.copy(pathlib.Path(self.folder, "log.ply"), pathlib.Path(folder, "secret.ply"))
            (shown / "link.ply").symlink_to("../secret.ply")
            (shown / "up").symlink_to("..")
            (shown / "same.ply").symlink_to("log.ply")
            (shown / "loop").symlink_to("loop")
            server = Server(folder, "shown")
            try:
                self.assertEqual([f["name"] for f in server.report["files"]], ["shown/log.ply", "shown/same.ply"])
                self.assertEqual(sum("leads out" in note for note in server.report["notes"]), 3)
            finally:
                server.end()

    def test_other_methods_and_large_bodies(self):
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "PROPFIND"):
            reply = self.server.raw(f"{method} /{self.server.token}/api/files HTTP/1.1\r\n"
                                    f"Host: 127.0.0.1:{self.server.port}\r\n\r\n".encode())
            self.assertIn(reply.split(b" ")[1][:3] if reply else b"400", (b"400", b"403", b"405"), method)
        before = self.server.resident_bytes()
        sent = 0
        with socket.create_connection(("127.0.0.1", self.server.port), timeout=10) as connection:
            connection.sendall(f"POST /{self.server.token}/api/files HTTP/1.1\r\nHost: 127.0.0.1:{self.server.port}"
                               f"\r\nContent-Length: {1 << 30}\r\n\r\n".encode())
            try:
                for _ in range(1024):
                    connection.sendall(b"x" * (1 << 20))
                    sent += 1 << 20
            except OSError:
                pass
        self.assertLess(sent, 256 << 20)
        self.assertLess(self.server.resident_bytes() - before, 32 << 20)
        self.assertEqual(self.server.get("api/files")[0], 200)

    def test_what_follows_a_body_is_no_request(self):
        inner = (f"GET /{self.server.token}/api/files HTTP/1.1\r\nHost: 127.0.0.1:{self.server.port}\r\n\r\n").encode()
        outer = (f"GET /{self.server.token}/api/nothing HTTP/1.1\r\nHost: 127.0.0.1:{self.server.port}\r\n"
                 f"Content-Length: {len(inner)}\r\n\r\n").encode()
        self.assertEqual(self.server.raw(outer + inner).count(b"HTTP/1.1 "), 1)

    def test_slow_clients_do_not_hold_the_server(self):
        stop = threading.Event()
        slow = []
        for _ in range(60):
            connection = socket.create_connection(("127.0.0.1", self.server.port), timeout=10)
            connection.sendall(b"GET /")
            slow.append(connection)

        def drip():
            while not stop.wait(0.5):
                for one in slow:
                    try:
                        one.sendall(b"a")
                    except OSError:
                        pass
        thread = threading.Thread(target=drip)
        thread.start()
        try:
            start = time.monotonic()
            status = None
            while status != 200 and time.monotonic() - start < 25:
                try:
                    status = self.server.get("api/files")[0]
                except (OSError, http.client.HTTPException):
                    time.sleep(0.2)
            self.assertEqual(status, 200)
        finally:
            stop.set()
            thread.join()
            for one in slow:
                one.close()

    def test_ten_thousand_odd_requests(self):
        draw = random.Random(21)
        known = ["api/files", "api/octree?file=0", "api/octree/data?file=0", "api/beam?file=0&row=3", "", "app.js",
                 "api/world?file=1", "api/ellipsoids?file=1&model=0", "api/trace?file=0&row=5&world=1&seed=2"]
        for path in known:
            self.server.get(path)
        before = self.server.resident_bytes()
        connection = None
        for k in range(10000):
            text = odd_request(draw, known, self.server)
            try:
                if connection is None:
                    connection = socket.create_connection(("127.0.0.1", self.server.port), timeout=5)
                connection.sendall(text)
                if k % 4 == 0:
                    connection.settimeout(0.002)
                    connection.recv(65536)
                connection.settimeout(5)
                if k % 3 == 0:
                    connection.close()
                    connection = None
            except OSError:
                if connection:
                    connection.close()
                connection = None
        if connection:
            connection.close()
        self.assertIsNone(self.server.process.poll())
        deadline = time.monotonic() + 20
        status = None
        while status != 200 and time.monotonic() < deadline:
            try:
                status = self.server.get("api/files")[0]
            except (OSError, http.client.HTTPException):
                time.sleep(0.2)
        self.assertEqual(status, 200)
        self.assertLess(self.server.resident_bytes() - before, 64 << 20)


def odd_request(draw, known, server):
    """A request that is damaged, or made of parts that do not fit."""
    method = draw.choice(["GET", "GET", "GET", "HEAD", "POST", "FOO", "", "G\0T"])
    token = draw.choice([server.token, server.token, "x", "", server.token * 2])
    path = draw.choice(known)
    headers = {"Host": draw.choice([f"127.0.0.1:{server.port}"] * 5 + ["x", ""]),
               "Range": draw.choice(["bytes=0-9", "bytes=0-0,1-1", "bytes=" + ",".join(["0-1"] * 900),
                                     "bytes=0-99999999999999999999", "bytes=18446744073709551615-", "x", "bytes=-"]),
               draw.choice(["Accept", "Content-Length", "Transfer-Encoding", "Connection", "Expect", "X" * 300]):
               draw.choice(["-1", "chunked", "close", "100-continue", "99999999999999999999", "\x7f", "y" * 3000])}
    text = f"{method} /{token}/{path} HTTP/1.{draw.randrange(3)}\r\n" + "".join(
        f"{key}: {value}\r\n" for key, value in headers.items() if draw.random() < 0.6) + "\r\n"
    text = text.encode("latin-1")
    kind = draw.randrange(4)
    if kind == 0:
        text = text[:draw.randrange(len(text) + 1)]
    elif kind == 1:
        text = bytearray(text)
        for _ in range(draw.randrange(1, 6)):
            text[draw.randrange(len(text))] = draw.randrange(256)
        text = bytes(text)
    elif kind == 2 and draw.random() < 0.1:
        text = draw.randbytes(draw.randrange(1, 4000))
    return text


class ServeLabels(unittest.TestCase):
    """Labels and commands: what they change, what they refuse, and that they write nowhere else."""
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        make_files(cls.folder)
        cls.server = Server(cls.folder, "log.ply", "model", "primitives", "scene", words=("--labels", "work"))
        cls.server.octree(0)

    @classmethod
    def tearDownClass(cls):
        cls.server.end()
        cls.temporary.cleanup()

    def post(self, path, server=None, /, **values):
        query = urllib.parse.urlencode({"file": 0, **values})
        status, _, body = (server or self.server).get(f"api/{path}?{query}", method="POST")
        return status, json.loads(body)

    def revision(self):
        return self.server.json_of("api/labels?file=0")["revision"]

    def test_edits_undo_and_conflicts(self):
        info = json.loads(cli_test.call("info", "log.ply", "--json", "-", cwd=self.folder).stdout)
        known = self.revision()
        status, reply = self.post("labels/edit", revision=known, **{"class": 2}, instance="new", name="all: grass")
        self.assertEqual((status, reply["rows"]), (200, info["hits"]))
        for path in ("labels/edit", "labels/undo", "labels/redo", "labels/box", "labels/import", "labels/carry"):
            values = {"name": "x.ply", "class": 1, "number": 1}
            status, conflict = self.post(path, revision=known, **values)
            self.assertIn(status, (400, 409, 422), path)
            if path in ("labels/edit", "labels/undo", "labels/redo"):
                self.assertEqual((status, conflict["revision"]), (409, known + 1), path)
        self.assertEqual(self.post("labels/undo", revision=known + 1)[0], 200)
        state = self.server.json_of("api/labels?file=0")
        self.assertEqual((state["classes"][2]["points"], state["redos"]), (0, 1))

    def test_labels_come_back_from_their_files(self):
        """The law of export and import: what was written is read again as it was."""
        self.post("labels/edit", revision=self.revision(), **{"class": 1})
        self.post("labels/edit", revision=self.revision(), **{"class": 8}, instance=7, box="0,0,0,20,20,50,0.3")
        before = self.server.json_of("api/labels?file=0")["classes"]
        self.assertGreater(before[8]["points"], 0)
        self.assertGreater(before[1]["points"], 0)
        _, log = self.post("labels/export", format="log", name="out.ply")
        _, file = self.post("labels/export", format="label", name="out.label", set="rellis")
        self.assertEqual(file["without_number"], 0)
        self.assertEqual(self.post("labels/export", format="log", name="out.ply")[0], 400)  # it is served by now
        annotated = cli_test.call("annotate", "work/out.ply", "--min-points", "1", "-o", "out.json", cwd=self.folder)
        self.assertEqual(annotated.returncode, 0, annotated.stderr)
        for values in ({"from": log["file"]}, {"name": "out.label", "set": "rellis"}):
            self.post("labels/edit", revision=self.revision(), **{"class": 0}, instance=0)
            status, _ = self.post("labels/import", revision=self.revision(), **values)
            self.assertEqual(status, 200)
            self.assertEqual(self.server.json_of("api/labels?file=0")["classes"], before)
        status, reply = self.post("labels/carry", revision=self.revision(), scan=0, radius=5)
        self.assertEqual((status, reply["rows"]), (200, 0))  # every point has a class already

    def test_a_killed_server_finds_its_labels(self):
        server = Server(self.folder, "labelled.ply", words=("--labels", "killed"))
        server.octree(0)
        for k in range(8):
            status, _ = self.post("labels/edit", server, revision=server.json_of("api/labels?file=0")["revision"], **{"class": k % 3}, box=f"0,0,0,{5 + 3 * k},30,30,0", stroke=5)
            self.assertEqual(status, 200)
        state = server.json_of("api/labels?file=0")
        server.process.kill()
        server.process.communicate()
        again = Server(self.folder, "labelled.ply", words=("--labels", "killed"))
        again.octree(0)
        self.assertEqual(again.json_of("api/labels?file=0&since=99"), state | {"nodes": []})
        other = Server(self.folder, "labelled.ply", words=("--labels", "killed"))
        other.octree(0)
        self.assertEqual(other.get("api/labels?file=0")[0], 422)  # the first server has them
        other.end()
        again.end()

    def test_what_is_refused(self):
        box = {"class": "small_tree", "position_m": [0, 0, 0], "yaw_rad": 0, "min_m": [-1, -1, 0], "max_m": [1, 1, 2]}
        shape = {"matrix": ",".join(["1"] * 16), "path": "1,1,9,1,9,9", "width": 10, "height": 10}
        before = set(pathlib.Path(self.folder).rglob("*"))
        bad = [("labels/edit", {"class": 99}), ("labels/edit", {"class": -1}), ("labels/edit", {"instance": 1 << 30}),
               ("labels/edit", {**shape, "path": "1,1,9"}), ("labels/edit", {**shape, "matrix": "1,2"}),
               ("labels/edit", {**shape, "width": "nan"}), ("labels/edit", {**shape, "radius": -1}),
               ("labels/edit", {"box": "1,2,3"}), ("labels/edit", {"box": "0,0,0,0,1,1,0"}),
               ("labels/edit", {"hidden": "200"}), ("labels/edit", {"select": "some"}),
               ("labels/box", {"value": "{"}), ("labels/box", {"value": json.dumps({**box, "class": "ground"})}),
               ("labels/box", {"number": 77}), ("labels/nothing", {})]
        bad += [("labels/export", {"format": "log", "name": name})
                for name in ("../x.ply", "a/b.ply", ".x.ply", "-x.ply", "x", "x.txt", "", "x" * 90 + ".ply", "/x.ply")]
        bad += [("labels/import", {"name": name}) for name in ("../log.ply", "/etc/passwd", "nothing.ply")]
        log = {"log": 0, "name": "y.ply"}
        bad += [("jobs/start", {**log, "verb": verb}) for verb in ("", "serve", "segment;ls", "--help", "import")]
        bad += [("jobs/start", {**log, "verb": "segment", **more})
                for more in ({"log": 1}, {"log": 99}, {"name": "../y.ply"}, {"name": "--y.ply"}, {"name": "y"},
                             {"name": "log.txt"}, {"min_range": "1;ls"}, {"min_range": -4})]
        bad += [("jobs/start", {"verb": "compose", "annotation": "../site.json", "primitives": 2, "name": "z"}),
                ("jobs/cancel", {"number": 12345})]
        for path, values in bad:
            with self.subTest(path=path, values=values):
                status, reply = self.post(path, **{"revision": self.revision(), **values})
                self.assertIn(status, (400, 404, 422))
                self.assertTrue(reply["error"])
        self.assertEqual(set(pathlib.Path(self.folder).rglob("*")), before)

    def test_only_the_page_may_change_labels(self):
        path = f"api/labels/edit?file=0&class=1&revision={self.revision()}"
        self.assertEqual(self.server.get(path)[0], 405)  # GET changes nothing
        own = self.server.address.split("/" + self.server.token)[0]
        for origin in (own.replace("127.0.0.1", "example.org"), "null", own.replace(":", "s:", 1), own + "0"):
            self.assertEqual(self.server.get(path, "POST", headers={"Origin": origin})[0], 403, origin)
        self.assertEqual(self.server.get(path, "POST", token="0" * 32)[0], 403)
        self.assertEqual(self.server.get(path, "POST", host="example.org")[0], 403)
        self.assertEqual(self.server.get(path, "POST", headers={"Content-Length": "5"})[0], 413)
        self.assertEqual(self.server.get(path, "POST", headers={"Origin": own})[0], 200)
        reader = Server(self.folder, "log.ply")
        self.assertEqual([reader.get(p, "POST")[0] for p in (path, "api/jobs/start?verb=fit")], [403, 403])
        reader.end()

    def test_a_link_in_the_folder_is_not_followed(self):
        work = pathlib.Path(self.folder, "work")
        outside = pathlib.Path(self.folder, "outside.label")
        outside.write_bytes(b"kept")
        (work / "link.label").symlink_to(outside)
        self.assertEqual(self.post("labels/export", format="label", name="link.label")[0], 400)
        self.assertEqual(self.post("labels/import", revision=self.revision(), name="link.label")[0], 400)
        self.assertEqual(outside.read_bytes(), b"kept")

    def test_commands(self):
        status, job = self.post("jobs/start", verb="simulate", world=3, like=0, name="scan.ply", seed=5)
        self.assertEqual(status, 200, job)
        self.assertRegex(job["command"], r"^underbrush simulate \S+/scene --like \S+/log.ply --seed 5 -o \S+/scan.ply$")
        job = self.ended(job["number"])
        self.assertEqual(job["state"], "done", job)
        files = self.server.json_of("api/files")["files"]
        self.assertIn(("scan.ply", "log"), [(f["name"], f["kind"]) for f in files])
        cli_test.call("simulate", "scene", "--like", "log.ply", "--seed", "5", "-o", "same.ply", cwd=self.folder)
        same = [json.loads(cli_test.call("score", "log.ply", p, "--json", "-", cwd=self.folder).stdout)["models"]
                for p in ("same.ply", "work/scan.ply")]
        self.assertEqual(list(same[0].values()), list(same[1].values()))
        _, job = self.post("jobs/start", verb="fit", log=0, name="m")
        self.assertEqual(self.post("jobs/cancel", number=job["number"])[0], 200)
        self.assertIn(self.ended(job["number"])["state"], ("cancelled", "done"))

    def ended(self, number):
        for _ in range(600):
            job = self.server.json_of(f"api/jobs/log?number={number}")
            if job["state"] != "running":
                return job
            time.sleep(0.05)
        raise AssertionError("a command that does not end")


class ServeEnds(Serving):
    def test_on_ctrl_c(self):
        with tempfile.TemporaryDirectory() as cache:
            server = Server(self.folder, "log.ply", cache=cache)
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
            server = Server(self.folder, "log.ply", cache=cache)
            server.json_of("api/octree?file=0")
            code, _, _ = server.end()
            self.assertEqual(code, -signal.SIGINT)
            self.assertTrue(all(p.suffix == ".octree" for p in pathlib.Path(cache).iterdir()), os.listdir(cache))

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
