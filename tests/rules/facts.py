#!/usr/bin/env python3
"""Holds what pages state of the program against the program: verbs, studies, options and sources that they name exist,
lists are whole, stated defaults and counts are right, and figures that a text repeats from a table are those of it."""
import functools
import pathlib
import re
import subprocess
import sys

import rules

sys.path.insert(0, str(rules.ROOT / "scripts"))
import results  # noqa: E402
from documented import tables  # noqa: E402

WORDS = {"one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "twelve": 12}


class Program:
    """What the program says of itself."""

    def __init__(self, program):
        self.program = program

    @functools.lru_cache(maxsize=None)
    def say(self, *words):
        return subprocess.run([self.program, *words], check=True, capture_output=True, text=True).stdout

    @functools.lru_cache(maxsize=None)
    def options(self, verb):
        """{option: its help on one line} of a verb."""
        entries = re.split(r"^  (?:-\w, )?(?=--[a-z])", self.say(verb, "--help-all"), flags=re.MULTILINE)[1:]
        return {re.match(r"--[\w-]+", entry).group(): " ".join(entry.split()) for entry in entries}

    def default(self, verb, option):
        return float(re.search(r"\[([\d.]+)\]", self.options(verb)[option]).group(1))

    def verbs(self):
        return re.findall(r"^  ([a-z][a-z-]+) {2,}\S", self.say("--help").partition("--config")[2], re.MULTILINE)

    def functions(self):
        """The functions of the Python package that are verbs."""
        names = re.findall(r"^def ([a-z]\w+)\(", rules.read(rules.ROOT, "python/underbrush/verbs.py"), re.MULTILINE)
        return sorted({name for name in names if name.removesuffix("_log") in self.verbs()})

    def fitters(self):
        return re.search(r"one of ([\w, ]+) \[", self.options("fit")["--fitter"]).group(1).split(", ")

    def sensors(self):
        """The models of the catalogue, without their makers."""
        lines = self.say("sensors", "list").splitlines()[1:]
        return [line.split()[0].partition("-")[2] for line in lines if not line.startswith("generic")]

    def requests(self):
        """What the server answers."""
        sources = [path for path in rules.tracked(rules.ROOT, ".cpp") if path.startswith("src/underbrush/serve/")]
        found = (re.findall(r'\{"(api/[\w/]+)"', rules.read(rules.ROOT, path)) for path in sources)
        return sorted({request for requests in found for request in requests})

    def faces(self):
        """How the program is used, as the README names it, by the folder that makes it so."""
        faces = {"apps/underbrush": "as a command", "python/underbrush": "as a Python package", "web/src": "`serve`",
                 "apps/fmu": "FMU", "tests/consumer": "as a C++ library", "src/underbrush/perception": "object lists"}
        return [face for folder, face in faces.items() if (rules.ROOT / folder).is_dir()]

    def studies(self):
        return re.findall(r'^ +\{"([a-z-]+)"', rules.read(rules.ROOT, "studies/studies.cpp"), re.MULTILINE)


@functools.lru_cache(maxsize=None)
def program_at(path):
    return Program(path)


def gains(program):
    """The second greatest and the greatest gain in the table of tuned objectives, in whole per cent."""
    del program
    page, table = results.documented(rules.ROOT)["tuning"]
    found = [100 * (1 - after.value / before.value) for before, after in
             (tables.figures(row[1]) for row in table.rows)]
    return [round(gain) for gain in sorted(found)[-2:]]


def odometry(program):
    """Ratios, and extremes of the correlations, of the default's scans, as the page on validation repeats them."""
    del program
    table = results.documented(rules.ROOT)["software-odometry"][1]

    def figure(log, column):
        return tables.figures(table.cell(table.row(f"{log}/default"), table.column(column)))[0].value
    drives, parts = ("kitti_0027_forest", "kitti_0005_tracks"), ("translation", "rotation")
    correlations = [figure(log, f"{part}: correlation") for part in parts for log in drives]
    return [figure(log, f"{part}: ratio") for part in parts for log in drives] + [min(correlations), max(correlations)]


def default(verb, option):
    return lambda program: [program.default(verb, option)]


def notebooks(program):
    del program
    return [sum(path.name != "make_ipynb.py" for path in (rules.ROOT / "python/notebooks").glob("*.py"))]


def letters(name):
    """A pattern of a name whose letters and digits may be parted by hyphens."""
    return "(?i)[ (]" + "[- ]?".join(re.sub(r"\W", "", name)) + r"\b"


#: Where the functions of the Python package are counted, and except in the first place listed.
PACKAGE = ("README.md", "docs/how-to/python.md", "python/underbrush/__init__.py")

#: Lists that are whole: (page, list, pattern of a place that names one, or what makes the pattern of a name).
LISTS = [("README.md", Program.faces, r"{}"),
         *((page, Program.functions, r"`{}`") for page in PACKAGE[1:]),
         ("docs/how-to/reproduce-a-paper.md", Program.studies, r"^\| `{}` \|"),
         ("CHANGELOG.md", Program.studies, r"`{}`"),
         ("docs/explanation/fitters.md", Program.fitters, r"^\| `{}` \|"),
         ("CHANGELOG.md", Program.fitters, r"`{}`"),
         ("CHANGELOG.md", Program.verbs, r"`{}\b"),
         ("CHANGELOG.md", Program.sensors, letters),
         ("docs/reference/serve-api.md", Program.requests, r"`{}[`?]")]

#: Numbers: (page, pattern with numbers in groups, what they are).
NUMBERS = [
    ("docs/how-to/choosing-a-fitter.md", r"default of (\d+) keeps", default("fit", "--ellipsoid-prior-hits")),
    ("docs/how-to/choosing-a-fitter.md", r"better F1 than the default (\d+)", default("fit", "--tau")),
    ("docs/notebook/2026-11.md", r"- (\d+) prior hits of an ellipsoid", default("fit", "--ellipsoid-prior-hits")),
    ("docs/explanation/fitters.md", r"default prior is (\d+) hits", default("fit", "--ellipsoid-prior-hits")),
    ("docs/explanation/ray-model.md", r"default is τ = (\d+)", default("fit", "--tau")),
    ("docs/explanation/likelihood.md", r"most (\d+) M-steps \(`--rounds`\)", default("fit", "--rounds")),
    ("docs/explanation/likelihood.md", r"default d = ([\d.]+)", default("fit", "--dropout")),
    ("docs/explanation/likelihood.md", r"default of (\d+) changes nothing", default("fit", "--sharpness")),
    ("docs/explanation/keyframes.md", r"`--keyframes X` \((\d+) m unless given\)", default("fit", "--keyframes")),
    ("docs/how-to/tuning.md", r"# (\d+) evaluations are usual", default("optimize", "--budget")),
    ("docs/how-to/tuning.md", r"One scan in (\w+) \(`--validate`\)", default("optimize", "--validate")),
    ("docs/how-to/tuning.md", r"gained (\d+) % and (\d+) %", gains),
    ("docs/how-to/notebooks.md", r"(\w+) notebooks in", notebooks),
    *((page, r"functions for (\w+) verbs", lambda program: [len(program.functions())]) for page in PACKAGE),
    ("docs/explanation/validation.md",
     r"RMSE ([\d.]+) and ([\d.]+) times .*?, ([\d.]+) and ([\d.]+) in rotation; .*? ([\d.]+) to ([\d.]+)", odometry)]

#: What no page says, with what is so.
NEVER = [(r"not there yet", "object lists, the FMU and the page of the browser are there"),
         (r"reflectances are typical values", "thin rays answer with reflectances that are learnt from the log"),
         (r"given as a mesh with poses", "a model's folder moves, too")]

#: Options of programs that are neither ours nor in the tree.
OTHERS = {"--build", "--config-settings", "--install", "--packages-select", "--prefix", "--preset", "--ros-args", "--strict",
          "--test-dir"}


@functools.lru_cache(maxsize=None)
def options_of_scripts():
    """The options that scripts, studies, benchmarks and tests take."""
    own = [path for path in rules.tracked(rules.ROOT, ".py", ".sh", ".cpp")
           if path.startswith(("scripts/", "studies/program.cpp", "bench/", "tests/", "python/"))
           and path != "tests/rules/facts.py"]
    return OTHERS.union(*(re.findall(r"[\"' (]?(--[a-z][\w-]+)", rules.read(rules.ROOT, path)) for path in own))


def names(path, text, program):
    """Complains of verbs, studies and options that a page names and that do not exist."""
    verbs, studies = program.verbs(), [*program.studies(), "list"]
    parameters = rules.read(rules.ROOT, "docs/reference/parameters.md")  # the help does not list all of them
    options = options_of_scripts().union(*(program.options(verb) for verb in verbs),
                                         ("--" + name for name in re.findall(r"^\| `([\w-]+)` \|", parameters, re.M)))
    for pattern, known, kind in ((r"(?:^|[`$] ?|bin/)underbrush ([a-z][a-z-]+)\b", verbs, "verb"),
                                 (r"\bunderbrush-study ([a-z][a-z-]+)\b", studies, "study"),
                                 (r"(?<![\w-])(--[a-z][\w-]+)", options, "option")):
        for line, m in rules.lines_with(pattern, text):
            if m[1] not in known:
                yield f"{path}:{line}: the program has no {kind} '{m[1]}'"


@functools.lru_cache(maxsize=None)
def files():
    """The files of the tree by all names that pages use: from the root, and from the folders of sources."""
    names = rules.tracked(rules.ROOT)
    return {name[len(folder):] for folder in ("", "src/", "src/underbrush/") for name in names
            if name.startswith(folder)}


def sources(path, text):
    """Complains of sources that a page names and that do not exist."""
    for line, m in rules.lines_with(r"[`\"]([\w-]+/[\w/-]+\.(?:hpp|cpp|py|sh|mjs))[`\"]", text):
        if m[1] not in files():
            yield f"{path}:{line}: there is no file {m[1]}"


def check(root, options):
    program, out = program_at(options.program), []
    pages = {path: rules.read(root, path) for path in rules.tracked(root, ".md", ".py")
             if path in ("CHANGELOG.md", *PACKAGE) or path.startswith("docs/") and path.endswith(".md")}
    for path, text in pages.items():
        out += [*names(path, text, program), *sources(path, text)]
        out += [f"{path}:{line}: '{m.group()}' is stale: {so}" for pattern, so in NEVER
                for line, m in rules.lines_with(pattern.replace(" ", r"\s+"), text)]
    for path, whole, pattern in LISTS:
        place = pattern if callable(pattern) else lambda name, text=pattern: text.format(re.escape(name))
        text = re.sub(r"(?<=\w)\n(?=\w)", " ", pages.get(path, ""))
        out += [f"{path}: the list lacks '{name}'" for name in whole(program)
                if path in pages and not re.search(place(name), text, re.MULTILINE)]
    for path, pattern, number in NUMBERS:
        found = re.search(pattern.replace(" ", r"\s+"), pages.get(path, ""))
        stated = [WORDS.get(word.lower(), word) for word in found.groups()] if found else []
        if found and [float(word) for word in stated] != number(program):
            out.append(f"{path}: '{' '.join(found.group().split())}' states {stated}, it is {number(program)}")
        elif not found and root == options.root:
            out.append(f"{path}: nothing is stated as '{pattern}'; take the fact out of tests/rules/facts.py")
    return out


BAD = [({"README.md": "The FMU is not\nthere yet.\n"}, "stale"),
       ({"README.md": "It runs as a command and as an FMU.\n"}, "lacks 'as a Python package'"),
       ({"docs/a.md": "`underbrush frobnicate` does it.\n"}, "no verb 'frobnicate'"),
       ({"docs/a.md": "```sh\nbuild/bin/underbrush-study astrology --quick\n```\n"}, "no study 'astrology'"),
       ({"docs/a.md": "Take `--frobnicate`.\n"}, "no option '--frobnicate'"),
       ({"docs/a.md": "See `fit/gone.hpp`.\n"}, "no file fit/gone.hpp"),
       ({"docs/explanation/fitters.md": "| `voxel` | |\n"}, "lacks 'likelihood'"),
       ({"docs/how-to/reproduce-a-paper.md": "| `vegetation` | |\n"}, "lacks 'echoes'"),
       ({"CHANGELOG.md": "A catalogue of sensors (Velodyne HDL-64E).\n"}, "lacks 'vlp16'"),
       ({"docs/reference/serve-api.md": "| `api/files` | |\n"}, "lacks 'api/octree'"),
       ({"docs/notebook/2026-11.md": "- 50 prior hits of an ellipsoid\n"}, "it is [0.0]"),
       ({"docs/how-to/tuning.md": "gained 0 % and 24 %\n"}, "states ['0', '24']"),
       ({"docs/how-to/notebooks.md": "Three notebooks in\n"}, "states"),
       ({"docs/how-to/python.md": "It has functions for two verbs: `fit`, `score`.\n"}, "lacks 'import_log'"),
       ({"README.md": "It has functions for\ntwo verbs.\n"}, "states [2]")]
GOOD = {"README.md": "It runs as a command, as a\nPython package, as a C++ library, in the browser (`serve`) and as an FMU, and\n"
                     "makes object lists.\n```sh\nunderbrush fit log.ply --tau 3 -o model\n```\nThe program underbrush.\n",
        "docs/how-to/tuning.md": "One scan in\nfour (`--validate`), `fit/fit.hpp`, `tests/rules/facts.py`\n"}


def arguments(parser):
    parser.add_argument("--program", required=True, type=pathlib.Path)


if __name__ == "__main__":
    rules.main(check, BAD, GOOD, arguments)
