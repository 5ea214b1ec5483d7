#!/usr/bin/env python3
"""Makes the report of what the simulation was validated with, from the tables of the documentation.

    scripts/validation_report.py --html report.html [--srmd resourceMetaData.srmd]

For each effect the page says what was compared with what, how far it is off, what is not modelled, and shows the
tables of results behind it, with their claims and whether these hold. `make results` measures the tables anew. The
SRMD file (SSP Traceability, Simulation Resource Meta Data) has the effects and the range of validity for programs.
"""
from __future__ import annotations

import argparse
import dataclasses
import html
import pathlib
import posixpath
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "scripts"))
from documented import tables  # noqa: E402

PAGE = "docs/explanation/validation.md"
LINK = re.compile(r"\[([^\]]*)\]\(([^()\s]+)\)")
TEMPLATE = "scripts/documented/metadata.srmd"
CLASSIFICATION = "org.underbrush.validation"
STYLE = """body{font:16px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em}
table{border-collapse:collapse;font-size:85%;display:block;overflow-x:auto}td,th{border:1px solid #bbb;padding:.2em .5em}
dt{font-weight:bold}.broken{color:#b00}small{color:#555}"""


@dataclasses.dataclass(frozen=True)
class Section:
    """A section of a page: its heading, the text before its first table, and the marked tables."""
    heading: str
    text: str
    tables: tuple[tables.Table, ...]


@dataclasses.dataclass(frozen=True)
class Effect:
    """A row of the table of effects, in Markdown, with the sections that it links to."""
    name: str
    compared_with: str
    error: str
    interval: str
    not_modelled: str
    sections: tuple[Section, ...]


def anchor(heading: str) -> str:
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def section(path: str, wanted: str) -> Section:
    """The section of a page below the heading with this anchor. Raises ValueError if there is none."""
    text = (ROOT / path).read_text(encoding="utf-8")
    pieces = re.split(r"^#+ +(.*?) *$", text, flags=re.MULTILINE)
    for heading, body in zip(pieces[1::2], pieces[2::2]):
        if anchor(heading) == wanted:
            before = re.split(r"^<!--|^\|", body, maxsplit=1, flags=re.MULTILINE)[0]
            found = tables.tables(body, tables.claims_of(ROOT))
            return Section(heading, before.strip(), tuple(t for t in found if t.name))
    raise ValueError(f"{path} has no section #{wanted}")


def effects() -> list[Effect]:
    """The rows of the table of effects."""
    page = (ROOT / PAGE).read_text(encoding="utf-8")
    table = next(t for t in tables.tables(page) if t.name == "validated")
    out, before = [], ()
    for name, compared, error, interval, missing in table.rows:
        found = []
        for _, target in LINK.findall(compared):
            path, _, fragment = target.partition("#")
            path = posixpath.normpath(posixpath.join(posixpath.dirname(PAGE), path))
            if fragment:
                found.append(section(path, fragment))
        if compared.startswith("the same"):
            found = list(before)
        before = tuple(found)
        out.append(Effect(name, compared, error, interval, missing, before))
    return out


def validity() -> list[list[str]]:
    """The rows of the table of ranges: quantity, what was compared, what lies beyond."""
    page = (ROOT / PAGE).read_text(encoding="utf-8")
    body = page.split("### Range of validity", 1)[1]
    return tables.tables(body)[0].rows


def plain(markdown: str) -> str:
    """The text of a cell without marks and addresses."""
    return re.sub(r"[*`]", "", LINK.sub(r"\1", markdown))


def inline(markdown: str) -> str:
    """A line of Markdown as HTML; links become their texts."""
    text = html.escape(LINK.sub(r"\1", markdown), quote=False)
    text = re.sub(r"\[(\w+)\]", r"[\1]", text)
    text = re.sub(r"`([^`]*)`", r"<code>\1</code>", text)
    return re.sub(r"\*\*([^*]*)\*\*", r"<b>\1</b>", text)


def intervals() -> str:
    """How the intervals were computed."""
    found = re.search(r"^Intervals are .*?(?=\n\n)", (ROOT / PAGE).read_text(encoding="utf-8"), re.M | re.S)
    assert found
    return inline(" ".join(found[0].split()))


def table_html(table: tables.Table) -> str:
    """A table and its claims."""
    head = "".join(f"<th>{inline(h)}</th>" for h in table.headings)
    rows = "".join("<tr>" + "".join(f"<td>{inline(c)}</td>" for c in row) + "</tr>" for row in table.rows)
    broken = tables.broken_claims(table)
    claims = f"<small>{len(table.claims)} claims of this table, {len(table.claims) - len(broken)} hold.</small>"
    claims += "".join(f'<p class="broken">{html.escape(line)}</p>' for line in broken)
    return f"<table><tr>{head}</tr>{rows}</table>{claims}"


