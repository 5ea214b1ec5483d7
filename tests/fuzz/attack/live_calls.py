"""Attacks a sensor server of its own: `live_calls.py ATTACK FOLDER PROGRAM SEED`.

Prints [[outcome, count, what], …]: calls that were answered, refused in one line, or what is wrong. After each attack the
server must answer a firing with the same bits as before, and hold no more memory.
"""
import collections
import concurrent.futures
import contextlib
import json
import math
import os
import pathlib
import random
import resource
import signal
import socket
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "share/live"))
import grpc  # noqa: E402
import underbrush_live as live  # noqa: E402

proto, Code = live.proto, grpc.StatusCode
FIRE = "/underbrush.live.v1.SensorServer/Fire"
HELD = 300 << 20  # bytes by which the server may grow
CONNECTIONS = 1500
ODD = (float("nan"), float("inf"), -float("inf"), -1.0, -0.0, 1e-300, 5e-324, 0.5, 1e9, -1e9, 4294967296.0, 1e18, 1.7e308)
TOKEN = "a-token-of-this-attack"
REFUSALS = (Code.INVALID_ARGUMENT, Code.RESOURCE_EXHAUSTED, Code.UNAUTHENTICATED, Code.DEADLINE_EXCEEDED, Code.CANCELLED,
            Code.UNIMPLEMENTED)


