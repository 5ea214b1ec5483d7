"""Attacks on `underbrush serve`: ranges, slow and many clients, requests in requests, job words, damaged files."""
import contextlib
import itertools
import pathlib
import resource
import shutil
import socket
import sys
import tempfile
import threading
import time
import urllib.parse

import served_files
from bounded import ANSWER, REFUSAL

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "cli"))
import cli_test  # noqa: E402
import serving  # noqa: E402

CONNECTIONS = 10_000
HELD = 256 << 20  # bytes by which the server may grow
MARK = b"HTTP/1.1 "


def alive(server, seconds=30):
    """None if the server answers within some time, or what is wrong."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with contextlib.suppress(Exception):
            if server.get("api/files", timeout=5)[0] == 200:
                return None
        if server.process.poll() is not None:
            return f"the server ended with {server.process.returncode}"
        time.sleep(0.1)
    return f"no answer for {seconds} s"


def ranges(server):
    """Each answer is the bytes that were asked for, or a refusal."""
    whole = next(pathlib.Path(server.json.parent, "cache").glob("*.octree")).read_bytes()
    n = len(whole)
    numbers = (0, 1, n // 2, n - 1, n, n + 1, 2 * n, 2**31, 2**32, 2**63 - 1, 2**63, 2**64 - 1, 2**64, -1, "", "x")
    for first, last in itertools.product(numbers, numbers):
        status, headers, body = server.get("api/octree/data?file=0", headers={"Range": f"bytes={first}-{last}"})
        outcome = REFUSAL if status in (400, 416) else f"status {status}"
        if status == 200:
            outcome = ANSWER if body == whole else "not the whole file"
        if status == 206:
            end = min(n, int(last) + 1) if last != "" else n
            outcome = ANSWER if body == whole[int(first):end] else "other bytes than asked for"
        yield outcome, f"bytes={first}-{last} of {n}"


def slow_readers(server):
    """Clients that ask for much and read nothing."""
    held = []
    request = f"GET /{server.token}/api/octree/data?file=0 HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode()
    for _ in range(20):
        one = socket.socket()
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        one.connect(("127.0.0.1", server.port))
        one.sendall(request * 100)
        held.append(one)
        yield alive(server) or ANSWER, f"{len(held)} readers that do not read"
    for one in held:
        one.close()


def many_connections(server):
    """Connections that say nothing, or a part of a request."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    count = min(CONNECTIONS, hard - 200)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, count + 200), hard))
    before, held = server.resident_bytes(), []
    for k in range(count):
        with contextlib.suppress(OSError):
            held.append(socket.create_connection(("127.0.0.1", server.port), timeout=2))
            held[-1].send(b"" if k % 2 else b"GET /" + server.token.encode())
        if k % 2000 == 1999:
            yield alive(server) or ANSWER, f"{len(held)} connections"
    grown = server.resident_bytes() - before
    yield ANSWER if grown < HELD else f"grew by {grown >> 20} MiB", f"memory of {len(held)} connections"
    for one in held:
        one.close()
    yield alive(server) or ANSWER, "after they were closed"
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def smuggled(server):
    """A request in the body of another one is never answered."""
    host = f"Host: 127.0.0.1:{server.port}\r\n"
    inner = f"GET /{server.token}/api/files HTTP/1.1\r\n{host}\r\n"
    n, chunk = len(inner), f"{len(inner):x}\r\n{inner}\r\n0\r\n\r\n"
    heads = (f"Content-Length: {n}\r\nContent-Length: 0", f"Content-Length: 0\r\nContent-Length: {n}",
             f"Content-Length: {n}, 0", f"Content-Length: +{n}", f"Content-Length: 0x{n:x}", f"Content-Length : {n}",
             f" Content-Length: {n}", f"X: y\r\n Content-Length: {n}", f"Content-Length:\t{n}", "Content-Length: -1",
             f"content-length: {n}", f"Content-Length: 0{n}", "Content-Length: 99999999999999999999",
             f"X: y\rContent-Length: {n}", f"X: y\nContent-Length: {n}", f"X\0: y\r\nContent-Length: {n}",
             "Transfer-Encoding: chunked", f"Transfer-Encoding: chunked\r\nContent-Length: {n}",
             "Transfer-Encoding: xchunked", "Transfer-Encoding: identity, chunked", "Transfer-Encoding:\vchunked",
             "Transfer-Encoding : chunked", "Transfer-Encoding: chunked\r\nTransfer-Encoding: identity",
             f"Expect: 100-continue\r\nContent-Length: {n}", f"Upgrade: h2c\r\nContent-Length: {n}")
    for method, head, body in itertools.product(("GET", "POST", "HEAD"), heads, (inner, chunk)):
        for end in ("\r\n\r\n", "\n\n"):
            text = f"{method} /{server.token}/api/nothing HTTP/1.1\r\n{host}{head}{end}{body}"
            reply = server.raw(text.encode(), wait=8)
            answers, inside = reply.count(MARK) - reply.count(MARK + b"100"), b'"files"' in reply
            outcome = REFUSAL if answers <= 1 and not inside else f"{answers} answers"
            yield outcome, f"{method} {head!r} {end!r}"


