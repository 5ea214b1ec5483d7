"""What mkdocs does not do by itself: it takes the navigation from docs/README.md, adds the pages and the C++ reference
that programs write, and turns links to files outside docs/ into their names."""
import os
import pathlib
import posixpath
import re
import subprocess

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("BUILD") or "build")
# Page and the word for which underbrush-reference prints it.
GENERATED = {"command-line": "command-line", "parameters": "parameters", "sensor-catalogue": "sensors",
             "materials": "materials"}
CPP = "reference/cpp/"
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^()\s]+)\)")
ITEM = re.compile(r"^(?:-|\d+\.) +\[([^\]]+)\]\(([^()\s]+)\)")


def on_config(config):
    """The navigation: a section for each heading of the index that has a list of pages."""
    nav, section = [{"Start": "README.md"}], None
    for line in (ROOT / "docs/README.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            section = line[3:].strip()
        elif item := ITEM.match(line):
            if section not in nav[-1]:
                nav.append({section: []})
            nav[-1][section].append({item[1]: item[2]})
        elif section == "Reference" and "C++" in line:
            nav[-1][section].append({"C++ library": CPP + "index.html"})
    config.nav = nav
    return config


def on_files(files, config):
    """Adds what is written by programs of the build."""
    program = ROOT / BUILD / "bin/underbrush-reference"
    for page, word in GENERATED.items():
        path = f"reference/{page}.md"
        if not files.get_file_from_path(path):
            done = subprocess.run([program, word], capture_output=True, text=True, check=False)
            if done.returncode:
                raise PluginError(f"{program} {word}: {done.stderr}")
            files.append(File.generated(config, path, content=done.stdout))
    cpp = ROOT / BUILD / "docs/html"
    for source in sorted(p for p in cpp.rglob("*") if p.is_file()):
        path = CPP + source.relative_to(cpp).as_posix()
        files.append(File.generated(config, path, abs_src_path=str(source)))
    return files


def on_page_markdown(markdown, page, config, files):
    """A link that leaves docs/ becomes its text and the name of the file within the repository."""
    folder = posixpath.dirname("docs/" + page.file.src_uri)

    def inside(match):
        picture, text, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path = posixpath.normpath(posixpath.join(folder, target.partition("#")[0]))
        if path.startswith("docs/"):
            return match[0]
        if picture or not (ROOT / path).exists():
            raise PluginError(f"{page.file.src_uri}: no such file in the repository: {target}")
        return f"`{path}`" if text.strip("`") == path else f"{text} (`{path}`)"

    return LINK.sub(inside, markdown)
