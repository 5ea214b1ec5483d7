#!/usr/bin/env python3
"""Tests of what `underbrush serve` refuses: nothing that it was not started for is read, no request without the token is
answered, and neither odd requests nor slow or large ones cost more than a moment."""
import http.client
import pathlib
import random
import shutil
import socket
import tempfile
import threading
import time

import cli_test
import serving

class ServeSafely(serving.Serving):
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
            server = serving.Server(folder, "shown")
            try:
                self.assertEqual([f["name"] for f in server.report["files"]], ["shown/log.ply", "shown/same.ply"])
                self.assertEqual(sum("leads out" in note for note in server.report["notes"]), 3)
            finally:
                server.end()

    def test_files_of_one_name_are_told_apart(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a/day", "b/day"):
                pathlib.Path(folder, name).mkdir(parents=True)
                shutil.copy(pathlib.Path(self.folder, "log.ply"), pathlib.Path(folder, name, "log.ply"))
            server = serving.Server(folder, "a/day/log.ply", "b/day/log.ply", "a/day/log.ply")
            names = [f["name"] for f in server.report["files"]]
            server.end()
            self.assertEqual(names, ["a/day/log.ply", "b/day/log.ply", "a/day/log.ply"])

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
        length = f"Content-Length: {len(inner)}".encode()
        for hidden in (b" " + length, length.replace(b":", b" :"), b"X: y\r\n " + length, b"X: y\n" + length,
                       b"X\0: y\r\n" + length, b"X: y\r" + length, b"no header\r\n" + length):
            head = outer.replace(length, hidden)
            self.assertLessEqual(self.server.raw(head + inner).count(b"HTTP/1.1 "), 1, hidden)

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


if __name__ == "__main__":
    cli_test.main()
