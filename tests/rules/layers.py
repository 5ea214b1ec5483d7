#!/usr/bin/env python3
"""Checks the layers: a module includes what its CMakeLists.txt declares, each large third party is used only in its
module's sources, and the library neither prints nor exits."""
import re

import rules

LIBRARY = "src/underbrush/"
# Third parties and where they may be included. Headers of the library include only Eigen.
THIRD_PARTY = {
    "embree": ("trace",), "tbb": ("core",), "oneapi": ("core",), "png": ("io",),
    "nanoflann": None, "libqhull": None, "nlohmann": None, "yaml-cpp": None, "zlib": None,
    "zstd": None, "lz4": None, "pcap": None, "nlopt": ("optimize",), "tiny_gltf": ("io",),
    "fmt": (), "CLI": (), "spdlog": (),
}
FORBIDDEN = (
    r"#\s*include\s*<(?P<header>iostream|syncstream)>|\b(?:std::)?(?P<call>printf|puts|putchar|fprintf|"
    r"fputs|perror|exit|_Exit|quick_exit|abort|terminate)\s*\(|\bstd::(?P<stream>cout|cerr|clog)\b")


def declared(root):
    """{module: modules it DEPENDS on}, from the CMakeLists.txt of each."""
    found = {}
    for path in rules.tracked(root, "CMakeLists.txt"):
        m = re.search(r"underbrush_module\((\w+)([^)]*)\)", rules.read(root, path))
        if path.startswith(LIBRARY) and m:
            words = re.search(r"\bDEPENDS\b((?:\s+[a-z]+)*)", m.group(2))
            found[m.group(1)] = set(words.group(1).split()) if words else set()
    return found


def check(root):
    out = []
    depends = declared(root)
    for path in rules.tracked(root, ".hpp", ".cpp", ".inl", ".in"):
        if not path.startswith((LIBRARY, "apps/", "bindings/")):
            continue
        code, _ = rules.split_cpp(rules.read(root, path))
        mine = path[len(LIBRARY):].split("/")[0] if path.startswith(LIBRARY) else None
        for line, m in rules.lines_with(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', code):
            name = m.group(1)
            at = f"{path}:{line}: "
            if mine is None:
                if name.lstrip("/").startswith("embree"):
                    out.append(at + "Embree belongs to trace alone")
                continue
            top, _, rest = name.partition("/")
            if top == "underbrush":
                other = rest.split("/")[0]
                if other != mine and other not in depends.get(mine, ()):
                    out.append(at + f"'{mine}' includes '{other}' but does not DEPEND on it")
            for party, modules in THIRD_PARTY.items():
                if not name.startswith(party):
                    continue
                if modules is not None and mine not in modules:
                    out.append(at + f"<{name}> does not belong in '{mine}'")
                elif path.endswith(".hpp"):
                    out.append(at + f"<{name}> in a header: keep a third party in a .cpp")
        if mine is not None:
            for line, m in rules.lines_with(FORBIDDEN, code):
                what = m.group("header") or m.group("call") or m.group("stream")
                out.append(f"{path}:{line}: {what} in the library, which never prints or exits")
    return out


def module(name, source, depends=""):
    return {f"{LIBRARY}{name}/CMakeLists.txt": f"underbrush_module({name}\n  SOURCES a.cpp\n{depends})",
            f"{LIBRARY}{name}/a.cpp": source}


BAD = [
    (module("trace", '#include "underbrush/core/pose.hpp"\n', "  DEPENDS elements\n"), "DEPEND"),
    (module("trace", '#include "underbrush/fit/cluster.hpp"\n', "  DEPENDS core"), "'fit'"),
    (module("fit", "#include <embree3/rtcore.h>\n"), "embree3"),
    (module("metrics", "#include <iostream>\n"), "iostream"),
    (module("metrics", 'void f() { std::printf("hello"); }\n'), "printf"),
    (module("metrics", "void f() { exit(1); }\n"), "exit"),
    ({f"{LIBRARY}io/a.hpp": "#include <nlohmann/json.hpp>\n"}, "in a header"),
    ({"apps/underbrush/a.cpp": "#include <embree3/rtcore.h>\n"}, "Embree"),
]
GOOD = {**module("core", '#include <tbb/tbb.h>\n// printf( is a word here\nauto s = "exit(";\n'),
        **module("trace", '#include "underbrush/core/pose.hpp"\n#include <embree3/rtcore.h>\n'
                 'void f(char* s) { std::snprintf(s, 1, "x"); }\n', "  DEPENDS core\n  LINK embree")}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
