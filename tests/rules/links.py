#!/usr/bin/env python3
"""Checks the links between pages: every relative link of a Markdown file leads to a file that is there and, after #,
to a heading of it; every page of docs/ is reached from docs/README.md; every block of commands says whether it is run
(readme.py explains the marks); and the Makefile has every goal of make that a page names."""
import pathlib
import posixpath
import re

import readme
import rules

# Pages that are written when the program is built. They may be absent from the tree; their headings are not known.
GENERATED = {f"docs/reference/{name}.md" for name in ("command-line", "strategies", "fmu-variables", "parameters", "sensor-catalogue", "materials")}
INDEX = "docs/README.md"
LINK = re.compile(r"!?\[[^\]]*\]\(([^()\s]+)\)|^\[[^\]]+\]:\s+(\S+)", re.MULTILINE)
FENCE = re.compile(r"^(```|~~~).*?^\1\s*$", re.DOTALL | re.MULTILINE)
INDENTED_COMMAND = re.compile(r"(?:\A|\n)\n    (?:underbrush|scripts/|build/bin|bench/|make|cmake|ctest|tests/)[^\n]*")


def without_code(text):
    """Blanks fenced blocks and code spans, so that lines keep their numbers."""
    def blank(m):
        return re.sub(r"[^\n]", " ", m.group())
    return re.sub(r"`[^`\n]*`", blank, FENCE.sub(blank, text))


def anchors(text):
    """Lists the anchors of headings, as GitHub makes them."""
    out = set()
    for heading in re.findall(r"^#+ +(.*?)\s*$", FENCE.sub("", text), re.MULTILINE):
        heading = re.sub(r"[`*]|\]\([^)]*\)", "", heading).lower()
        out.add(re.sub(r"[^\w\- ]", "", heading).replace(" ", "-"))
    return out


def links(page, text):
    """Lists (line, file, anchor) of every relative link, with the file relative to the root."""
    for line, m in rules.lines_with(LINK.pattern, without_code(text)):
        target = m.group(1) or m.group(2)
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        yield line, posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page, anchor


def unmarked(page, text):
    out = [f"{page}: a block of commands without a mark <!-- run --> or <!-- no run: REASON -->:\n{script}"
           for mark, script in readme.steps(text) if mark == "unmarked"]
    return out + [f"{page}:{line + 1}: commands stand in a fenced block, not in an indented one: {m.group().strip()}"
                  for line, m in rules.lines_with(INDENTED_COMMAND.pattern, FENCE.sub("", text))]


def goals(page, text, makefile):
    """Complains of goals of make, in code spans and at the start of a line of commands, that the Makefile lacks."""
    known = re.findall(r"^([a-z][\w-]*)[^:=\n]*:(?!=)", makefile, re.MULTILINE)
    typed = [re.findall(r"^(?:\$ )?make +([^#\n]*)", block.group(), re.MULTILINE) for block in FENCE.finditer(text)]
    for words in sum(typed, re.findall(r"`make +([^`]*)`", FENCE.sub("", text))):
        yield from (f"{page}: the Makefile has no goal '{goal}'" for goal in words.split()
                    if re.match(r"[a-z][\w-]*$", goal) and goal not in known)


def check(root):
    makefile = rules.read(root, "Makefile") if (root / "Makefile").exists() else ""
    pages = {path: rules.read(root, path) for path in rules.tracked(root, ".md")}
    out, reached, open_pages = [], set(), [INDEX]
    leads = {}
    for page, text in pages.items():
        out += [*unmarked(page, text), *goals(page, text, makefile)]
        leads[page] = set()
        for line, target, anchor in links(page, text):
            leads[page].add(target)
            if target in GENERATED and target not in pages:
                continue
            if not (root / target).exists():
                out.append(f"{page}:{line}: no such file: {target}")
            elif anchor and target in pages and anchor not in anchors(pages[target]):
                out.append(f"{page}:{line}: no such heading: {target}#{anchor}")
    while open_pages:
        page = open_pages.pop()
        if page not in reached:
            reached.add(page)
            open_pages += leads.get(page, ())
    return out + [f"{page}: not reached from {INDEX}" for page in pages
                  if pathlib.PurePath(page).parts[0] == "docs" and page not in reached]


TOP = {INDEX: "[One](a/one.md)\n"}
BAD = [({**TOP, "docs/a/one.md": "[Two](two.md)\n"}, "no such file"),
       ({**TOP, "docs/a/one.md": "# One\n\n[Here](#two)\n"}, "no such heading"),
       ({**TOP, "docs/a/one.md": "# One\n", "docs/a/two.md": "# Two\n"}, "not reached"),
       ({**TOP, "docs/a/one.md": "```sh\ntrue\n```\n"}, "without a mark"),
       ({"Makefile": "test: a\nx := y\n", "AGENTS.md": "Do `make test x`.\n"}, "no goal 'x'"),
       ({"AGENTS.md": "<!-- no run: slow -->\n```sh\nmake gone  # it\n```\n"}, "no goal 'gone'"),
       ({**TOP, "docs/a/one.md": "Do this:\n\n    underbrush info log.ply\n"}, "fenced block")]
GOOD = {**TOP, "Makefile": "TESTS ?= 1\ntest: build\n", "AGENTS.md": "`make test N=1` makes all.\n", "README.md": "See [index](docs/README.md#top-of-all).\n",
        "docs/a/one.md": "# One\n\n## `fit` and *it*\n\n[Here](#fit-and-it), [k], `[no](link.md)`, "
                         "[options](../reference/parameters.md#fit), [far](https://example.org/)\n\n"
                         "<!-- no run: slow -->\n```sh\nunderbrush info log.ply\n```\n\n[k]: ../b.bib\n",
        "docs/b.bib": "", INDEX: "# Top of all\n\n[One](a/one.md)\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