class Server:
    """A server whose sensor fires 800 beams a revolution, in a model, with an actor."""
    def __init__(self, folder, program, *words):
        (folder / "token").write_text(TOKEN + "\n")
        listen = () if "--listen" in words else ("--listen", "127.0.0.1:0")
        self.process = subprocess.Popen(
            [program, "live", "model", "--sensor", "spinning.yaml", "--mover", "van=van.obj", "--token", "token", "--json", "-",
             *listen, *words], cwd=folder, stdout=subprocess.PIPE, text=True)
        lines = iter(self.process.stdout.readline, "")
        self.address = json.loads("".join(next(lines) for _ in range(5)))["address"]
        self.before = self.resident()

    def resident(self):
        pages = int(pathlib.Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * resource.getpagesize()

    def client(self, token=TOKEN):
        return live.SensorServer(self.address, token, 0.0, live.pose([0, 0, 1.8]))

    def bits(self):
        """What a firing of a tenth of a second measures."""
        found = self.client().fire(0.1, live.pose([0.3, 0, 1.8]), {"van": live.pose([3, 1, 1])})
        return b"".join(found[name].tobytes() for name in sorted(found))


def request(**more):
    poses = [proto.StampedPose(time_s=t, world_from_body=live.pose([t, 0, 1.8])) for t in (0.0, 0.01)]
    return proto.FireRequest(until_s=0.01, vehicle=proto.Motion(poses=poses), **more)


def outcome_of(call, of_bytes=False):
    """Reads all of a call: an answer, a refusal, or what is wrong. gRPC itself refuses bytes that are no message."""
    try:
        for _ in call:
            pass
        return "answer"
    except grpc.RpcError as error:
        no_message = of_bytes and error.code() == Code.INTERNAL and "\n" not in error.details()
        return "refusal" if no_message else judged(error.code(), error.details())


def judged(code, words):
    if code not in REFUSALS:
        return f"status {code.name}: {words[:200]}"
    if not words or "\n" in words or len(words) > 600 or not words.isprintable():
        return f"{code.name} in other words than one line: {words[:200]!r}"
    return "refusal"


def sender(client):
    """A function that sends bytes as a request to fire."""
    fire = client.channel.unary_stream(FIRE)
    return lambda data, timeout=30: fire(data, metadata=client.metadata, timeout=timeout)


def numbers_of(message, path=()):
    """(path, field) of each number of a message; messages that are not there are made."""
    for field in message.DESCRIPTOR.fields:
        repeated = hasattr(getattr(message, field.name), "add")
        if field.message_type:
            if repeated and not getattr(message, field.name):
                getattr(message, field.name).add()
            places = range(len(getattr(message, field.name))) if repeated else (None,)
            for k in places:
                inner = getattr(message, field.name)
                yield from numbers_of(inner if k is None else inner[k], (*path, (field.name, k)))
        elif field.cpp_type == field.CPPTYPE_DOUBLE:
            yield path, field.name


def fields(server, _):
    """Each number of a request, one at a time, and names of all kinds."""
    send = sender(server.client())
    for moves in (False, True):
        places = list(numbers_of(request(actors=[proto.Actor(name="van")])))
        for (path, name), value in ((place, value) for place in places for value in ODD):
            message = request(actors=[proto.Actor(name="van")] if any(p[0] == "actors" for p in path) else [])
            if moves:
                del message.vehicle.poses[1:]
                message.vehicle.velocity_m_per_s.x = 1
            inner = message
            with contextlib.suppress(IndexError):
                for part, k in path:
                    inner = getattr(inner, part) if k is None else (getattr(inner, part) or [getattr(inner, part).add()])[k]
                setattr(inner, name, value)
                outcome = outcome_of(send(message.SerializeToString()))
                outcome = "answered" if outcome == "answer" and not math.isfinite(value) else outcome
                yield outcome, f"{'/'.join(p for p, _ in path)}/{name} = {value}"
    odd = ("", " ", "..", "/", "\0", "\n", "\x1b[2J", "é", "‮", "x" * 100_000, "%s%n", "van ", "RANGE_M", "range_m")
    for word in odd:
        for what, message in (("actor", request(actors=[proto.Actor(name=word)])), ("column", request(columns=[word])),
                              ("layout", request(layout=word)), ("world", request(world=word)),
                              ("columns", request(columns=[word] * 2))):
            yield outcome_of(send(message.SerializeToString())), f"{what} {word[:20]!r}"
        try:
            server.client().describe(word)
            yield "answer", ""
        except grpc.RpcError as error:
            yield judged(error.code(), error.details()), f"describe {word[:20]!r}"
    for start, begin, end in ((0, 0, 1e9), (-1e9, -1e9, 0), (-5, -5, -4.9), (0, 3599, 3599.1), (1e9, 1e9, 1e9 + 1), (0, 1, 0),
                              (-1e308, 0, 1e308), (0, 0, 0), (0, 0, 3600), (0, 0, 1e-9), (1e15, 1e15, 1e15 + 1)):
        message = request(start_s=start, from_s=begin)
        message.until_s = end
        del message.vehicle.poses[1:]
        yield outcome_of(send(message.SerializeToString())), f"from {begin} until {end}, start {start}"


def damaged(server, chance):
    """Bytes of any kind, and requests with bytes changed, cut off or repeated."""
    send, good = sender(server.client()), request(actors=[proto.Actor(name="van", motion=request().vehicle)]).SerializeToString()
    for k in range(3000):
        data = bytearray(chance.randbytes(chance.choice((0, 1, 5, 40, 400))) if k % 3 == 0 else good)
        for _ in range(chance.randint(1, 4) if data else 0):
            at = chance.randrange(len(data))
            how = chance.randrange(3)
            data[at:at + (how < 2)] = (data[:at] if how else [chance.randrange(256)])
            data = data[:20_000] or bytearray(b"\0")
        yield outcome_of(send(bytes(data)), of_bytes=True), f"request {k}"


def sizes(server, _):
    """Many poses, actors and columns, messages beyond the limit, and messages in messages."""
    send, pose = sender(server.client()), live.pose([0, 0, 1.8])
    def path(n):
        return proto.Motion(poses=[proto.StampedPose(time_s=0.01 * k / n, world_from_body=pose) for k in range(n + 1)])
    for n in (1000, 10_000, 20_000, 100_000, 1_000_000):
        message = request()
        message.vehicle.CopyFrom(path(n))
        yield outcome_of(send(message.SerializeToString())), f"{n} poses"
    for n in (1000, 30_000, 100_000):
        yield outcome_of(send(request(actors=[proto.Actor(name="van", absent=True)] * n).SerializeToString())), f"{n} actors"
        yield outcome_of(send(request(actors=[proto.Actor(name=f"v{k}") for k in range(n)]).SerializeToString())), f"{n} names"
        yield outcome_of(send(request(columns=[f"c{k}" for k in range(n)]).SerializeToString())), f"{n} columns"
    for n in (1 << 20, 1 << 21, 1 << 24, 1 << 26):
        yield outcome_of(send(b"\x42" + varint(n) + b"w" * n)), f"{n} bytes of a name"
        yield outcome_of(send(b"\xfa\x3f" + varint(n) + b"\0" * n)), f"{n} bytes of an unknown field"
    for depth in (50, 200, 10_000, 300_000):
        yield outcome_of(send(b"\x0b" * depth + b"\x0c" * depth), of_bytes=True), f"{depth} groups"
        inner = b""
        for _ in range(min(depth, 3000)):
            inner = b"\x22" + varint(len(inner)) + inner
        yield outcome_of(send(inner), of_bytes=True), f"{depth} messages"


def varint(value):
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return out + bytearray([value])


def lives(server):
    """An answer where a call is answered, with the bits of a quiet server."""
    try:
        return "answer" if server.bits() == server.good else "other bits than before"
    except grpc.RpcError as error:
        return f"afterwards {error.code().name}: {error.details()[:200]}"


def raw(server, data):
    host, port = server.address.rsplit(":", 1)
    one = socket.create_connection((host, int(port)), timeout=5)
    with contextlib.suppress(OSError):
        one.sendall(data)
    return one


def connections(server, chance):
    """Connections that say nothing, other things than HTTP/2, or half of it."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, CONNECTIONS + 200)), hard))
    preface = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
    def frame(kind, flags, stream, body=b""):
        return len(body).to_bytes(3, "big") + bytes([kind, flags]) + stream.to_bytes(4, "big") + body
    hello = preface + frame(4, 0, 0)
    odd = (b"", b"GET / HTTP/1.1\r\n\r\n", preface[:10], preface, hello, hello + b"\xff" * 9, hello + frame(0, 0, 1, b"x" * 100),
           hello + frame(6, 0, 0, b"12345678") * 10_000, hello + frame(4, 0, 0) * 10_000,
           hello + b"".join(frame(1, 4, 2 * k + 1) + frame(3, 0, 2 * k + 1, b"\0\0\0\x08") for k in range(10_000)),
           hello + frame(1, 0, 1, b"\x82") + frame(9, 0, 1, b"\x40\x01a\x01b" * 100) * 200, hello + frame(8, 0, 0, b"\x7f\xff\xff\xff") * 3,
           b"\x16\x03\x01" + chance.randbytes(500), chance.randbytes(100_000))
    for data in odd:
        raw(server, data).close()
        yield lives(server), f"{data[:30]!r}"
    held = []
    for k in range(CONNECTIONS):
        with contextlib.suppress(OSError):
            held.append(raw(server, odd[k % 5]))
        if k % 500 == 499:
            yield lives(server), f"{len(held)} connections"
    for one in held:
        one.close()
    yield lives(server), "after they were closed"


def tokens(server, chance):
    """Words that are not the token, and metadata of all kinds: nothing is answered without the token."""
    wrong = ["", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), " " + TOKEN, TOKEN + " ", "Bearer " + TOKEN, "x" * 7000, "x" * 100_000]
    wrong += ["".join(chance.choice(TOKEN) for _ in TOKEN) for _ in range(200)]
    for word in wrong:
        outcome = outcome_of(server.client(word).stub.Fire(request(), metadata=[("authorization", "Bearer " + word)], timeout=10))
        yield "answered without the token" if outcome == "answer" else outcome, f"token {word[:30]!r}"
    client = server.client()
    right = client.metadata[0]
    for metadata in ([], [("authorization", "bearer " + TOKEN)], [("authorization", TOKEN)], [("authorization", "")],
                     [("authorization", "Bearer"), ("authorization", "x")], [("authorization-bin", right[1].encode())]):
        outcome = outcome_of(client.stub.Fire(request(), metadata=metadata, timeout=10))
        yield "answered without the token" if outcome == "answer" else outcome, f"metadata {metadata}"
    for metadata in ([right, ("x", "y" * 5000)], [right, *(("x", "y") for _ in range(100))], [right, ("x-bin", b"\0\xff" * 100)]):
        yield outcome_of(client.stub.Fire(request(), metadata=metadata, timeout=10)), f"metadata of {len(metadata)}"


def long_request(columns=("origin", "direction", "time_s"), seconds=100.0):
    """About 80 000 beams."""
    message = request(columns=columns)
    message.until_s = seconds
    del message.vehicle.poses[1:]
    return message


def readers(server, _):
    """Clients that ask for much and read nothing, more than are served at a time."""
    held, most = [], 0
    for k in range(40):
        client = server.client()
        held.append((client, client.stub.Fire(long_request(), metadata=client.metadata, timeout=15)))
        most = max(most, server.resident() - server.before)
        time.sleep(0.05)
    yield "answer" if most < HELD else f"grew by {most >> 20} MiB", "memory of 40 readers that do not read"
    for client, _ in held:
        client.channel.close()
    time.sleep(0.5)
    yield lives(server), "after they were gone"


def cancelled(server, chance):
    """Calls that are cancelled at random moments, also before they begin."""
    client = server.client()
    for k in range(300):
        call = client.stub.Fire(long_request(seconds=chance.choice((1.0, 10.0, 100.0))), metadata=client.metadata, timeout=30)
        time.sleep(chance.choice((0, 0, 0.001, 0.01, 0.05)) * chance.random())
        call.cancel()
        yield outcome_of(call), f"call {k}"
        if k % 50 == 49:
            time.sleep(0.3)
            yield lives(server), f"after {k + 1} calls"


def many(server, _):
    """64 clients at once, of which some close their connections: each answer has the right bits."""
    def one(k):
        out = []
        for _ in range(10):
            try:
                out.append("answer" if server.bits() == server.good else "other bits than of one client")
            except grpc.RpcError as error:
                out.append(judged(error.code(), error.details()))
            if k % 4 == 0:
                client = server.client()
                client.stub.Fire(long_request(seconds=5.0), metadata=client.metadata, timeout=30)
                client.channel.close()
        return out
    with concurrent.futures.ThreadPoolExecutor(64) as pool:
        for k, found in enumerate(pool.map(one, range(64))):
            yield from ((outcome, f"client {k}") for outcome in found)


def make_worlds(folder, chance):
    """A folder of worlds that are none: damaged, giant, pipes, devices, and links that lead out."""
    folder.mkdir()
    wall = "v 5 -9 -9\nv 5 9 -9\nv 5 9 9\nv 5 -9 9\n"
    files = {"good.obj": wall + "f 1 2 3 4\n", "empty.obj": "", "none.obj": "f 1 2 3\n", "nan.obj": "v nan 0 0\n" + wall + "f 1 2 3\n",
             "huge.obj": "v 1e300 0 0\nv 0 1e300 0\nv 0 0 1e300\nf 1 2 3\n", "index.obj": wall + "f 1 2 99999999\n",
             "noise.ply": chance.randbytes(5000), "noise.stl": chance.randbytes(5000), "a.txt": "x", "x.xml": "<document>" * 5000,
             "giant.obj": "v 0 0 0\n" * 400_000 + "f 1 2 3\n" * 400_000, "line.obj": "v " + "1" * 10_000_000,
             "polygon.obj": wall * 20_000 + "f " + " ".join(map(str, range(1, 80_000))) + "\n",
             "many.ply": "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty float x\nproperty float y\n"
                         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"}
    for name, content in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    os.mkfifo(folder / "pipe.obj")
    for name, target in (("zero.obj", "/dev/zero"), ("out.obj", "../van.obj"), ("self.obj", "self.obj"), ("root", "/")):
        (folder / name).symlink_to(target)
    for name in ("folder", "model"):
        (folder / name).mkdir()
    (folder / "model/model.json").write_text("[" * 5000)
    return [*files, "pipe.obj", "zero.obj", "out.obj", "self.obj", "root", "folder", "model", "folder/..", "good.obj/"]


def worlds(server, _):
    """Worlds of the folder that are none, for each of which the server refuses or answers, and goes on."""
    for name in server.worlds:
        for _ in range(2):
            client = server.client()
            yield outcome_of(client.stub.Fire(request(world=name), metadata=client.metadata, timeout=50)), f"world {name}"
            with contextlib.suppress(grpc.RpcError):
                client.describe(name)
        yield lives(server), f"after world {name}"


def killed(folder, program, chance):
    """kill -9 in the middle of firings, and a new server at the same address: a client goes on with the right bits."""
    words = ("--listen", f"unix:{folder}/s")
    server = Server(folder, program, *words)
    good = server.bits()
    for k in range(15):
        client = server.client()
        call = client.stub.Fire(long_request(), metadata=client.metadata, timeout=20)
        time.sleep(0.1 * chance.random())
        server.process.send_signal(signal.SIGKILL)
        server.process.communicate()
        try:
            for _ in call:
                pass
            yield "answer", ""
        except grpc.RpcError as error:
            yield "refusal" if error.code() in (Code.UNAVAILABLE, Code.CANCELLED) else f"{error.code()}", f"round {k}"
        server = Server(folder, program, *words)
        yield "answer" if server.bits() == good else "other bits than before", f"after round {k}"
    server.process.send_signal(signal.SIGTERM)
    server.process.communicate()


def watch(server, stop, most):
    while not stop.wait(0.05):
        with contextlib.suppress(OSError, ValueError):
            most[0] = max(most[0], server.resident() - server.before)


def main():
    name, folder, program, seed = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    chance, counts = random.Random(seed), collections.Counter()
    if name == "killed":
        found = killed(folder, program, chance)
        counts.update((outcome, "" if outcome in ("answer", "refusal") else what) for outcome, what in found)
    else:
        made = make_worlds(folder / "worlds", chance) if name == "worlds" else []
        server = Server(folder, program, *(("--worlds", "worlds") if made else ()))
        server.good, server.worlds = server.bits(), made
        stop, most = threading.Event(), [0]
        thread = threading.Thread(target=watch, args=(server, stop, most))
        thread.start()
        try:
            for outcome, what in globals()[name](server, chance):
                counts[outcome, "" if outcome in ("answer", "refusal") else what] += 1
                if server.process.poll() is not None:
                    counts[f"the server ended with {server.process.returncode}", what] += 1
                    break
            counts[lives(server), "at the end"] += 1
            counts["answer" if most[0] < HELD else f"grew by {most[0] >> 20} MiB", "memory"] += 1
        finally:
            stop.set()
            thread.join()
            server.process.kill()
            server.process.communicate()
    print(json.dumps([[outcome, count, what] for (outcome, what), count in counts.items()]))


if __name__ == "__main__":
    main()
    os._exit(0)
