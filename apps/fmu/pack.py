#!/usr/bin/env python3
"""Packs the FMU: a zip archive with the model description, the library, the resources, the licences, and what the
model was validated with.

The same files give the same bytes: entries have a fixed time and order.
"""
from __future__ import annotations

import argparse
import os
import pathlib
import subprocess
import tempfile
import zipfile

TIME = (2020, 1, 1, 0, 0, 0)
#: Where SSP Traceability looks for metadata of an FMU.
METADATA = "extra/org.ssp-standard.ssp-traceability.srmd/resourceMetaData.srmd"
#: What the library holds besides our own code, with the folder of its licence on Debian.
THIRD_PARTIES = ("libyaml-cpp-dev", "libprotozero-dev", "libeigen3-dev", "nlohmann-json3-dev", "libnanoflann-dev",
                 "libstdc++6")


def licences(own: pathlib.Path) -> dict[str, bytes]:
    """The licences by the name that they have in the archive; those that are not installed are left out."""
    found = {"documentation/licenses/underbrush.txt": own.read_bytes()}
    for name in THIRD_PARTIES:
        text = pathlib.Path("/usr/share/doc") / name / "copyright"
        if text.exists():
            found[f"documentation/licenses/{name}.txt"] = text.read_bytes()
    return found


def stripped(library: pathlib.Path, strip: str) -> bytes:
    """The library without symbols that nobody needs."""
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / library.name
        subprocess.run([strip, "--strip-unneeded", "-o", str(copy), str(library)], check=True)
        return copy.read_bytes()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("output", "library", "platform", "describe", "fmi", "resources", "licence", "strip", "report",
                 "metadata"):
        parser.add_argument(f"--{name}", required=True)
    a = parser.parse_args()
    description = subprocess.run([a.describe, a.fmi], check=True, capture_output=True).stdout
    entries = {"modelDescription.xml": description,
               f"binaries/{a.platform}/underbrush.so": stripped(pathlib.Path(a.library), a.strip)}
    resources = pathlib.Path(a.resources)
    for path in sorted(p for p in resources.rglob("*") if p.is_file()):
        entries[f"resources/{path.relative_to(resources)}"] = path.read_bytes()
    entries.update(licences(pathlib.Path(a.licence)))
    entries["documentation/index.html"] = pathlib.Path(a.report).read_bytes()
    entries[METADATA] = pathlib.Path(a.metadata).read_bytes()
    part = a.output + ".part"
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries.items():
            archive.writestr(zipfile.ZipInfo(name, TIME), data, zipfile.ZIP_DEFLATED)
    os.replace(part, a.output)


if __name__ == "__main__":
    main()
