#!/usr/bin/env python3
"""Checks the layers: a module includes what its CMakeLists.txt declares, no less and no more; each large third party is
used only in its module's sources; the library neither prints nor exits; each folder above the library uses only the
folders below it; units do not include each other in a circle. A source with compiler options of its own skips the
precompiled header, which would undo them in functions with a target attribute."""
import posixpath
import re

import rules

LIBRARY = "src/underbrush/"
# Third parties and where they may be included. Headers of the library include only Eigen.
THIRD_PARTY = {
    "embree": (), "tbb": ("core",), "oneapi": ("core",), "png": ("io",),
    "nanoflann": None, "libqhull": None, "nlohmann": None, "yaml-cpp": None, "zlib": None,
    "zstd": ("compact",), "lz4": None, "lzf": ("io",), "pcap": None, "nlopt": ("optimize",), "tiny_gltf": ("io",),
    "protozero": ("osi",), "fmt": (), "CLI": (), "spdlog": (), "xxhash": ("compact", "io"),
}
# The target that stands for each third party in the CMake lists.
TARGETS = {
    "nanoflann": "nanoflann::nanoflann", "nlohmann": "nlohmann_json::nlohmann_json", "png": "PNG::PNG",
    "yaml-cpp": "yaml-cpp", "lzf": "PkgConfig::LZF", "tiny_gltf": "TinyGLTF::TinyGLTF", "tbb": "TBB::tbb",
    "oneapi": "TBB::tbb", "nlopt": "NLopt::nlopt", "fmt": "fmt::fmt", "CLI": "CLI11::CLI11",
    "embree": "embree", "zstd": "PkgConfig::ZSTD", "xxhash": "PkgConfig::XXHASH",
}
# The folders above the library, and which of them each may include beside itself and the library.
ABOVE = {"report": (), "cli": (), "apps/underbrush": ("report", "cli"),
         "studies": ("report", "cli"), "bench": ("report", "apps/underbrush", "studies"),
         "apps/fmu": (),
         "python": ("report", "cli", "apps/underbrush")}
OWN_TARGETS = {"underbrush_report": "report", "underbrush_cli": "cli",
               "underbrush_app": "apps/underbrush", "underbrush_studies": "studies"}


def tests_of(*names):
    return {f"tests/{name}": "tests of modules below `pipeline`" for name in names}


# What answers beams and what makes models: the headers, the names in code that reaches them by other headers, and who
# may use them. The answer and the model that a user gets are made in `pipeline`, which everybody else calls.
PIPELINE = {"src/underbrush/pipeline/": "what users get is made here"}
INNER_PARTS = [
    ("beams are answered", r"underbrush/simulate/(?!footprint|element_class|reflection|support)",
     r"\b(?:EchoMaker|DynamicWorld|SubRayTracer|SimulatedSource|median_answers|keyframe_answers|drawn_on_ray|"
     r"drawn_in_matter|drawn_end|nearest_accepted|meet_movers|simulate::simulate)\b|"
     r"\bnamespace (?:\w+ = )?(?:underbrush::)?simulate\b",
     {**PIPELINE, "src/underbrush/simulate/": "answers are drawn here", "src/underbrush/trace/": "rays meet elements here",
      "src/underbrush/calibrate/": "the grain and the sway are learnt from answers without them",
      "src/underbrush/osi/traced_part.": "the strategy `tracer` answers rays of OSI, which are no beams of a log",
      "bench/echoes.cpp": "a benchmark of the instrument itself", "bench/contest.cpp": "a benchmark of the tracer itself",
      **tests_of("ball_scanner.hpp", "calibrate/", "drive_past.hpp", "fit/", "keyframes/", "likelihood/", "plant_meshes/",
                 "simulate/", "trace/", "update/", "worlds/")}),
    ("generated truths are scanned", r"underbrush/simulate/footprint",
     r"\bsimulate::scan\b",
     {"src/underbrush/simulate/": "the caster is here",
      "apps/underbrush/cmd_demo.cpp": "the log of the demo",
      "studies/site_drive.": "logs of generated sites", "studies/static_scan.cpp": "logs of generated targets",
      "studies/mesh_fidelity_scan.cpp": "the study judges plants as triangles, not an instrument",
      "bench/site.hpp": "the log of a generated site", **tests_of("simulate/")}),
    ("scenes are composed of extracted primitives", r"(?!)",
     r"\bprimitives::(?:compose|extract)\b(?!\.)|\bnamespace (?:\w+ = )?(?:underbrush::)?primitives\b",
     {**PIPELINE, "src/underbrush/primitives/": "they are extracted and composed here",
      **tests_of("plant_meshes/", "pipeline/", "primitives/", "regions/")}),
    ("models are fitted", r"underbrush/(?:fit/(?:fit|fit_stages|fitters)|update/update)\.hpp",
     r"\b(?:fit::fit|begin_fit|end_fit|fitter_named|fitters|update::update)\b|"
     r"\bnamespace (?:\w+ = )?(?:underbrush::)?(?:fit|update)\b",
     {**PIPELINE, "src/underbrush/fit/": "fitters are here", "src/underbrush/update/": "updates are made here",
      "src/underbrush/jobs/fit_stage.": "a fit in stages of its own processes, which `pipeline` completes",
      "apps/underbrush/reference_main.cpp": "the reference page lists the fitters",
      **tests_of("ball_scanner.hpp", "calibrate/", "credit/", "fit/", "keyframes/", "likelihood/", "pipeline/", "update/")}),
]
FORBIDDEN = (
    r"#\s*include\s*<(?P<header>iostream|syncstream)>|\b(?:std::)?(?P<call>printf|puts|putchar|fprintf|"
    r"fputs|perror|exit|_Exit|quick_exit|abort|terminate)\s*\(|\bstd::(?P<stream>cout|cerr|clog)\b")
