#!/usr/bin/env python3
"""Checks that sentences stand by themselves. In Markdown: no paragraph opens by leaning on the line before, no line
is longer than 120 columns (rows of tables and lines with an address are as long as they are), no page but those of
docs/notebook tells how things were before, and things do not act as persons: beams do not look, models do not say, and
keyframes do not remember. In C++ and in help texts: no paragraph of a /// comment opens by leaning, things do not act as
persons in /// comments, and no pronoun is the subject of a sentence whose noun was left out ("One a beam")."""
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
THINGS = (r"(?:answer|beam|box|cell|column|draw|element|ellipsoid|file|fit|fitter|grid|hit|keyframe|label|leaf|leave|log|"
          r"look-up|map|median|mesh|miss|model|node|pass|pixel|point|pose|prior|ray|return|row|scan|score|simulation|"
          r"sub-ray|sum|surface|table|tile|tree|triangle|wall|world)(?:es|s)?")
ACTS = (r"(?:admits?|asks?|believes?|claims?|forgets?|forgot|hopes?|judges?|knew|knows?|notices?|pays?|promises?|"
        r"remembers?|remembered|said|saw|says?|sees?|speaks?|taught|teach(?:es)?|tells?|thinks?|trusts?|votes?|wants?|"
        r"look(?:s|ed)? (?:at|back|for|from|into|up))")
PERSON = (rf"\b{THINGS} (?:(?:that|which|also|only|then|itself|themselves|never|do not|does not) )?{ACTS}\b"
          r"|\b(?:makes? nothing of|memory of what|in so many judges|knows? nothing)\b")
MAY_PERSONIFY = ("docs/notebook/",)
LEFT_OUT = (r"(?:(?:^|[.;:] )(?:One (?:an?|per|that|with|without)|Those|Others|Fewer|None|Neither|As (?:it|a|text|`)|"
            r"So (?:are|do|does|is|near|has|have)|Also)(?= |$|[.,;:])"
            r"|\b(?:says?|see|seen) otherwise\b|\b(?:one|two) an? (?:beam|column|element|instance|ray|row)\b)")
HELP = "tests/cli/golden/"
JUDGED = ("src/", "cli/", "apps/", HELP)
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


def spoken(path, number, words):
    """Lists what is wrong with a paragraph of a comment or of a help text."""
    prose = re.sub(r"`[^`]*`", "`", words)
    found = [(re.search(PERSON, prose, re.IGNORECASE), "a thing acts as a person"),
             (re.search(LEFT_OUT, prose), "a noun is left out")]
    return [f"{path}:{number}: {what}: '{m.group().strip()}' in {words[:60]}" for m, what in found if m]


def comment_paragraphs(text):
    """Lists (line number, text) of each paragraph of the /// comments; one after a member may go on in the next line."""
    out, start, words, after = [], 0, [], False
    for number, line in enumerate(text.split("\n") + [""], 1):
        m = re.search(r"(.*)///(<?)\s?(.*)$", line)
        said = m.group(3).replace("\\file", "").strip() if m else ""
        member = bool(m and m.group(2))
        if words and (not said or m.group(1).strip() or member != after):
            out.append((start, " ".join(words)))
            words = []
        if said:
            start, after = start if words else number, member
            words.append(said)
    return out


def help_texts(path, text):
    """Judges each paragraph of a help text; an option's text is the column right of its name."""
    out, start, words = [], 0, []
    for number, line in enumerate(text.split("\n") + [""], 1):
        m = re.match(r"(?:  \S.*?)?(?:  |^)\s*(\S.*)$", line)
        if words and (not m or not line.startswith("   ")):
            out += spoken(path, start, " ".join(words))
            words = []
        if m:
            start = start if words else number
            words.append(m.group(1))
    return out


def comments(path, text):
    out, opens = [], True
    for number, words in comment_paragraphs(text) if path.startswith(JUDGED) else []:
        out += spoken(path, number, words)
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
    for path in rules.tracked(root, ".txt"):
        if path.startswith(HELP):
            out += help_texts(path, rules.read(root, path))
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
       ({"src/a.hpp": "int a;  ///< Likewise, of misses.\n"}, "leaning"),
       ({"src/a.hpp": "/// Returns what the\n/// beams say of it.\nint f();\n"}, "as a person"),
       ({"apps/a.cpp": "int a;  ///< The pixels that it\n        ///< adds, as the log says.\n"}, "as a person"),
       ({"cli/a.hpp": "/// \\file What a fit remembers.\n"}, "as a person"),
       ({"src/a.hpp": "std::vector<int> a;  ///< One a beam.\n"}, "left out"),
       ({"src/a.inl": "/// Adds beams. Those\n/// without a return are kept.\n"}, "left out"),
       ({HELP + "a.txt": "Options:\n  --a X   What the\n          beams say of it\n"}, "as a person"),
       ({HELP + "a.txt": "Options:\n  --a X   Elements; one a\n          beam\n"}, "left out")]
GOOD = {"README.md": "Of course it works.\n\n| Of | " + "long " * 30 + "|\n\n```sh\nOf this.\n```\n<!-- Of\nthat -->\n",
        "docs/a.md": "The mesh\nOf the log. See https://example.org/" + "a" * 120 + "\n",
        "docs/b.md": "The sensor sees 80 m, the paper says so, and you look at beams. Run `model says`.\n",
        "docs/notebook/2026-11.md": "Until now the model said nothing.\n",
        "src/a.hpp": "/// The mesh of the log, and all\n/// Of it. That is said.\nint f();\n",
        "src/b.hpp": "int a;  ///< Number of beams.\nint b;  ///< `beams say`: one value for each beam.\n",
        "studies/a.hpp": "/// What the beams say.\n",
        HELP + "a.txt": "Options:\n  --beam X   Number of beams\n  --say X    Says the number; there are none\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
