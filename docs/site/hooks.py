"""What mkdocs does not do by itself: it takes the navigation from docs/README.md, adds the pages and the C++ reference
that programs write, and turns links to files outside docs/ into the names of these files.

Two environment variables, which scripts/build_site.py sets, say where the written pages come from:
UNDERBRUSH_REFERENCE is the program underbrush-reference, UNDERBRUSH_CPP the folder of Doxygen's pages. Without the
second there is no C++ reference; without the first the pages must be in docs/."""
import os
import pathlib
import posixpath
import re
import subprocess

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

# The pages of docs/reference/ that underbrush-reference prints.
GENERATED = ("command-line", "parameters", "sensor-catalogue", "materials")
CPP = "reference/cpp/"
CPP_LINE = "- The C++ reference is built by `make docs`."
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^()\s]+)\)")
ITEM = re.compile(r"^(?:-|\d+\.) +\[([^\]]+)\]\(([^()\s]+)\)")


def root_of(config):
    return pathlib.Path(config.config_file_path).resolve().parent


def index_of(config):
    """The text of docs/README.md, with a link to the C++ reference if there is one."""
    text = (root_of(config) / "docs/README.md").read_text(encoding="utf-8")
    return with_cpp(text) if os.environ.get("UNDERBRUSH_CPP") else text


def with_cpp(text):
    return text.replace(CPP_LINE, f"- [C++ library]({CPP}index.html): every public type and function of the modules.")


def on_config(config):
    """The navigation: a section for each heading of the index that has a list of pages."""
    nav, section = [{"Start": "README.md"}], None
    for line in index_of(config).splitlines():
        if line.startswith("## "):
            section = line[3:].strip()
        elif item := ITEM.match(line):
            if section not in nav[-1]:
                nav.append({section: []})
            nav[-1][section].append({item[1].replace("`", ""): item[2]})
    config.nav = nav
    return config


def on_files(files, config):
    """Adds what programs of the build write."""
    for page in GENERATED:
        path = f"reference/{page}.md"
        if not files.get_file_from_path(path):
            program = os.environ.get("UNDERBRUSH_REFERENCE", "underbrush-reference")
            done = subprocess.run([program, page], capture_output=True, text=True, check=False)
            if done.returncode:
                raise PluginError(f"{program} {page} failed: {done.stderr}")
            files.append(File.generated(config, path, content=done.stdout))
    cpp = os.environ.get("UNDERBRUSH_CPP")
    for source in sorted(p for p in pathlib.Path(cpp).rglob("*") if p.is_file()) if cpp else ():
        path = CPP + source.relative_to(cpp).as_posix()
        files.append(File.generated(config, path, abs_src_path=str(source)))
    return files


def on_page_markdown(markdown, page, config, files):
    """A link that leaves docs/ becomes its text and the name of the file within the repository."""
    del files
    root, folder = root_of(config), posixpath.dirname("docs/" + page.file.src_uri)
    if page.file.src_uri == "README.md" and os.environ.get("UNDERBRUSH_CPP"):
        markdown = with_cpp(markdown)

    def inside(match):
        picture, text, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path = posixpath.normpath(posixpath.join(folder, target.partition("#")[0]))
        if path.startswith("docs/"):
            return match[0]
        if picture or not (root / path).exists():
            raise PluginError(f"{page.file.src_uri}: no such file in the repository: {target}")
        return f"`{path}`" if text.strip("`") == path else f"{text} (`{path}`)"

    return LINK.sub(inside, markdown)