SOURCES = (".h", ".hpp", ".cpp", ".inl", ".cpp.in", ".hpp.in")
INCLUDE = r'^\s*#\s*include\s*[<"]([^>"]+)[>"]'


def words_after(keyword, text):
    """The words that follow an upper-case keyword of a CMake call, up to the next keyword."""
    found = re.search(rf"\b{keyword}\b((?:\s+(?![A-Z_]+(?:\s|$))\S+)*)", text)
    return set(found.group(1).split()) if found else set()


def cmake_text(root, path):
    return re.sub(r"#[^\n]*", "", rules.read(root, path))


def declared(root):
    """{module: (modules it DEPENDS on, targets it LINKs, its HEADERS)}, from the CMakeLists.txt of each."""
    found = {}
    for path in rules.tracked(root, "CMakeLists.txt"):
        m = re.search(r"underbrush_module\((\w+)([^)]*)\)", cmake_text(root, path))
        if path.startswith(LIBRARY) and m:
            found[m.group(1)] = tuple(words_after(k, m.group(2)) for k in ("DEPENDS", "LINK", "HEADERS"))
    return found


def folder_of(path):
    """'report', 'cli', ... or None for files of the library and of the tests."""
    return next((f for f in ABOVE if path.startswith(f + "/")), None)


def module_of(path):
    return path[len(LIBRARY):].split("/")[0] if path.startswith(LIBRARY) else None


def party_of(name):
    return next((p for p in THIRD_PARTY if name.lstrip("/").startswith(p)), None)


class Includes:
    """Who includes what: file names are resolved as the compiler does."""

    def __init__(self, root):
        self.root = root
        self.files = set(rules.tracked(root, *SOURCES))
        self.of = {}
        for path in sorted(self.files):
            code, _ = rules.split_cpp(rules.read(root, path))
            self.of[path] = [(line, m.group(1)) for line, m in rules.lines_with(INCLUDE, code)]

    def resolve(self, path, name):
        tries = [posixpath.join(posixpath.dirname(path), name)]
        tries += [posixpath.join(folder, name) for folder in ("src", "", "apps", "apps/underbrush")]
        return next((t for t in map(posixpath.normpath, tries) if t in self.files), None)

    def parties(self, path, seen=()):
        """Third parties of a file, with those of the .inl files that it includes."""
        found = set()
        for _, name in self.of[path]:
            target = self.resolve(path, name)
            if target and target.endswith(".inl") and target not in seen:
                found |= self.parties(target, (*seen, path))
            elif not target and party_of(name):
                found.add(party_of(name))
        return found


