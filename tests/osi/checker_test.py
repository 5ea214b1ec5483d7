#!/usr/bin/env python3
"""Holds the messages that the program and the FMU write against the rules of OSI, with the OSI Trace Checker of ASAM's
Quality Checker project (qc-osi-trace, MPL-2.0).

  checker_test.py --build build --program build/bin/underbrush

The checker is no package that pip finds by name: UNDERBRUSH_OSI_CHECKER names a folder with its sources, a clone of its
repository. Without it, or where pip cannot fetch what it needs, the exit status is 77.
"""
from __future__ import annotations

import argparse
import importlib
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
from xml.etree import ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/fmu"), str(ROOT / "python/tests")]

import environment  # noqa: E402
import osi_bytes  # noqa: E402

#: The checker asks each field for its label, which later versions of protobuf have no more.
PACKAGES = ["asam-qc-baselib", "iso3166", "osi-python", "protobuf<7", "pyyaml"]
ARGUMENTS = argparse.Namespace()
#: A car, a pedestrian and something else, by the columns of a list of true objects.
MOVERS = (("1,car", (4.6, 1.8, 1.5), 0.0), ("2,pedestrian", (0.6, 0.6, 1.8), 4.0), ("3,other", (1.0, 1.0, 1.0), -4.0))
SCANS = 8


def checker(build: pathlib.Path) -> dict[str, str]:
    """The Python that has the checker's packages, and the folder of its sources. Raises `environment.Missing`."""
    folder = os.environ.get("UNDERBRUSH_OSI_CHECKER", "")
    if not folder:
        raise environment.Missing("the OSI Trace Checker is absent: set UNDERBRUSH_OSI_CHECKER to a clone of qc-osi-trace")
    if not (pathlib.Path(folder) / "qc_ositrace").is_dir():
        sys.exit(f"{folder}: no clone of qc-osi-trace, which has a folder qc_ositrace")
    return {"python": str(environment.environment(build / "osi_venv", PACKAGES, compiled=False)), "sources": folder}


