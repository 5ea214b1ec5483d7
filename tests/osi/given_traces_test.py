#!/usr/bin/env python3
"""Replays traces of esmini, which hold its ground truth alone, and compares the objects with that truth.

  given_traces_test.py --program build/bin/underbrush

The traces are those of `osi` in the folder UNDERBRUSH_DATA. Without them the exit status is 77.
"""
from __future__ import annotations

import json
import lzma
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
TRACE = (pathlib.Path(os.environ.get("UNDERBRUSH_DATA") or ROOT.parent / "shared/data") / "osi" /
         "esmini_gt_380_32112_441_cut-in.osi.xz")
#: A car overtakes: it is 10 to 27 m before the host in messages 120 to 250, and behind it from 270 on.
AHEAD, BEHIND = range(120, 180), range(275, 285)
RAYS = ("--strategy", "tracer:columns=1,rows=1,{}", "--strategy", "front_end:columns=1,rows=1", "--strategy", "alignment",
        "--strategy", "tracking")


def frames(data: bytes) -> list[bytes]:
    out, at = [], 0
    while at < len(data):
        (size,) = struct.unpack_from("<I", data, at)
        out.append(data[at:at + 4 + size])
        at += 4 + size
    return out


class GivenTraces(unittest.TestCase):
    """A trace `_gt_`."""

    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.messages = frames(lzma.decompress(TRACE.read_bytes()))

    def call(self, *words: str) -> dict:
        done = subprocess.run([PROGRAM, "osi", *words, "--json", "-"], cwd=self.folder, check=False, capture_output=True,
                              text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return json.loads(done.stdout)

    def replay(self, which: range, *words: str) -> tuple[dict, list, list]:
        """What the program says of the first message, which alone names the host, and of these, and the lists of true objects and of those it finds."""
        (self.folder / "part_gt_.osi").write_bytes(b"".join(self.messages[k] for k in (0, *which)))
        self.call("convert", "part_gt_.osi", "-o", "true.json", "--force")
        said = self.call("replay", "part_gt_.osi", *words, "-o", "found.json", "--force")
        true, found = (json.loads((self.folder / name).read_text())["lists"] for name in ("true.json", "found.json"))
        self.assertEqual((len(true), len(found)), (1 + len(which), 1 + len(which)))
        return said, true[1:], found[1:]

    def test_the_car_ahead_is_found_at_its_place(self) -> None:
        said, true, found = self.replay(AHEAD, *(word.format("z_m=0.3") for word in RAYS))
        self.assertNotIn("warnings", said)
        near = [len(b["objects"]) == 1 and math.dist(*((o["x"], o["y"]) for o in (a["objects"][0], b["objects"][0]))) < 0.7
                for a, b in zip(true[10:], found[10:])]
        self.assertGreater(sum(near), 0.95 * len(near))

    def test_without_a_chain_the_car_is_found(self) -> None:
        said, _, found = self.replay(range(150, 156))
        self.assertNotIn("warnings", said)
        self.assertEqual(len(found[-1]["objects"]), 1)

    def test_no_object_has_its_cause(self) -> None:
        said, _, found = self.replay(BEHIND, *(word.format("z_m=0.3") for word in RAYS))
        self.assertEqual(sum(len(one["objects"]) for one in found), 0)
        self.assertRegex(said["warnings"][0], r"^no object was found in \d+ echoes, and the ground truth has 11 others than "
                         "the host: .*range or view")
        self.assertEqual(len(said["warnings"]), 1)

    def test_no_reflection_has_its_cause(self) -> None:
        said = self.replay(BEHIND, *(word.format("z_m=500,ground=false") for word in RAYS))[0]
        self.assertRegex(said["warnings"][0], r"^no reflection came back of [1-9]\d* rays, and the ground truth has 11 ")


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv[sys.argv.index("--program") + 1]).resolve())
    if not TRACE.exists():
        print(f"skipped: real data 'osi/{TRACE.name}' absent: set UNDERBRUSH_DATA")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0]])