def check_module_file(path, includes, depends):
    mine = module_of(path)
    for line, name in includes.of[path]:
        at = f"{path}:{line}: "
        top, _, rest = name.partition("/")
        other = rest.split("/")[0]
        if top == "underbrush" and other != mine and other not in depends.get(mine, (set(),))[0]:
            yield at + f"'{mine}' includes '{other}' but does not DEPEND on it"
        if top != "underbrush" and folder_of(includes.resolve(path, name) or ""):
            yield at + f"the library includes '{name}', which stands above it"
        party = None if top == "underbrush" else party_of(name)
        if party and THIRD_PARTY[party] is not None and mine not in THIRD_PARTY[party]:
            yield at + f"<{name}> does not belong in '{mine}'"
        elif party and path.endswith(".hpp"):
            yield at + f"<{name}> in a header: keep a third party in a .cpp or a private .inl"
    code, _ = rules.split_cpp(rules.read(includes.root, path))
    for line, m in rules.lines_with(FORBIDDEN, code):
        what = m.group("header") or m.group("call") or m.group("stream")
        yield f"{path}:{line}: {what} in the library, which never prints or exits"


def check_declarations(includes, depends):
    """What a module declares and does not include, and third parties that it includes without LINK."""
    for module, (modules, links, _) in depends.items():
        at = f"{LIBRARY}{module}/CMakeLists.txt: "
        files = [p for p in includes.files if module_of(p) == module]
        names = {name.split("/")[1] for p in files for _, name in includes.of[p]
                 if name.startswith("underbrush/")}
        for other in sorted(modules - names):
            yield at + f"'{module}' DEPENDS on '{other}' but includes nothing of it"
        sources = [p for p in files if p.endswith((".cpp", ".cpp.in"))]
        used = {TARGETS[q] for p in sources for q in includes.parties(p) if q in TARGETS}
        for target in sorted(used ^ (links & set(TARGETS.values()))):
            yield at + (f"'{module}' does not LINK {target}, which it includes" if target in used else
                        f"'{module}' LINKs {target} but includes nothing of it")


def check_headers(includes, depends):
    """HEADERS, which are installed, are those that code outside the library includes, and what these include. Tests
    of the library are not outside."""
    def included(path):
        return {includes.resolve(path, name) for _, name in includes.of[path]} - {None}

    public = set()
    for path in includes.files:
        if not path.startswith((LIBRARY, "tests/")) or path.startswith("tests/consumer/"):
            public |= {t for t in included(path) if module_of(t)}
    todo = list(public)
    while todo:
        found = included(todo.pop()) - public
        public |= found
        todo += found
    for module, (_, _, headers) in depends.items():
        used = {p for p in public if module_of(p) == module and p.endswith((".hpp", ".h"))}
        for path in sorted(used ^ {f"{LIBRARY}{module}/{h}" for h in headers}):
            yield (f"{path}: is not among the HEADERS of '{module}' but others need it" if path in used else
                   f"{path}: is among the HEADERS of '{module}' but nobody else needs it")


def check_above(path, includes):
    mine = folder_of(path)
    for line, name in includes.of[path]:
        other = folder_of(includes.resolve(path, name) or "")
        if other and other != mine and other not in ABOVE[mine]:
            yield f"{path}:{line}: {mine} may not include '{name}' of {other}"
        if name.startswith("embree") and mine != "bench":
            yield f"{path}:{line}: Embree belongs to bench alone"


def check_links_above(folder, includes):
    """What a folder above the library links and none of its files includes."""
    if not (includes.root / folder / "CMakeLists.txt").is_file():
        return
    text = cmake_text(includes.root, f"{folder}/CMakeLists.txt")
    linked = {w for call in re.findall(r"target_link_libraries\(([^)]*)\)", text) for w in call.split()[1:]}
    used = set()
    for path in (p for p in includes.files if folder_of(p) == folder):
        for _, name in includes.of[path]:
            target = includes.resolve(path, name)
            used.add(folder_of(target or "") or name)
        used |= includes.parties(path)
    for target in sorted(linked):
        if target.startswith("underbrush::"):
            wanted = "underbrush/" + target.partition("::")[2] + "/"
        elif target in OWN_TARGETS:
            wanted = OWN_TARGETS[target]
        else:
            wanted = next((p for p, t in TARGETS.items() if t == target), None)
        if wanted and wanted != folder and not any(u.startswith(wanted) for u in used):
            yield f"{folder}/CMakeLists.txt: links {target} but includes nothing of it"


def check_own_options(root):
    for path in rules.tracked(root, "CMakeLists.txt"):
        own, skip = set(), set()
        for call in re.findall(r"set_source_files_properties\(([^)]*)\)", cmake_text(root, path)):
            sources = re.findall(r"\S+\.cpp", call)
            own.update(sources if "COMPILE_OPTIONS" in call else ())
            skip.update(sources if "SKIP_PRECOMPILE_HEADERS ON" in call else ())
        for source in sorted(own - skip):
            yield f"{path}: {source} has COMPILE_OPTIONS but not SKIP_PRECOMPILE_HEADERS"