def huge_heads(server):
    """Long lines, many lines, long numbers."""
    start, host = f"GET /{server.token}/api/files", f"Host: 127.0.0.1:{server.port}\r\n"
    before = server.resident_bytes()
    for n in (10_000, 100_000, 10_000_000):
        for text in (f"{start} HTTP/1.1\r\n{host}X: {'y' * n}\r\n\r\n", f"{start}?{'y' * n} HTTP/1.1\r\n{host}\r\n",
                     f"{start} HTTP/1.1\r\n{host}" + "X: y\r\n" * (n // 6) + "\r\n", "G" * n, "\r\n" * (n // 2),
                     f"{start}?" + "a=b&" * (n // 4) + f" HTTP/1.1\r\n{host}\r\n",
                     f"{start}?file=" + "%00" * (n // 3) + f" HTTP/1.1\r\n{host}\r\n",
                     f"{start} HTTP/1.1\r\n{host}Range: bytes=" + "0-0," * (n // 4) + "\r\n\r\n"):
            reply = server.raw(text.encode(), wait=8)
            wrong = alive(server)
            grown = server.resident_bytes() - before
            wrong = wrong or (f"grew by {grown >> 20} MiB" if grown > HELD else None)
            yield wrong or (ANSWER if reply.startswith(MARK + b"200") else REFUSAL), text[:60]


def job_words(server):
    """Names and numbers of jobs that are options, paths, or hold control characters: none starts a command."""
    odd = ("-o", "--help", "--json=x", "a\0b", "a\nb", "../a", "/a", "a b", "$(id)", "`id`", ";id", "a'b", "\x7f",
           "a" * 300, "\udcff", "é", ".", "..", ".hidden", "%2e%2e", "+1", "1,5")
    for verb, values, more in (("segment", {"log": 0, "name": "x.ply"}, ("min_points",)),
                               ("fit", {"log": 0, "name": "x"}, ("seed", "min_points", "fitter")),
                               ("simulate", {"world": 1, "like": 0, "name": "x.ply"}, ("seed",))):
        keys = [*values, "verb", *more]
        for key, word in itertools.product(keys, odd):
            query = urllib.parse.urlencode({"verb": verb, **values, key: word}, errors="surrogateescape")
            status, _, body = server.get("api/jobs/start?" + query, method="POST")
            yield (REFUSAL if 400 <= status < 500 else f"status {status}: {body[:200]}"), f"{verb} {key}={word!r}"


ATTACKS = {"byte ranges": ranges, "readers that do not read": slow_readers, "many connections": many_connections,
           "requests in requests": smuggled, "huge requests": huge_heads, "words of jobs": job_words}


def two_servers(folder):
    """The second server of a folder of labels refuses in one line, or both serve and one of them edits."""
    first = serving.Server(folder, "log.ply", words=("--labels", "work"))
    first.octree(0)
    first.get("api/labels?file=0")
    second = serving.Server(folder, "log.ply", words=("--labels", "work"))
    second.octree(0)
    status, _, body = second.get("api/labels?file=0")
    yield (REFUSAL if status in (409, 422, 423, 500, 503) else f"status {status} {body[:100]}"), "labels of both"
    yield alive(first) or ANSWER, "the first goes on"
    for one in (first, second):
        one.end()


def attack(options, table):
    cli_test.PROGRAM = str(options.program)
    folder = pathlib.Path(tempfile.mkdtemp(dir=options.scratch))
    serving.make_files(folder)
    server = serving.Server(folder, "log.ply", "model", words=("--labels", "jobs"))
    server.octree(0)
    for name, tries in ATTACKS.items():
        for outcome, what in tries(server):
            table.add("server: " + name, outcome, what)
        table.add("server: " + name, alive(server) or ANSWER, "at the end")
    server.end()
    for outcome, what in two_servers(folder):
        table.add("server: two on one folder", outcome, what)
    served_files.attack(options, folder, table)