def log_of_a_drive(folder: pathlib.Path) -> None:
    """A log of a sensor that stands before three things that drive away, and the list of these."""
    rows, truth = ["x,y,z,ox,oy,oz,hit,time,intensity,ring,scan,packet"], ["time,id,class,x,y,z,yaw,length,width,height"]
    for scan in range(SCANS):
        near = 12 + 0.4 * scan
        for name, size, y in MOVERS:
            truth.append(f"{0.1 * scan:.2f},{name},{near + size[0] / 2:.3f},{y},{size[2] / 2},0,{size[0]},{size[1]},{size[2]}")
        for k in range(1000):
            azimuth, z = -0.45 + 0.0045 * (k // 5), 0.3 + 0.25 * (k % 5)
            y = near * math.tan(azimuth)
            hit = any(abs(y - at) < size[1] / 2 and z < size[2] for _, size, at in MOVERS)
            x = near if hit else 60
            rows.append(f"{x},{x * math.tan(azimuth):.4f},{z},0,0,1.7,{int(hit)},{0.1 * scan + 1e-5 * k:.5f},80,{k % 5},"
                        f"{scan},{k // 50}")
    (folder / "log.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "truth.csv").write_text("\n".join(truth) + "\n", encoding="utf-8")


class Rules(unittest.TestCase):
    """The rules of OSI."""
    folder: pathlib.Path
    _temporary: tempfile.TemporaryDirectory[str]

    @classmethod
    def setUpClass(cls) -> None:
        cls._temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls._temporary.name)
        log_of_a_drive(cls.folder)
        cls.run_program("import", "log.csv", "-o", "log.ply")
        cls.run_program("osi", "record", "log.ply", "--truth", "truth.csv", "-o", "views_sv_.osi")

    @classmethod
    def tearDownClass(cls) -> None:
        cls._temporary.cleanup()

    @classmethod
    def run_program(cls, *words: object) -> None:
        done = subprocess.run([ARGUMENTS.program, *map(str, words)], cwd=cls.folder, check=False, capture_output=True,
                              text=True)
        assert done.returncode == 0, (words, done.stderr)

    def findings(self, name: str) -> set[str]:
        """What the checker finds in a trace, each once: without the numbers of messages and of values."""
        kind = {"sv": "SensorView", "sd": "SensorData", "gt": "GroundTruth"}[name.rpartition("_")[0][-2:]]
        result = self.folder / (name + ".xqar")
        done = subprocess.run([ARGUMENTS.python, "-m", "qc_ositrace", "-d", "-i", name, "--osiType", kind, "-r", result],
                              cwd=self.folder, env=dict(os.environ, PYTHONPATH=ARGUMENTS.sources), check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        issues = ElementTree.parse(result).getroot().iterfind(".//Issue")
        return {re.sub(r"\d+(\.\d+)?", "N", issue.get("description", "").partition(": ")[2]) for issue in issues}

    def assert_keeps_the_rules(self, *names: str) -> None:
        for name in names:
            self.assertEqual(self.findings(name), set(), name)

    def test_the_checker_finds_what_is_wrong(self) -> None:
        data = osi_bytes.frames((self.folder / "views_sv_.osi").read_bytes())[-1]
        wrong = data + osi_bytes.stamp(2, 10**9) + osi_bytes.part(2, osi_bytes.number(2, 10**9))
        (self.folder / "wrong_sv_.osi").write_bytes(struct.pack("<I", len(wrong)) + wrong)
        self.assertTrue(any("nanos" in line for line in self.findings("wrong_sv_.osi")))

    def test_views_of_a_log(self) -> None:
        self.assert_keeps_the_rules("views_sv_.osi")

    def test_all_strategies_together_and_apart(self) -> None:
        apart = (("front_end", "views_sv_.osi"), ("alignment", "front_end_sd_.osi"),
                 ("tracking:axle_height_m=1.7", "alignment_sd_.osi"), ("classification:from=points", "tracking_sd_.osi"),
                 ("grid", "classification_sd_.osi"))
        for strategy, source in apart:
            name = f"{strategy.partition(':')[0]}_sd_.osi"
            self.run_program("osi", "replay", source, "--strategy", strategy, "-o", name)
            self.assert_keeps_the_rules(name)
        self.run_program("osi", "replay", "views_sv_.osi", "-o", "all_sd_.osi")
        self.run_program("osi", "replay", "views_sv_.osi", "--sensor", "ibeo-lux-2010", "--strategy",
                         "tracer:columns=1,rows=1,z_m=-1.2", "--strategy", "front_end:columns=1,rows=1", "--without-view",
                         "-o", "traced_sd_.osi")
        self.assert_keeps_the_rules("all_sd_.osi", "traced_sd_.osi")

    def test_lists_of_objects(self) -> None:
        for pipeline in ("model", "real"):
            self.run_program("perceive", "log.ply", "--truth", "truth.csv", "--pipeline", pipeline, "-o",
                             f"{pipeline}_sd_.osi")
            self.assert_keeps_the_rules(f"{pipeline}_sd_.osi")

    def test_traces_of_others_get_no_worse(self) -> None:
        """What their own messages lack, of which the output has a copy, is none of ours."""
        folder = ARGUMENTS.data / "osi"
        traces = sorted(folder.glob("*.osi")) if folder.is_dir() else []
        if not traces:
            self.skipTest("real data 'osi' absent: set UNDERBRUSH_DATA")
        views = [osi_bytes.frames(path.read_bytes())[:SCANS] for path in traces]
        truths = [[osi_bytes.parts(view, 7)[0] for view in trace] for trace in views]
        for kind, messages in [*(("sv", trace) for trace in views), *(("gt", trace) for trace in truths)]:
            source = f"other_{kind}_.osi"
            (self.folder / source).write_bytes(b"".join(struct.pack("<I", len(m)) + m for m in messages))
            self.run_program("osi", "replay", source, "--strategy", "tracer:columns=1,rows=1,z_m=0.3", "--strategy",
                             "front_end:columns=1,rows=1", "--strategy", "alignment", "--strategy", "tracking", "--strategy",
                             "classification:from=points", "-o", "other_sd_.osi")
            self.assertEqual(self.findings("other_sd_.osi") - self.findings(source), set())

    def test_the_fmu(self) -> None:
        if not ARGUMENTS.fmu.exists():
            self.skipTest(f"no {ARGUMENTS.fmu.name}")
        cases, fmu = importlib.import_module("cases"), importlib.import_module("fmu")
        (self.folder / "tiny.yaml").write_text(cases.SENSOR, encoding="utf-8")
        one = fmu.Instance(fmu.Archive(str(ARGUMENTS.fmu), self.folder / "fmu"), {
            "profile": str(self.folder / "tiny.yaml"), "trace_output_path": str(self.folder / "fmu_sd_.osi")})
        inputs = [cases.drive(k) + osi_bytes.part(4, osi_bytes.vector(1, 0, 0, 0)) for k in range(SCANS)]
        self.assertGreater(sum(len(cases.objects(one.step(view))) for view in inputs), SCANS)
        one.free()
        self.assert_keeps_the_rules("fmu_sd_.osi")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--program", required=True, type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path,
                        default=pathlib.Path(os.environ.get("UNDERBRUSH_DATA") or ROOT.parent / "shared/data"))
    rest = parser.parse_known_args(namespace=ARGUMENTS)[1]
    try:
        found = checker(ARGUMENTS.build.resolve())
    except environment.Missing as missing:
        print(f"skipped: {missing}")
        sys.exit(77)
    vars(ARGUMENTS).update(found, program=ARGUMENTS.program.resolve(),
                           fmu=ARGUMENTS.build.resolve() / "underbrush.fmu")
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
