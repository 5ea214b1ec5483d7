"""Damage of the files that `underbrush serve` keeps: flipped bytes of octrees and journals, and lies in their fields."""
import pathlib
import random
import sys
import urllib.parse

import own_files
from bounded import ANSWER, REFUSAL

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "cli"))
import serving  # noqa: E402

FLIPS = 60
HELD = 512 << 20  # bytes that the server may hold
BOX = urllib.parse.quote('{"class":"small_tree","position_m":[0,0,0],"yaw_rad":0,"min_m":[0,0,0],"max_m":[1,1,1]}')
#: What makes a journal of each kind of record.
EDITS = ("edit?file=0&revision=0&class=2&instance=new&slab=0,0,1,-50,50&name=all&stroke=1",
         "box?file=0&revision=1&value=" + BOX, "undo?file=0&revision=2", "redo?file=0&revision=3",
         "edit?file=0&revision=4&class=3&slab=0,0,1,-50,1&name=low&stroke=2")
#: All that reads nodes, runs, points, the description, or labels.
PATHS = ("api/labels?file=0", "api/octree?file=0", "api/beam?file=0&row=3", "api/preview?file=0",
         "api/beams?file=0&run=0", "api/trajectory?file=0", "api/range_image?file=0&run=0&world=1&seed=1",
         "api/labels/data?file=0&nodes=0", "api/labels/count?file=0&box=1,2,0,9,9,9,0.5&hidden=1", "api/labels/instances?file=0",
         "api/labels/count?file=0&slab=0,0,1,-9,9&scan=0", "api/trace?file=0&row=3&world=1&seed=2", "api/errors?file=0&other=0&nodes=0")


def flips(data, seed):
    """The bytes with one changed, at places of which half are near the beginning."""
    chance = random.Random(seed)
    for k in range(FLIPS):
        at = chance.randrange(min(len(data), 200) if k % 2 else len(data))
        yield data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1:]


def begun(folder, words):
    """A server of the folder, or what came of its start: a refusal in one line is right."""
    try:
        return serving.Server(folder, "log.ply", "model", words=words), None
    except AssertionError as error:
        lines = str(error).strip().splitlines()
        one = len(lines) == 1 and lines[0].startswith("underbrush: ")
        return None, REFUSAL if one else f"refused in {len(lines)} lines: {str(error)[:300]}"


def asked(server):
    """What came of all requests of a server."""
    states = []
    for path in PATHS:
        status, _, body = server.get(path, timeout=20)
        states.append(status)
        if status >= 400 and (b"\n" in body.strip() or any(word in body for word in (b"bad_alloc", b"vector", b"json.exc"))):
            return f"{path}: {status} {body[:200]}"
    if server.resident_bytes() > HELD:
        return f"held {server.resident_bytes() >> 20} MiB"
    return ANSWER if max(states) < 400 else REFUSAL


def damaged(folder, name, words, changed):
    """Yields what came of each changed content of a file that the server keeps."""
    file = next(folder.glob(name))
    good = file.read_bytes()
    for number, data in enumerate(changed(good)):
        file.write_bytes(data)
        server, outcome = begun(folder, words)
        try:
            if server is not None:
                server.octree(0)
                outcome = asked(server)
        except (AssertionError, OSError) as error:
            outcome = f"no answer: {error}, state {server.process.poll()}"
        if server is not None:
            server.process.kill()
            server.process.communicate()
        for left in folder.glob("work/*.lost"):
            left.unlink()
        yield outcome, f"{name} {number}"
    file.write_bytes(good)


def some(lies, most):
    """At most so many of the lies, spread evenly."""
    found = list(dict.fromkeys(lies))
    return found[::max(1, -(-len(found) // most))]


def make_journal(folder, words):
    """Writes a journal that has each kind of record."""
    for left in folder.glob("work/*"):
        left.unlink()
    server = serving.Server(folder, "log.ply", "model", words=words)
    server.octree(0)
    server.get("api/labels?file=0")
    for edit in EDITS:
        status, _, body = server.get("api/labels/" + edit, method="POST")
        if status != 200:
            raise SystemExit(f"attack: {edit}: {status} {body}")
    server.end()


def attack(options, folder, table):
    """Damages the journal and the octree of a folder in which a server has run."""
    words = ("--labels", "work")
    make_journal(folder, words)
    for kind, name, lies in (("journal", "work/log.ply.labels", own_files.journal_lies),
                             ("octree", "cache/log-*.octree", own_files.octree_lies)):
        for how, changed in (("flipped bytes", lambda data: flips(data, options.seed)),
                             ("lies", lambda data, of=lies: some(of(data), options.lies))):
            for outcome, what in damaged(folder, name, words, changed):
                table.add(f"server: {how} of the {kind}", outcome, what)