def check_inner_parts(includes):
    """Who answers beams or fits models beside `pipeline`, and exceptions that are none."""
    for what, headers, names, allowed in INNER_PARTS:
        used = set()
        for path in sorted(includes.files):
            code, _ = rules.split_cpp(rules.read(includes.root, path))
            found = [(line, name) for line, name in includes.of[path]
                     if re.search(headers, includes.resolve(path, name) or name)]
            found += [(line, m.group()) for line, m in rules.lines_with(names, code)]
            reasons = [prefix for prefix in allowed if path.startswith(prefix)]
            used.update(reasons if found else ())
            for line, name in () if reasons else found:
                yield f"{path}:{line}: {name}: {what} by `pipeline` alone"
        for prefix in sorted(set(allowed) - used):
            if any(path.startswith(prefix) for path in includes.files):
                yield f"{prefix}: is listed among the INNER_PARTS of tests/rules/layers.py but needs none of them"


def check_circles(includes):
    """Circles of units, each of which is a source with the header of its name: a unit that needs another one must not be
    needed by it."""
    def unit(path):
        return re.sub(r"\.[\w.]+$", "", path)

    needs = {}
    for path in sorted(includes.files):
        found = {unit(t) for t in (includes.resolve(path, name) for _, name in includes.of[path]) if t}
        needs.setdefault(unit(path), set()).update(found - {unit(path)})
    while needs:  # without the units that need none of those left, or that none of those left needs
        needed = set().union(*needs.values())
        left = {u: found & set(needs) for u, found in needs.items() if found & set(needs) and u in needed}
        if left == needs:
            yield f"{', '.join(sorted(left))}: include each other in a circle: move what they share to a header of its own"
            return
        needs = left


def check(root):
    includes, depends = Includes(root), declared(root)
    out = list(check_inner_parts(includes)) + list(check_circles(includes))
    for path in sorted(includes.files):
        if module_of(path):
            out += check_module_file(path, includes, depends)
        elif folder_of(path):
            out += check_above(path, includes)
    out += check_declarations(includes, depends)
    out += check_headers(includes, depends)
    for folder in ABOVE:
        out += check_links_above(folder, includes)
    return out + list(check_own_options(root))


def module(name, source, depends=""):
    return {f"{LIBRARY}{name}/CMakeLists.txt": f"underbrush_module({name}\n  SOURCES a.cpp\n{depends})",
            f"{LIBRARY}{name}/a.cpp": source}


