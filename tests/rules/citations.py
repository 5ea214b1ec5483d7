#!/usr/bin/env python3
"""Checks that every [key] cited in a comment or a text is in docs/references.bib."""
import re

import rules

BIBLIOGRAPHY = "docs/references.bib"
KEY = r"\[([a-z]+\d{2}[a-z]?)\]"


def check(root):
    known = set(re.findall(r"^@\w+\{([^,\s]+),", rules.read(root, BIBLIOGRAPHY), re.MULTILINE))
    out = []
    for path in rules.tracked(root, ".hpp", ".cpp", ".inl", ".py", ".md"):
        if path.startswith("tests/rules/"):
            continue
        text = rules.read(root, path)
        if path.endswith(".py"):
            text = "".join(re.findall(r"#[^\n]*|\n", text))
        elif not path.endswith(".md"):
            _, text = rules.split_cpp(text)
        for line, m in rules.lines_with(KEY, text):
            if m.group(1) not in known:
                out.append(f"{path}:{line}: [{m.group(1)}] is not in {BIBLIOGRAPHY}")
    return out


BIB = {BIBLIOGRAPHY: "@article{deschaud12,\n  title = {},\n}\n"}
BAD = [({**BIB, "src/a.hpp": "/// The floor of [nobody99] §2.\nint f();\n"}, "nobody99"),
       ({**BIB, "docs/a.md": "As in [tallavajhula18].\n"}, "tallavajhula18")]
GOOD = {**BIB, "src/a.cpp": "// [deschaud12] eq. 2\nint g = values[index12];\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
