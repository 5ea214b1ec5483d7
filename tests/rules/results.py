#!/usr/bin/env python3
"""Checks the tables of figures in the documentation without measuring anything. Each has a mark: `results: NAME`, and
scripts/documented/registry.py has commands for the name, or `not compared: REASON`. The claims of claims.txt hold of
the figures that are printed. `scripts/results.py` (`make results`) compares the figures with new ones; its examples
here run a program that prints figures, and one that is off must be noticed."""
import contextlib
import io
import os
import pathlib
import sys

import rules

sys.path.insert(0, str(rules.ROOT / "scripts"))
import results as command  # noqa: E402  (this file's own name is __main__)
from documented import jobs, registry, registry_summary, tables  # noqa: E402

#: Of the bad and good examples: which tables there are, and which repeat others.
EXAMPLES = {"one": {}, "two": {}, "three": {("best", "F1"): [("one", "ours", "F1", 0)]}}


def is_page(path):
    return path == "README.md" or any(pathlib.PurePath(path).match(pattern) for pattern in command.PAGES[1:])


def unknown_labels(table, measured):
    labels = [*measured.relative, *measured.absolute, *measured.uncompared]
    return [f"no row or column '{words}', which scripts/documented/registry.py names" for words in labels
            if words != "*" and table.row(words) is None and table.column(words) is None]


def check(root):
    out, used = [], {}
    names = set(registry.MEASURED if root == rules.ROOT else EXAMPLES)
    views = registry.VIEWS if root == rules.ROOT else {"three": EXAMPLES["three"]}
    claims = tables.claims_of(root)
    for path in filter(is_page, rules.tracked(root, ".md")):
        for table in tables.tables(rules.read(root, path), claims):
            place = f"{path}:{table.line}"
            if table.kind is None and table.has_figures:
                out.append(f"{place}: a table of figures without a mark: <!-- results: NAME --> or "
                           "<!-- not compared: REASON -->")
            elif table.kind == "not compared" and not table.reason:
                out.append(f"{place}: the reason is missing why it is not compared")
            elif table.kind == "results":
                if table.name not in names:
                    out.append(f"{place}: no commands for the table '{table.name}'")
                if table.name in used:
                    out.append(f"{place}: '{table.name}' is already the table of {used[table.name]}")
                used[table.name] = place
                out += [f"{place}: {line}" for line in tables.broken_claims(table)]
                if root == rules.ROOT and table.name in names:
                    out += [f"{place}: {line}" for line in unknown_labels(table, registry.MEASURED[table.name])]
    found = {name: table for name, (_, table) in command.documented(root).items()}
    out += [f"{used[name]}: {line}" for name, view in views.items() if name in found
            for line in registry_summary.broken(view, found[name], found)]
    out += [f"{tables.CLAIMS}: no page has the table '{name}'" for name in sorted(set(claims) - set(used))]
    if root == rules.ROOT:
        out += [f"no page has the table '{name}'" for name in sorted(names - set(used))]
    return out


TABLE = "| model | F1 | error, m |\n|---|---:|---:|\n| ours | **0.98** | 1.25 |\n| mesh | 0.97 | 1.5 ± 0.1 |\n"
GROUPED = "| log | model | F1 |\n|---|---|---:|\n| a (5) | x | 0.9 |\n| | y | 0.8 |\n| b (6) | x | 0.7 |\n| | y | 0.75 |\n"
REPEATED = "<!-- results: three -->\n\n| model | F1 |\n|---|---:|\n| best | {} |\n| a figure elsewhere | 2 |\n"


def claimed(claim, table=TABLE):
    return {"docs/a.md": "<!-- results: one -->\n\n" + table, tables.CLAIMS: f"[one]\n{claim}\n"}


BAD = [({"README.md": TABLE}, "without a mark"),
       ({"docs/a.md": "<!-- not compared: -->\n\n" + TABLE}, "reason is missing"),
       ({"docs/how-to/a.md": "<!-- results: four -->\n" + TABLE}, "no commands"),
       ({"docs/a.md": ("<!-- results: one -->\n" + TABLE + "\n") * 2}, "already"),
       (claimed("F1 of mesh > F1 of ours"), "does not hold"),
       (claimed("error of mesh = 1.6"), "does not hold"),
       (claimed("F1 of nobody > 0.5"), "is 0 cells"),
       (claimed("F1 of mesh is best"), "is no relation"),
       (claimed("F1 of */x > F1 of */y", GROUPED), "b/x"),
       ({"docs/a.md": "<!-- results: one -->\n\n" + TABLE, "docs/b.md": REPEATED.format("0.97")}, "0.97 is 0.98 in"),
       ({"docs/a.md": "<!-- results: one -->\n\n" + TABLE, "docs/b.md": REPEATED.format("–")}, "0 figures in"),
       ({tables.CLAIMS: "[one]\nF1 of mesh > 0.5\n"}, "no page has the table 'one'")]
