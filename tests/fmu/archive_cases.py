"""What the archives hold: metadata, the report, and the licences of all that is linked."""
from __future__ import annotations

import pathlib
import re
import shutil
import subprocess
import unittest
import zipfile
from xml.etree import ElementTree

from cases import ARGUMENTS

METADATA = "extra/org.ssp-standard.ssp-traceability.srmd/resourceMetaData.srmd"
ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/explanation/validation.md"
#: The package that a static library or a folder of headers belongs to, "" for glibc and the compiler's own.
PACKAGES = {"libyaml-cpp.a": "libyaml-cpp-dev", "libstdc++.a": "libstdc++6", "libgcc.a": "libstdc++6",
            "libgcc_eh.a": "libstdc++6", "yaml-cpp": "libyaml-cpp-dev", "eigen3": "libeigen3-dev",
            "protozero": "libprotozero-dev", "nlohmann": "nlohmann-json3-dev", "nanoflann.hpp": "libnanoflann-dev",
            "c++": "libstdc++6", "x86_64-linux-gnu": "", "linux": "", "asm-generic": ""}
#: Licences that a library under Apache-2.0 may hold, as Debian names them.
PERMISSIVE = {"Expat", "X11", "BSD-2-Clause", "BSD-3-Clause", "Apache-2.0", "MPL-2"}


def linked(platform: str) -> list[tuple[str, str]]:
    """The members of archives that the linker took, as its map lists them. Empty if the map is absent."""
    path = pathlib.Path(ARGUMENTS.fmu).resolve().parent / f"apps/fmu/{platform}.map"
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8").split("\n\n")[1]
    return re.findall(r"^(\S+\.a)\((\S+)\)$", text, re.M)


class Contents(unittest.TestCase):
    """The entries of both archives."""

    def test_metadata_and_report(self) -> None:
        effects = re.findall(r"^\| ([^|]+?) \|", PAGE.read_text(encoding="utf-8").split("<!-- results: validated -->")[1]
                             .split("\n\n")[1], re.M)[2:]
        self.assertGreater(len(effects), 8)
        for fmu in (ARGUMENTS.fmu, ARGUMENTS.fmi3):
            with zipfile.ZipFile(fmu) as archive:
                root = ElementTree.fromstring(archive.read(METADATA))
                report = archive.read("documentation/index.html").decode()
            self.assertTrue(root.tag.endswith("}SimulationResourceMetaData"))
            self.assertEqual({"version", "name"} - set(root.attrib), set())
            found = {entry.get("keyword"): entry.text for entry in root.iterfind(".//{*}ClassificationEntry")}
            self.assertEqual(found["claims that do not hold"], "0")
            self.assertGreater(int(found["claims checked"] or 0), 50)
            for effect in effects:
                self.assertIn(f"<h2>{effect}</h2>", report)
                for key in ("compared with", "error", "interval", "not modelled"):
                    self.assertTrue(found[f"{effect}.{key}"], effect)
            self.assertRegex(report, r"version \d+\.\d+\.\d+")
            self.assertIn("Intervals are those of the mean", report)
            # The table of the README comes first: the configuration of the first effect is the README's.
            self.assertLess(report.index("How close the simulation comes"), report.index("<h2>", report.index("<h2>") + 1))
            self.assertIn("Range of validity", report)
            self.assertNotIn('class="broken"', report)

    def test_the_example_of_ssp_connects_variables_of_the_fmu(self) -> None:
        with zipfile.ZipFile(ARGUMENTS.fmu) as archive:
            model = ElementTree.fromstring(archive.read("modelDescription.xml"))
        causality = {v.get("name"): v.get("causality") for v in model.iterfind(".//ScalarVariable")}
        system = ElementTree.parse(ROOT / "share/examples/SystemStructure.ssd").getroot().find("{*}System")
        assert system is not None
        kinds = {("", c.get("name")): c.get("kind") for c in system.iterfind("{*}Connectors/{*}Connector")}
        for component in system.iterfind("{*}Elements/{*}Component"):
            self.assertEqual(component.get("source"), "resources/underbrush.fmu")
            for c in component.iterfind("{*}Connectors/{*}Connector"):
                self.assertEqual(c.get("kind"), causality[c.get("name")], c.get("name"))
                kinds[component.get("name", ""), c.get("name")] = c.get("kind")
            for p in component.iterfind(".//{*}Parameter"):
                self.assertEqual(causality[p.get("name")], "parameter")
        wires = [tuple((w.get(f"{end}Element", ""), w.get(f"{end}Connector")) for end in ("start", "end"))
                 for w in system.iterfind("{*}Connections/{*}Connection")]
        # A value comes from an input of the system or an output of a component, and each connector has a wire.
        for start, end in wires:
            self.assertEqual(kinds[start], "output" if start[0] else "input", start)
            self.assertEqual(kinds[end], "input" if end[0] else "output", end)
        self.assertEqual({place for wire in wires for place in wire}, set(kinds))

    def test_same_resources(self) -> None:
        names = []
        for fmu in (ARGUMENTS.fmu, ARGUMENTS.fmi3):
            with zipfile.ZipFile(fmu) as archive:
                self.assertIsNone(archive.testzip())
                names.append({n for n in archive.namelist() if not n.startswith("binaries/")})
        self.assertEqual(*names)


class Licences(unittest.TestCase):
    """Everything that the libraries hold is permissive and has its licence in the archive."""

    def packages(self) -> set[str]:
        """The packages of the static libraries, and of the headers of our own objects."""
        build = pathlib.Path(ARGUMENTS.fmu).resolve().parent
        if not linked("linux64") or not shutil.which("ninja"):
            self.skipTest("needs the linker's map and ninja")
        members = {member for platform in ("linux64", "x86_64-linux") for member in linked(platform)}
        names = {pathlib.Path(archive).name for archive, _ in members if archive.startswith("/")}
        objects = [f"{pathlib.Path(archive).parent}/CMakeFiles/{pathlib.Path(archive).stem[3:]}.dir/Unity/{member}"
                   for archive, member in members if not archive.startswith("/") and member.startswith("unity")]
        self.assertGreater(len(objects), 5)
        deps = subprocess.run(["ninja", "-C", str(build), "-t", "deps", *objects], check=True, capture_output=True,
                              text=True).stdout
        headers = re.findall(r"^ +/usr/include/(\S+)$", deps, re.M)
        self.assertGreater(len(headers), 100)
        for header in headers:
            first = header.split("/")[0]
            if "/" in header or first.endswith(".hpp"):
                names.add(first)
        self.assertLessEqual(names, set(PACKAGES), "linked, but with no licence known")
        return {PACKAGES[name] for name in names} - {""}

    def test_licences(self) -> None:
        packages = self.packages()
        for fmu in (ARGUMENTS.fmu, ARGUMENTS.fmi3):
            with zipfile.ZipFile(fmu) as archive:
                texts = {pathlib.PurePath(n).stem: archive.read(n).decode() for n in archive.namelist()
                         if n.startswith("documentation/licenses/")}
            self.assertIn("Apache License", texts["underbrush"])
            self.assertLessEqual(packages, set(texts))
        for package in packages - {"libstdc++6"}:
            # The stanza of all files; others are of tests and of Debian's own.
            found = re.findall(r"^Files: \*$.*?^License: *([^\n]*)$", texts[package], re.M | re.S)
            self.assertLessEqual(set(found[0].split(" and ")), PERMISSIVE, package)
        self.assertIn("GCC RUNTIME LIBRARY EXCEPTION", texts["libstdc++6"].upper())
