#!/usr/bin/env python3
"""Checks that sentences stand by themselves. In Markdown: no paragraph opens by leaning on the line before, no line
is longer than 120 columns (rows of tables and lines with an address are as long as they are), no page but those of
docs/notebook tells how things were before, and things do not act as persons: beams do not look, models do not say, and
keyframes do not remember. In C++: no paragraph of a /// comment opens by leaning."""
import re

import rules

CPP = True  # Whether the comments of C++ files are judged, besides the bad examples.
COLUMNS = 120
LEANING = (r"(?:Of(?! course)|That|Those|Likewise|Such|Theirs|Ditto|The others|The latter|The former"
           r"|As (?:above|before|there)|So (?:do|does|did|are|is|has|have)|Nor|Neither|Besides"
           r"|(?:The s|S)ame(?= (?:as|for|holds|of|with|goes|is|are|to|by|against|in)\b|[,.:;]))\b")
LEANING_CPP = r"(?:Of|That|Those|Likewise|Such|Theirs)\b"
HISTORY = (r"\b(?:[Uu]ntil now|[Ff]ormerly|[Pp]reviously|used to be|[Ii]n an earlier version|the first version"
           r"|(?:the|this) issue|issue #?\d+|[Dd]evelopers?|program for development)\b")
MAY_TELL_HISTORY = ("docs/notebook/", "CHANGELOG.md")
THINGS = (r"(?:answer|beam|box|cell|column|draw|element|ellipsoid|fit|fitter|grid|hit|keyframe|label|leaf|leave|log|"
          r"look-up|map|median|mesh|miss|model|node|pass|pixel|point|pose|prior|ray|return|row|scan|score|simulation|"
          r"sub-ray|sum|surface|table|tile|tree|triangle|wall|world)(?:es|s)?")
ACTS = (r"(?:admits?|asks?|believes?|claims?|forgets?|forgot|hopes?|judges?|knew|knows?|notices?|pays?|promises?|"
        r"remembers?|remembered|said|saw|says?|sees?|speaks?|taught|teach(?:es)?|tells?|thinks?|trusts?|votes?|wants?|"
        r"look(?:s|ed)? (?:at|back|for|from|into|up))")
PERSON = (rf"\b{THINGS} (?:(?:that|which|also|then|itself|themselves|never|do not|does not) )?{ACTS}\b"
          r"|\b(?:makes? nothing of|memory of what|in so many judges|knows? nothing)\b")
MAY_PERSONIFY = ("docs/notebook/",)
FENCE = re.compile(r"^\s*(```|~~~)")
ITEM = re.compile(r"^\s*(?:[-*+]|\d+\.)\s+")


def paragraphs(text):
    """Lists (line number, text) of each paragraph or list item; code, comments, headings and tables are left out."""
    out, start, words, fenced = [], 0, [], False
    lines = re.sub(r"<!--.*?-->", lambda m: re.sub(r"[^\n]", " ", m.group()), text, flags=re.DOTALL).split("\n")
    for number, line in enumerate(lines + [""], 1):
        fence = FENCE.match(line)
        ends = fenced or fence or not line.strip() or line.startswith(("|", "#", "    ")) or ITEM.match(line)
        if ends and words:
            out.append((start, " ".join(words)))
            words = []
        if fence:
            fenced = not fenced
        elif not fenced and line.strip() and not line.startswith(("|", "#")):
            if line.startswith("    ") and not words:
                continue
            if not words:
                start = number
            words.append(ITEM.sub("", line).strip(" >"))
    return out


def markdown(path, text):
    out = []
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > COLUMNS and not line.startswith("|") and "://" not in line:
            out.append(f"{path}:{number}: {len(line)} columns, {COLUMNS} are the most")
    for number, words in paragraphs(text):
        opening = re.match(LEANING, words.lstrip("*_("))
        if opening:
            out.append(f"{path}:{number}: opens by leaning on the line before: {words[:60]}")
        history = None if path.startswith(MAY_TELL_HISTORY) else re.search(HISTORY, words)
        if history:
            out.append(f"{path}:{number}: tells how it was, or who did it: '{history.group()}' in {words[:60]}")
        prose = re.sub(r"`[^`]*`", "`", words)
        person = None if path.startswith(MAY_PERSONIFY) else re.search(PERSON, prose, re.IGNORECASE)
        if person:
            out.append(f"{path}:{number}: a thing acts as a person: '{person.group()}'")
    return out


def comments(path, text):
    out, opens = [], True
    for number, line in enumerate(text.split("\n"), 1):
        m = re.search(r"///<?\s?(.*)$", line)
        words = m.group(1).strip() if m else ""
        if words in ("", "\\file"):
            opens = True
            continue
        if (opens or "///<" in line) and re.match(LEANING_CPP, words):
            out.append(f"{path}:{number}: a comment opens by leaning on the line before: {words[:60]}")
        opens = False
    return out


def check(root):
    out = []
    for path in rules.tracked(root, ".md"):
        if "/" not in path or path.startswith("docs/"):
            out += markdown(path, rules.read(root, path))
    if CPP or root != rules.ROOT:
        for path in rules.tracked(root, ".hpp", ".cpp", ".inl"):
            out += comments(path, rules.read(root, path))
    return out


BAD = [({"README.md": "A line.\n\nOf these the first is best.\n"}, "leaning"),
       ({"docs/a.md": "- One.\n- *That it holds.* It does.\n"}, "leaning"),
       ({"docs/a/b.md": "The same as `surface`.\n"}, "leaning"),
       ({"docs/a.md": "word " * 25 + "\n"}, "columns"),
       ({"docs/a.md": "One.\n\nUntil now the mesh\nwas coarse.\n"}, "how it was"),
       ({"docs/notebook/2026-11.md": "Likewise the mesh.\n"}, "leaning"),
       ({"README.md": "A beam looks at\nthe two keyframes.\n"}, "as a person"),
       ({"docs/a.md": "- This is what the models say.\n"}, "as a person"),
       ({"docs/how-to/a.md": "`fit` makes nothing of it.\n"}, "as a person"),
       ({"src/a.hpp": "/// \\file\n/// Of the source below.\n"}, "leaning"),
       ({"src/a.hpp": "/// Adds.\n///\n/// Those that remain are kept.\nint f();\n"}, "leaning"),
       ({"src/a.hpp": "int a;  ///< Likewise, of misses.\n"}, "leaning")]
GOOD = {"README.md": "Of course it works.\n\n| Of | " + "long " * 30 + "|\n\n```sh\nOf this.\n```\n<!-- Of\nthat -->\n",
        "docs/a.md": "The mesh\nOf the log. See https://example.org/" + "a" * 120 + "\n",
        "docs/b.md": "The sensor sees 80 m, the file says so, and you look at beams. Run `model says`.\n",
        "docs/notebook/2026-11.md": "Until now the model said nothing.\n",
        "src/a.hpp": "/// The mesh of the log, and all\n/// Of it. That is said.\nint f();\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