GOOD = {"README.md": "<!-- results: one -->\n\n" + TABLE,
        tables.CLAIMS: "# Claims.\n\n[one]\nF1 of ours > F1 of mesh\nerror of mesh #2 = 0.1\n"
                       "error of mesh / error of ours = 1.2\nF1 of * > 0.9\n\n[two]\nF1 of a/x > F1 of a/y\n",
        "docs/a.md": "<!-- results: two -->\n\n" + GROUPED + "\n| key | default |\n"
                     "|---|---|\n| a | none |\n\n<!-- not compared: set, not measured -->\n" + TABLE,
        "docs/results/b.md": REPEATED.format("1.0"),
        "docs/notebook/a.md": TABLE}


def measure(folder, *options):
    """The exit status of `scripts/results.py` for the example in `folder`, and what it prints."""
    def cells(result):
        for line in (result / "figures").read_text().splitlines():
            row, f1, *error = line.split()
            yield row, "F1", [float(f1)]
            yield row, "error", [float(word) for word in error]

    job = jobs.Job("fake", 'echo run >> "$WORK/runs"\n"$BIN/underbrush" > figures')
    measured = {"one": jobs.Measured((jobs.Part((job,), cells),), absolute={"error": 0.02}),
                "two": jobs.Measured((jobs.Part((jobs.Job("absent", "false", ("nowhere",)),), cells),)),
                "three": jobs.Measured((jobs.Part((jobs.Job("failing", "echo no; exit 3"),), cells),))}
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        status = command.main(measured, folder, [
            "--data", str(folder), "--work", str(folder / "work"), "--bin", str(folder / "bin"), *options])
    return status, out.getvalue()


def try_measuring(folder):
    """Lists what is wrong with the comparison: figures that agree pass, others are noticed, no job is done twice."""
    program, done = folder / "bin/underbrush", folder / "work/jobs/fake/done"
    for path in ("bin", "work", "docs"):
        (folder / path).mkdir()
    (folder / tables.CLAIMS).parent.mkdir(parents=True)
    (folder / "README.md").write_text(GOOD["README.md"])
    (folder / tables.CLAIMS).write_text(GOOD[tables.CLAIMS].partition("[two]")[0])
    (folder / "docs/a.md").write_text("<!-- results: two -->\n\n" + TABLE)
    examples = [(["ours 0.9841 1.27", "mesh 0.9749 1.5 0.1"], 0, "5 figures and 4 claims compared, 0 beyond"),
                (["ours 0.9841 1.27", "mesh 0.9749 1.5 0.1"], 0, "skipped: nowhere is not in"),
                (["ours 0.9841 1.25", "mesh 0.9749 1.5 0.2"], 1, "mesh | error, m: 0.1 -> 0.2"),
                (["ours 0.9859 1.25", "mesh 0.9749 1.5 0.1"], 1, "ours | F1: 0.98 -> 0.9859"),
                (["ours 0.9841 1.25", "mesh 0.9749 1.5"], 1, "2 figures documented, 1 measured"),
                (["ours 0.9751 1.25", "mesh 0.9749 1.7 0.1"], 1, "mesh | error, m: 1.5 -> 1.7"),
                (["ours 0.9751 1.25", "mesh 0.9750 1.5 0.1"], 0, "0 beyond"),
                (["ours 0.9750 1.25", "mesh 0.9750 1.5 0.1"], 1, "the claim 'F1 of ours > F1 of mesh' does not hold"),
                (["ours 0.9841 1.25"], 1, "no command makes the figure in mesh | F1")]
    out = []
    for figures, status, word in examples:
        program.write_text("#!/bin/sh\ncat <<'END'\n" + "\n".join(figures) + "\nEND\n")
        program.chmod(0o755)
        if done.exists():
            os.utime(done, (1, 1))  # older than the program
        for _ in range(2):
            found = measure(folder)
            if found[0] != status or word not in found[1]:
                out.append(f"no '{word}', or not the exit status {status}, of {figures}: {found}")
    runs = (folder / "work/runs").read_text().count("run")
    if runs != len(examples):
        out.append(f"{runs} runs for {len(examples)} programs")
    program.write_text("#!/bin/sh\ncat <<'END'\nours 0.9951 11234.5\nmesh 0.9749 1.5 -0.3\nEND\n")
    os.utime(done, (1, 1))
    measure(folder, "--update")
    page = (folder / "README.md").read_text()
    if "| ours | **1.00** | 11 234.50 |" not in page or "| mesh | 0.97 | 1.5 ± −0.3 |" not in page:
        out.append(f"--update wrote {page}")
    (folder / "docs/a.md").write_text("<!-- results: three -->\n\n" + TABLE)
    found = measure(folder)
    return out if found[0] == 1 and "failing: exit status 3: no" in found[1] else out + [f"no failure in {found}"]


if __name__ == "__main__":
    wrong = rules.in_tree({}, try_measuring)
    if wrong:
        sys.exit("scripts/results.py is wrong:\n" + "\n".join(wrong))
    rules.main(check, BAD, GOOD)
