"""What the tests of `underbrush serve` share: a running server, requests to it, and files of each kind."""
import http.client
import json
import pathlib
import signal
import socket
import subprocess
import tempfile
import time
import unittest

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

    def ended(self, number):
        """Waits for the end of a command and returns its job, with its log."""
        for _ in range(600):
            job = self.json_of(f"api/jobs/log?number={number}")
            if job["state"] != "running":
                return job
            time.sleep(0.05)
        raise AssertionError("a command that does not end")

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
