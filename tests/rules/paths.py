#!/usr/bin/env python3
"""Checks that no tracked file names a path of somebody's machine, and that scripts and build files name no host."""
import re

import rules

PLACE = r"(?<![\w.~$})/-])/(?:work|home|root|tmp|Users|mnt|media|var/tmp)(?:/\w|\b(?=[\s\"'`)]|$))|[A-Z]:\\\\?Users"
HOST = r"\bhttps?://"
NO_HOSTS = (".sh", ".cmake", ".py", ".yaml", ".yml", ".json", "CMakeLists.txt", "Makefile", ".ci/run")


def check(root):
    out = []
    for path in rules.tracked(root):
        try:
            text = rules.read(root, path)
        except UnicodeDecodeError:
            continue  # not text
        patterns = [(PLACE, "a path of one machine")]
        if path.endswith(NO_HOSTS) and not path.startswith(("tests/rules/", "share/")):
            patterns.append((HOST, "a host"))
        for pattern, what in patterns:
            for line, m in rules.lines_with(pattern, text):
                out.append(f"{path}:{line}: {what}: {m.group()}")
    return out


SLASH = "/"  # so that this file is a good example itself
BAD = [({"src/a.cpp": f'open("{SLASH}home/somebody/log.ply");\n'}, "one machine"),
       ({"README.md": f"Run it in {SLASH}tmp/demo.\n"}, "one machine"),
       ({"Makefile": "get:\n\tcurl http://example.org/x\n"}, "a host")]
GOOD = {"docs/a.md": "See https://doi.org/10.1000/1, build/tmp/x and ../home/y, ~/work.\n",
        "a.cpp": "auto home = std::filesystem::temp_directory_path() / \"work\";\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
