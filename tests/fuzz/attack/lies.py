"""Lies in the fields of what the program reads: every number of a file's own structure, one at a time, and bombs."""
import collections
import concurrent.futures
import pathlib
import struct
import subprocess
import tempfile
import types

import bombs
import fields
import jobs  # noqa: F401  (finds the modules of tests/fuzz)
import kinds
import mutate
import processes
from bounded import ANSWER, REFUSAL
from kinds import Kind

CHUNK = 100  # lies that a process tries


def glb(data):
    json_at, size = 12, fields.get(data, 12, 4)
    yield from fields.binary_lies(data, [(4, 4), (8, 4), (json_at, 4), (16, 4), (20 + size, 4), (24 + size, 4)])
    for lie in fields.json_lies(data[20:20 + size]):
        lie += b" " * (-len(lie) % 4)
        rest = data[20 + size:]
        yield data[:8] + struct.pack("<II", 20 + len(lie) + len(rest), len(lie)) + data[16:20] + lie + rest


def compressed_pcd(data):
    yield from fields.text_lies(data)
    at = data.index(b"binary_compressed\n") + 18
    yield from fields.binary_lies(data, [(at, 4), (at + 4, 4), *((at + 8 + k, 1) for k in range(40))])


def npy(data):
    yield from fields.binary_lies(data, [(6, 1), (7, 1), (8, 2)])
    end = data.index(b"}") + 1
    for lie in fields.text_lies(data[10:end].replace(b"<", b" ")):
        yield data[:8] + struct.pack("<H", len(lie) + 1) + lie + b"\n" + data[end + 1:]


def npz(data):
    yield from fields.binary_lies(data, fields.zip_fields(data))


def tiff(data):
    yield from fields.binary_lies(data, fields.tiff_fields(data))


def stl(data):
    yield from fields.binary_lies(data, [(80, 4)])


def words32(data):
    """A file of numbers of four bytes, without fields of its own."""
    yield from fields.binary_lies(data, [(at, 4) for at in range(0, min(len(data), 80), 4)])
    yield from (data[:size] for size in range(0, min(len(data), 40)))


LIES = {"header": fields.text_lies, "text": fields.text_lies, "yaml": fields.text_lies, "json": fields.json_lies,
        "glb": glb}
OF_KIND = {"import.pcd-compressed": compressed_pcd, "import.npy": npy, "import.npz": npz, "simulate.stl": stl,
           "osi.views": fields.osi_lies, "osi.replay": fields.osi_lies, "osi.data": fields.osi_lies,
           "import.bin": words32, "import.kitti-scan": words32, "import.labels": words32, "segment.label-file": words32,
           "meshes.gltf-buffer": words32, "info.compact": words32, "split.compact": words32}
MORE = (
    Kind("simulate.space", "header", "model/observed_space.ply", "simulate model --like log.ply -o out.ply"),
    Kind("info.geotiff", "tiff", "height.tif", "info terrain.xml", others=("terrain.xml",)),
)
LIES["tiff"] = tiff
TERRAIN = """<?xml version="1.0"?>
<document><scene id="s" name="S"><part id="1"><filter type="geotiffloader">
<param type="string" key="filepath" value="height.tif"/></filter></part></scene></document>
"""


class Liar(mutate.Scratch):
    """A folder in which one file is replaced by lies."""
    def put(self, number, lies):
        self.path.write_bytes(lies[number])


def lies_of(kind, seed, most):
    """At most so many of the lies, spread evenly."""
    lies = list(dict.fromkeys(OF_KIND.get(kind.name, LIES.get(kind.form, lambda data: ()))(seed)))
    return lies[::max(1, -(-len(lies) // most))]


def try_lies(kind, options, chosen):
    """Tries some lies of a kind. Returns counts and failures."""
    counts, failures = collections.Counter(), []
    mutate.limit_resources()
    with tempfile.TemporaryDirectory(dir=options.scratch) as folder:
        liar = Liar(kind, options, folder)
        lies = lies_of(kind, liar.seed, options.most)
        for number in range(len(lies))[chosen]:
            code, reasons, err = liar.try_mutant(number, lies)
            if reasons:
                failures.append((number, "; ".join(reasons) + " " + repr(err[:300])))
            else:
                counts[ANSWER if code == 0 else REFUSAL] += 1
        liar.process.close()
    return kind, counts, failures


def make_more(inputs, program):
    subprocess.run([program, "rasters", "model", "-o", "maps"], cwd=inputs, check=True, capture_output=True)
    (inputs / "height.tif").write_bytes((inputs / "maps/ground.tif").read_bytes())
    (inputs / "terrain.xml").write_text(TERRAIN)
    kinds.NEEDS["terrain.xml"] = ["height.tif"]


def attack(options, table):
    """Tries every lie in every kind of file that has fields of its own, and the bombs."""
    make_more(options.inputs, options.program)
    bombs.attack(options, table)
    with tempfile.TemporaryDirectory(dir=options.scratch) as folder:
        given = types.SimpleNamespace(program=str(options.program), seeds=str(options.inputs), scratch=folder, most=options.lies,
                                      server=processes.build_server(folder))
        tries = []
        for kind in (*kinds.KINDS, *MORE):
            n = len(lies_of(kind, pathlib.Path(options.inputs, kind.file).read_bytes(), options.lies))
            tries += [(kind, slice(at, at + CHUNK)) for at in range(0, n, CHUNK)]
        with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
            for kind, counts, failures in pool.map(try_lies, *zip(*((k, given, c) for k, c in tries))):
                for outcome, count in counts.items():
                    table.add("lies: " + kind.name.split(".")[0], outcome, count=count)
                for number, what in failures:
                    table.add("lies: " + kind.name.split(".")[0], what, f"{kind.name} {number}")
