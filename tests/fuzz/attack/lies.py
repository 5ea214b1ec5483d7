"""Lies in the fields of what the program reads: every number of a file's own structure, one at a time, and bombs."""
import collections
import concurrent.futures
import dataclasses
import gzip
import pathlib
import shutil
import struct
import subprocess
import tempfile
import types

import bombs
import fields
import jobs  # noqa: F401  (finds the modules of tests/fuzz)
import kinds
import mutate
import own_files
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
        "glb": glb, "tiff": tiff, "rows": own_files.ply_lies, "compact": own_files.compact_lies,
        "gzip": own_files.gzip_lies, "words": words32, "sums": own_files.words64}
OF_KIND = {"import.pcd-compressed": compressed_pcd, "import.npy": npy, "import.npz": npz, "simulate.stl": stl,
           "osi.views": fields.osi_lies, "osi.replay": fields.osi_lies, "osi.data": fields.osi_lies,
           "import.bin": words32, "import.kitti-scan": words32, "import.labels": words32, "segment.label-file": words32,
           "meshes.gltf-buffer": words32, "info.compact": words32, "split.compact": words32}
FIT = "log.ply -o out --ground-spacing 2 --rounds 1"
UPDATE = "fit more.ply --update remembering -o out"
SUM, END = f"fit {FIT} --stage sum:0:320 --from start", f"fit {FIT} --stage end --from start --from start --from sums.bin"
MORE = (
    Kind("simulate.space", "header", "model/observed_space.ply", "simulate model --like log.ply -o out.ply"),
    Kind("info.geotiff", "tiff", "height.tif", "info terrain.xml", others=("terrain.xml",)),
    Kind("import.gzip", "gzip", "log.csv.gz", "import log.csv.gz -o out.ply"),
    Kind("import.gzip-scan", "gzip", "packed/000001.pcd.gz", "import packed -o out.ply"),
    *(Kind(f"fit.update-{name}", "header", f"remembering/training/{name}.ply", UPDATE, others=("more.ply",))
      for name in ("tiles", "ground", "residuals")),
    Kind("fit.update-training", "json", "remembering/training/training.json", UPDATE,
         others=("more.ply", "seen.ply")),
    Kind("fit.stage-held-out", "words", "start/held_out.bin", END, others=("log.ply", "sums.bin")),
    Kind("fit.stage-open", "words", "start/open.bin", END, others=("log.ply", "sums.bin")),
    Kind("fit.stage-sums", "sums", "sums.bin", END, others=("start", "log.ply")),
    Kind("fit.stage-report", "json", "start/start.json", END, others=("log.ply", "sums.bin")),
    Kind("fit.stage-refinement", "json", "start/refinement.json", END, others=("log.ply", "sums.bin")),
    Kind("fit.sum-refinement", "json", "start/refinement.json", SUM, others=("log.ply",)),
    Kind("fit.sum-ellipsoids", "header", "start/model/ellipsoids.ply", SUM, others=("log.ply",)),
    Kind("plan.record", "json", "plan/records/0.json", "plan --status plan"),
)
#: Binary PLY files whose rows lie, too, and compact logs.
ROWS = ("info.log", "fit.log", "simulate.like", "split.echoes", "import.ray-cloud", "extract.labelled", "simulate.ground",
        "simulate.ellipsoids", "simulate.surface", "simulate.space", "simulate.keyframes", "fit.update-keyframes",
        "fit.update-tiles", "fit.update-ground", "fit.update-residuals", "fit.sum-ellipsoids", "simulate.instances",
        "simulate.world-instances", "rasters.world-numbers", "compose.ground", "compose.site-ground",
        "compose.primitive-ellipsoids", "meshes.ply-binary")
COMPACT = ("info.compact", "fit.compact", "split.compact")
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


def all_kinds():
    """The kinds of the mutants and more, and those whose rows lie under names of their own."""
    plain = (*kinds.KINDS, *MORE)
    named = {kind.name: kind for kind in plain}
    yield from plain
    yield from (dataclasses.replace(named[name], name=name + "-rows", form="rows") for name in ROWS)
    yield from (dataclasses.replace(named[name], name=name + "-fields", form="compact") for name in COMPACT)


def make_more(inputs, program):
    """Writes the further inputs: maps, packed files, the stages of a fit, and what a task of a plan has done."""
    for command in ("rasters model -o maps", f"fit {FIT} --stage begin".replace("-o out", "-o start"),
                    SUM.replace("-o out", "-o sums.bin"), "run plan --task 0"):
        subprocess.run([program, *command.split()], cwd=inputs, check=True, capture_output=True)
    shutil.copytree(inputs / "folder", inputs / "packed")
    for name in ("log.csv", "packed/000001.pcd"):
        (inputs / (name + ".gz")).write_bytes(gzip.compress((inputs / name).read_bytes(), mtime=0))
    (inputs / "packed/000001.pcd").unlink()
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
        for kind in all_kinds():
            n = len(lies_of(kind, pathlib.Path(options.inputs, kind.file).read_bytes(), options.lies))
            tries += [(kind, slice(at, at + CHUNK)) for at in range(0, n, CHUNK)]
        with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
            for kind, counts, failures in pool.map(try_lies, *zip(*((k, given, c) for k, c in tries))):
                for outcome, count in counts.items():
                    table.add("lies: " + kind.name.split(".")[0], outcome, count=count)
                for number, what in failures:
                    table.add("lies: " + kind.name.split(".")[0], what, f"{kind.name} {number}")
