#!/usr/bin/env python3
"""Checks the length of functions: up to 60 lines, signature included. A longer one gives its reason in a comment
`// long: REASON` above its signature or in its body."""
import re

import rules

LIMIT = 60
REASON = r"//\s*long:\s*\S+"


def header_of(code, brace):
    """(start, text) of what stands before a brace: back to the last ; { } of the same level."""
    at, depth = brace - 1, 0
    while at >= 0:
        c = code[at]
        if c in ")]":
            depth += 1
        elif c in "([":
            depth -= 1
        elif depth <= 0 and c in ";{}":
            break
        at -= 1
    text = code[at + 1:brace]
    return at + 1 + len(text) - len(text.lstrip()), text.strip()


def is_function(header, glued):
    """Whether a brace after this header opens the body of a function."""
    header = re.sub(r"^(\s*#[^\n]*\n)+", "", header)
    if "(" not in header or glued or re.search(r"(^|[^=!<>])=\s*$", header):
        return False
    if re.match(r"(inline\s+)?namespace\b|extern\b\s*$", header):
        return False
    if re.search(r"(?<!operator)=\s*[\w:<>]*\s*$", header) or re.search(r"=\s*\[", header):
        return False
    return not re.match(r"(template\s*<[^{}]*>\s*)?(class|struct|union|enum)\b[^(]*$", header)


def functions(code):
    """(first line, last line) of each function; lambdas and local types belong to theirs."""
    code = re.sub(r"^\s*#[^\n]*(\\\n[^\n]*)*", lambda m: re.sub(r"[^\n]", " ", m.group()), code,
                  flags=re.MULTILINE)
    found, stack = [], []
    for m in re.finditer(r"[{}]", code):
        if m.group() == "}":
            opened = stack.pop() if stack else None
            if opened is not None:
                found.append((code.count("\n", 0, opened) + 1, code.count("\n", 0, m.start()) + 1))
            continue
        inside = any(s is not None for s in stack)
        start, header = header_of(code, m.start())
        glued = m.start() > 0 and (code[m.start() - 1].isalnum() or code[m.start() - 1] in "_>")
        stack.append(start if not inside and is_function(header, glued) else None)
    return found


def check(root):
    out = []
    for path in rules.tracked(root, ".hpp", ".cpp", ".inl"):
        text = rules.read(root, path)
        code, comments = rules.split_cpp(text)
        lines = comments.split("\n")
        for first, last in functions(code):
            above = first - 1
            while above > 0 and re.match(r"\s*//", lines[above - 1]):
                above -= 1
            if last - first + 1 > LIMIT and not re.search(REASON, "\n".join(lines[above:last])):
                out.append(f"{path}:{first}: a function of {last - first + 1} lines, {LIMIT} are enough: "
                           "split it or say why (// long: REASON)")
    return out


LONG = "  x();\n" * 60
BAD = [
    ({"src/a.cpp": "void f(int a) {\n" + LONG + "}\n"}, "62 lines"),
    ({"src/a.cpp": "namespace a {\nstruct B : C {\n  B() : a_{1}, b_(2) {\n" + LONG + "  }\n};\n}\n"}, "a.cpp:3"),
    ({"src/a.cpp": "template <class T>\nauto f(T t) -> int {\n  const auto g = [&] {\n" + LONG + "  };\n}\n"},
     "a.cpp:1"),
    ({"src/a.cpp": "TEST(A, B) {\n" + LONG + "}\n"}, "split it"),
    ({"src/a.cpp": "// long:\nvoid f() {\n" + LONG + "}\n"}, "split it"),
    ({"src/a.cpp": "void f() const noexcept {\n  if (a) {\n" + LONG + "  }\n}\n"}, "64 lines"),
]
GOOD = {"src/a.cpp": "void f() {\n" + LONG[:-14] + "}\n// long: a table\nvoid g() {\n" + LONG + "}\n",
        "src/b.cpp": "class A {\n" + "  void f() { x(); }\n" * 70 + "};\nconst T kTable[] = {\n"
                     + "  {g(1)},\n" * 70 + "};\nnamespace {\n" + "int x();\n" * 70 + "}\n",
        "src/c.hpp": "struct A {\n  int x = f();\n" + "  void g();\n" * 70 + "};\n"}

if __name__ == "__main__":
    rules.main(check, BAD, GOOD)
