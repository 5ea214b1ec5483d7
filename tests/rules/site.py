#!/usr/bin/env python3
"""The documentation site builds without a warning: every link of every page, the generated ones among them, leads to a
page and a heading. Skipped with one line where mkdocs-material is not installed and cannot be fetched."""
import os
import pathlib
import shutil
import sys
import tempfile

import rules

sys.path.insert(0, str(rules.ROOT / "scripts"))
import build_site  # noqa: E402  (beside the program that it is part of)
from packages import make_venv  # noqa: E402


def arguments(parser):
    parser.add_argument("--build", required=True, type=pathlib.Path)


def venv_of(options):
    return options.build.resolve() / "docs-venv"


def check(root, options):
    environment = {"UNDERBRUSH_REFERENCE": str(options.build.resolve() / "bin/underbrush-reference")}
    with tempfile.TemporaryDirectory() as folder:
        if root != options.root:
            shutil.copy(rules.ROOT / "mkdocs.yml", root)
            shutil.copytree(rules.ROOT / "docs/site", root / "docs/site", dirs_exist_ok=True)
            for page in ("command-line", "parameters", "sensor-catalogue", "materials"):
                (root / "docs/reference").mkdir(exist_ok=True)
                (root / f"docs/reference/{page}.md").write_text("# Page\n")
        status, text = build_site.build_site(venv_of(options), root, folder, environment)
        if not status:
            fetched = from_elsewhere(pathlib.Path(folder))
            return [f"{name}: loads {url}" for name, url in fetched]
    return [text]


def from_elsewhere(site):
    """What a page would load over the network: scripts, styles, pictures and frames."""
    import re
    loads = re.compile(r'<(?:script|img|iframe|source)[^>]*\ssrc="?(https?:[^"\s>]+)'
                       r'|<link[^>]*rel="?(?:stylesheet|preconnect|icon)[^>]*href="?(https?:[^"\s>]+)')
    for page in sorted(site.rglob("*.html")):
        for m in loads.finditer(page.read_text(encoding="utf-8")):
            yield page.relative_to(site), m[1] or m[2]


INDEX = ("# Top\n\n## Pages\n\n- [One](one.md): a page.\n\n## Reference\n\n"
         + "".join(f"- [{p}](reference/{p}.md): made.\n"
                   for p in ("command-line", "parameters", "sensor-catalogue", "materials")))
BAD = [({"docs/README.md": INDEX, "docs/one.md": "# One\n\n[Two](two.md)\n"}, "two.md"),
       ({"docs/README.md": INDEX, "docs/one.md": "# One\n\n[Two](#two)\n"}, "#two"),
       ({"docs/README.md": INDEX, "docs/one.md": "# One\n", "docs/two.md": "# Two\n"}, "two.md"),
       ({"docs/README.md": INDEX, "docs/one.md": "# One\n\n[Licence](../LICENSE)\n"}, "no such file"),
       ({"docs/README.md": INDEX,
         "docs/one.md": "# One\n\n<script src=\"https://example.org/a.js\"></script>\n"}, "loads https://example.org")]
GOOD = {"LICENSE": "", "docs/README.md": INDEX, "docs/one.md": "# One\n\n[Licence](../LICENSE), [top](README.md#pages)\n"}

if __name__ == "__main__":
    os.environ.pop("UNDERBRUSH_CPP", None)
    here = rules.ROOT / "build" if "--build" not in sys.argv else pathlib.Path(sys.argv[sys.argv.index("--build") + 1])
    if failed := make_venv(here.resolve() / "docs-venv", build_site.REQUIREMENTS):
        print(f"skipped: mkdocs-material cannot be installed: {failed}")
        sys.exit(build_site.NO_VENV)
    rules.main(check, BAD, GOOD, arguments)
