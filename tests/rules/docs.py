#!/usr/bin/env python3
"""Checks the library's reference: every namespace, type and free function of the public headers is documented,
and Doxygen has no other complaint. Fields and members may be undocumented. --html FOLDER writes the
reference instead."""
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import rules

MAY_SPEAK_FOR_ITSELF = re.compile(
    r"Member .* \((?:variable|enumvalue|typedef)\) of .* is not documented"
    r"|Compound \S*::[A-Z]\w*::\w+ is not documented"  # a type within a type
    r"|Member .* \((?:function|friend|enumeration)\) of (?:class|struct) .* is not documented")


def arguments(parser):
    parser.add_argument("--html", type=pathlib.Path, help="write the reference to this folder")


def doxygen(root, settings):
    doxyfile = (rules.ROOT / "docs/Doxyfile").read_text() + settings
    return subprocess.run(["doxygen", "-"], input=doxyfile, cwd=root, text=True, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


def undocumented_namespaces(xml):
    """Lists undocumented namespaces, about which Doxygen is silent though it omits their free functions."""
    out = []
    for path in sorted(xml.glob("namespace*.xml")):
        namespace = ElementTree.parse(path).find("compounddef")
        texts = [namespace.find("briefdescription"), namespace.find("detaileddescription")]
        if not any("".join(text.itertext()).strip() for text in texts):
            place = namespace.find("location")
            out.append(f"{place.get('file')}:{place.get('line')}: namespace "
                       f"{namespace.findtext('compoundname')} is not documented")
    return out


def check(root, options):
    with tempfile.TemporaryDirectory() as folder:
        done = doxygen(root, f"GENERATE_HTML = NO\nGENERATE_XML = YES\nOUTPUT_DIRECTORY = {folder}\n")
        silent = undocumented_namespaces(pathlib.Path(folder, "xml"))
    lines = [line for line in done.stdout.splitlines() if line.strip()]
    out = [line for line in lines if not MAY_SPEAK_FOR_ITSELF.search(line)]
    return out + silent + ([f"doxygen: exit status {done.returncode}"] if done.returncode else [])


def header(text):
    return {"src/underbrush/core/a.hpp": text}


START = "/// \\file\n/// A file.\n#pragma once\n/// The project.\nnamespace underbrush {\n"
BAD = [
    (header(START + "void f(int);\n}\n"), "f("),
    (header(START + "struct S { int a; };\n}\n"), "S is not documented"),
    (header(START + "/// Takes \\p a. \\param b is no parameter.\nvoid f(int a);\n}\n"), "argument 'b'"),
    (header(START + "/// Like \\ref nobody.\nvoid f(int a);\n}\n"), "nobody"),
    (header("/// \\file\n/// A file.\nnamespace other {\n/// Has a text.\nvoid f();\n}\n"), "namespace other"),
]
GOOD = header(START + "/// Adds.\nint f(int a);\n/// A value.\nstruct S { int a; int get() const; };\n}\n")

if __name__ == "__main__":
    if "--html" in sys.argv:
        target = pathlib.Path(sys.argv[sys.argv.index("--html") + 1]).resolve()
        target.mkdir(parents=True, exist_ok=True)
        run = doxygen(rules.ROOT, f"OUTPUT_DIRECTORY = {target}\nGENERATE_HTML = YES\nWARNINGS = NO\n")
        sys.stdout.write(run.stdout)
        sys.exit(run.returncode)
    rules.main(check, BAD, GOOD, arguments)