def section_html(part: Section) -> str:
    """The text of a section and its tables."""
    paragraphs = "".join(f"<p>{inline(' '.join(p.split()))}</p>" for p in part.text.split("\n\n"))
    body = paragraphs + "".join(table_html(t) for t in part.tables)
    return f"<details><summary>{inline(part.heading)}</summary>{body}</details>"


def source() -> str:
    """The version, and the commit where this is a clone."""
    version = re.search(r"project\(underbrush VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert version
    try:
        said = [subprocess.run(["git", "-C", str(ROOT), *words], check=True, capture_output=True,
                               text=True).stdout.strip() for words in (("log", "-1", "--format=%h of %cs"), ("status", "--porcelain", "--untracked-files=no"))]
    except (OSError, subprocess.CalledProcessError):
        return f"version {version[1]}"
    return f"version {version[1]}, commit {said[0]}" + (" with changes" if said[1] else "")


def report(found: list[Effect]) -> str:
    """The page."""
    parts = ["<!doctype html><html lang=en><meta charset=utf-8><title>Validation of Underbrush</title>",
             f"<style>{STYLE}</style><h1>Validation of Underbrush</h1>",
             "<p>Each effect that the simulation claims, what it was compared with, how far it is off, and what is not "
             f"modelled, of {source()}. <code>make results</code> measures the tables anew and compares every "
             f"figure.</p><p>{intervals()}</p>"]
    for effect in found:
        rows = (("compared with", inline(effect.compared_with)), ("error", inline(effect.error)), ("interval", inline(effect.interval)),
                ("not modelled", inline(effect.not_modelled)))
        listed = "".join(f"<dt>{name}</dt><dd>{value}</dd>" for name, value in rows)
        parts.append(f"<h2>{inline(effect.name)}</h2><dl>{listed}</dl>" + "".join(map(section_html, effect.sections)))
    ranges = "".join("<tr>" + "".join(f"<td>{inline(c)}</td>" for c in row) + "</tr>" for row in validity())
    parts.append(f"<h2>Range of validity</h2><table><tr><th>quantity<th>compared<th>beyond it</tr>{ranges}</table>")
    return "\n".join(parts) + "\n</html>\n"


def srmd(found: list[Effect]) -> str:
    """The effects and the range of validity as SRMD."""
    def entries(kind: str, pairs: list[tuple[str, str]]) -> str:
        lines = "".join(f'    <stc:ClassificationEntry keyword="{html.escape(key)}">{html.escape(value)}'
                        "</stc:ClassificationEntry>\n" for key, value in pairs)
        return f'  <stc:Classification type="{CLASSIFICATION}.{kind}">\n{lines}  </stc:Classification>\n'

    shown = [(f"{e.name}.{key}", plain(value)) for e in found for key, value in
             (("compared with", e.compared_with), ("error", e.error), ("interval", e.interval),
              ("not modelled", e.not_modelled))]
    claims = [t for e in found for s in e.sections for t in s.tables]
    unique = {t.name: t for t in claims}.values()
    broken = sum(len(tables.broken_claims(t)) for t in unique)
    model = [("kind", "lidar sensor model, from reflections or ground truth to object lists"),
             ("interface", "OSI 3.8.0, OSMP 1.6.0"), ("claims checked", str(sum(len(t.claims) for t in unique))),
             ("claims that do not hold", str(broken)), ("verification", "make test; make results")]
    ranges = [(f"{quantity}.{key}", plain(value)) for quantity, inside, outside in validity()
              for key, value in (("compared", inside), ("beyond it", outside))]
    template = (ROOT / TEMPLATE).read_text(encoding="utf-8")
    return template.replace("@CLASSIFICATIONS@", entries("model", model) + entries("effects", shown)
                            + entries("validity", ranges))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--html", type=pathlib.Path, help="file for the page")
    parser.add_argument("--srmd", type=pathlib.Path, help="file for the metadata")
    options = parser.parse_args()
    if not options.html and not options.srmd:
        parser.error("nothing to write: --html or --srmd")
    found = effects()
    if options.html:
        options.html.write_text(report(found), encoding="utf-8")
    if options.srmd:
        options.srmd.write_text(srmd(found), encoding="utf-8")


if __name__ == "__main__":
    main()