# Ways around `pipeline`: by headers, by other headers that include them, by relative paths, by namespaces.
BYPASSES = [
    '#include "underbrush/simulate/simulate.hpp"', '#include "../src/underbrush/simulate/simulate.hpp"',
    '#include "underbrush/simulate/draw.hpp"', '#include "underbrush/simulate/sub_ray_tracer.hpp"',
    '#include "underbrush/simulate/median.hpp"', '#include "underbrush/fit/fit_stages.hpp"',
    "simulate::EchoMaker maker(traced.dynamic(), reflection, instrument, {});", "const simulate::DynamicWorld world(still);",
    "traced.still().nearest_accepted(ray, key, limits);", "using namespace simulate;", "namespace s = underbrush::simulate;",
    "simulate::scan(world, label, beam, 0, log);", "auto m = fit::fit(beams, {}).model;", "using namespace fit;", "auto start = fit::begin_fit(log, options);",
    "auto scene = primitives::compose(site, ground, set, {}).scene;", "primitives::extract(model, log, options);",
    "using namespace primitives;", "fit::end_fit(log, start, refinement, options);", 'fit::fitter_named("voxel").fit(log, options, {});',
]
BAD = [({"studies/a.cpp": text + "\n", f"{LIBRARY}simulate/simulate.hpp": ""}, "by `pipeline` alone") for text in BYPASSES]
BAD += [
    ({"tests/serve/a.cpp": '#include "underbrush/simulate/simulate.hpp"\n'}, "by `pipeline` alone"),
    ({**module("core", "int x;\n", "  HEADERS a.hpp\n"), f"{LIBRARY}core/a.hpp": ""}, "nobody else needs it"),
    ({**module("core", "int x;\n"), f"{LIBRARY}core/a.hpp": "", "apps/underbrush/b.cpp":
      '#include "underbrush/core/a.hpp"\n'}, "others need it"),
    (module("trace", '#include "underbrush/core/pose.hpp"\n', "  DEPENDS elements\n"), "does not DEPEND"),
    (module("trace", '#include "underbrush/core/pose.hpp"\n', "  DEPENDS core elements\n"),
     "DEPENDS on 'elements' but includes nothing"),
    (module("trace", "int x;\n", "  LINK nanoflann::nanoflann\n"), "LINKs nanoflann::nanoflann but"),
    (module("trace", "#include <nanoflann.hpp>\n"), "does not LINK nanoflann::nanoflann"),
    ({**module("core", "int x;\n"), f"{LIBRARY}core/k.inl": "#include <nanoflann.hpp>\n",
      **module("fit", '#include "underbrush/core/k.inl"\n', "  DEPENDS core\n")}, "does not LINK nanoflann"),
    (module("trace", '#include "underbrush/fit/cluster.hpp"\n', "  DEPENDS core"), "'fit'"),
    (module("fit", "#include <embree3/rtcore.h>\n"), "embree3"),
    (module("metrics", "#include <iostream>\n"), "iostream"),
    (module("metrics", 'void f() { std::printf("hello"); }\n'), "printf"),
    (module("metrics", "void f() { exit(1); }\n"), "exit"),
    ({**module("core", '#include "report/a.hpp"\n'), "report/a.hpp": ""}, "stands above it"),
    ({f"{LIBRARY}io/a.hpp": "#include <nlohmann/json.hpp>\n"}, "in a header"),
    ({"apps/underbrush/a.cpp": "#include <embree3/rtcore.h>\n"}, "Embree"),
    ({"report/a.cpp": '#include "cli/verb.hpp"\n', "cli/verb.hpp": ""}, "report may not include"),
    ({"bench/echoes.cpp": "int x;\n"}, "needs none of them"),
    ({"report/a.cpp": '#include "report/b.hpp"\n', "report/b.hpp": '#include "report/a.hpp"\n', "report/a.hpp": ""}, "circle"),
    ({"report/a.cpp": '#include "studies/study.hpp"\n', "studies/study.hpp": ""}, "report may not include"),
    ({"cli/a.cpp": '#include "fit_options.hpp"\n', "apps/underbrush/fit_options.hpp": ""},
     "cli may not include"),
    ({"apps/underbrush/a.cpp": '#include "studies/study.hpp"\n', "studies/study.hpp": ""},
     "apps/underbrush may not include"),
    ({"bench/a.cpp": '#include "cli/verb.hpp"\n', "cli/verb.hpp": ""}, "bench may not include"),
    ({"studies/a.cpp": '#include "bench/run.hpp"\n', "bench/run.hpp": ""}, "studies may not include"),
    ({"report/a.cpp": "int x;\n", "report/CMakeLists.txt": "target_link_libraries(r PUBLIC underbrush::io)\n"},
     "links underbrush::io but"),
    ({"bench/a.cpp": "int x;\n", "bench/CMakeLists.txt": "target_link_libraries(b PRIVATE underbrush_app)\n"},
     "links underbrush_app but"),
    ({"bench/a.cpp": "int x;\n", "bench/CMakeLists.txt": "target_link_libraries(b PRIVATE CLI11::CLI11)\n"},
     "links CLI11::CLI11 but"),
    ({"bench/a.cpp": "int x;\n",
      "bench/CMakeLists.txt": "set_source_files_properties(a.cpp PROPERTIES COMPILE_OPTIONS -O1)\n"},
     "a.cpp has COMPILE_OPTIONS but"),
]
GOOD = {**module("core", '#include <tbb/tbb.h>\n// printf( is a word here\nauto s = "exit(";\n',
                 "  LINK TBB::tbb"),
        f"{LIBRARY}core/k.inl": "#include <nanoflann.hpp>\n",
        **module("trace", '#include "underbrush/core/pose.hpp"\n#include "underbrush/core/k.inl"\n'
                 'void nearest_accepted(char* s) { std::snprintf(s, 1, "x"); }\n',
                 "  DEPENDS core  # the bottom\n  LINK nanoflann::nanoflann"),
        "studies/static_scan.cpp": '#include "underbrush/simulate/footprint.hpp"\n// simulate::EchoMaker is a word here\n',
        "report/a.hpp": "", "bench/a.cpp": '#include "report/a.hpp"\n#include <embree3/rtcore.h>\n',
        "bench/CMakeLists.txt": "target_link_libraries(b PRIVATE underbrush_report embree)\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
