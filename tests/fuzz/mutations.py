"""Ways to damage a file. `mutate` takes the bytes of a good file and its form, and returns a damaged one; the same
random numbers give the same damage."""
import json
import re
import struct

NUMBERS = ["0", "-1", "1", "-0", "1e-300", "1e300", "1e999", "-1e999", "nan", "-nan", "inf", "-inf", "", "0x10", "1e",
           "4294967295", "4294967296", "2147483647", "2147483648", "-2147483649", "9223372036854775807",
           "9223372036854775808", "18446744073709551615", "18446744073709551616", "99999999999999999999999999",
           "0.1.2", "1,5", "65535", "65536", "255", "256", "1000000", "1e9", "-1e-9", "1e16"]
NAMES = ["", " ", "a" * 5000, "\x1b[2J\x1b[31mred\x07", "a\nb", "a\rb", "a\tb", "\x00", "\x7f", "\u202egnp.exe",
         "\u00a0", "%s%n%d", "%69", "%", "x y", "\"", "'", "\\", "{}", "[]", "null", "true", "~", "*a", "&a",
         "!!python/x", "- -", "..", ".", "/", "../model", "../../../../../..", "/dev/zero", "/dev/full", "/dev/null",
         "/dev/stdin", "/proc/self/mem", "/etc", "no/such/file", "a//b", "file:///dev/zero", "data:,",
         "data:;base64,@@@@", "%2e%2e/tree.bin", "\ud83d\ude00", "\u00e9"]
VALUES = [None, True, False, 0, -1, 1, 0.5, 1e-300, 1e300, 2**31, 2**32, 2**63, 2**64, -2**63, 10**30, [], {}, "", [[]],
          [None], [0] * 3, [0, 0, 0, 0], ["a"], {"a": 1}, float("nan"), float("inf"), "0", "nan"]
LARGEST = 1 << 20  # bytes of a mutant
DEEP = "many lists in each other"
TOKEN = re.compile(rb"[^\s,;:=\[\]{}\"']+")
DECIMAL = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")


def encoded(text):
    return text.encode("utf-8", "surrogatepass")


# Damage to bytes, whatever they mean.

def flip_bits(data, rng, _):
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4, 16))):
        if data:
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(data)


def set_bytes(data, rng, _):
    data = bytearray(data)
    if data:
        at, value = rng.randrange(len(data)), rng.choice((0, 1, 0x7F, 0x80, 0xFF, 0x0A, 0x20))
        for k in range(at, min(len(data), at + rng.choice((1, 1, 2, 4, 8)))):
            data[k] = value
    return bytes(data)


def insert_bytes(data, rng, _):
    at = rng.randrange(len(data) + 1)
    return data[:at] + rng.randbytes(rng.choice((1, 1, 2, 3, 7, 64))) + data[at:]


def a_part(data, rng):
    at = rng.randrange(len(data) + 1)
    return at, min(len(data), at + rng.choice((1, 1, 2, 4, 13, 64, 500)))


def delete_bytes(data, rng, _):
    at, end = a_part(data, rng)
    return data[:at] + data[end:]


def duplicate_bytes(data, rng, _):
    at, end = a_part(data, rng)
    return data[:end] + data[at:end] * rng.choice((1, 1, 2, 50)) + data[end:]


def truncate(data, rng, _):
    return data[:rng.choice((0, 1, rng.randrange(len(data) + 1), max(0, len(data) - rng.randrange(1, 20))))]


def append(data, rng, others):
    return data + rng.choice((b"\n", b"\0", b"\xff" * 100, b"\n" * 1000, data, rng.choice(others)[:2000]))


def splice(data, rng, others):
    other = rng.choice(others)
    at, there = rng.randrange(len(data) + 1), rng.randrange(len(other) + 1)
    end, length = rng.choice((at, rng.randrange(at, len(data) + 1))), rng.choice((4, 40, 400, len(other)))
    return data[:at] + other[there:there + length] + data[end:]


def whole_other(_, rng, others):
    return rng.choice(others)


def real_numbers(data, rng, _):
    """Puts a strange number where one of 1 to 8 bytes may stand."""
    value = rng.choice((b"\x00\x00\xc0\x7f", b"\x00\x00\x80\x7f", b"\x00\x00\x80\xff", b"\xff" * 4, b"\xff" * 8,
                        b"\x00" * 8, b"\xff\xff\xff\x7f", b"\x00" * 6 + b"\xf8\x7f", b"\x00" * 6 + b"\xf0\x7f",
                        b"\xff\xff\x7f\x7f", b"\xff" * 6 + b"\xef\x7f", b"\x01\x00\x00\x00", b"\x00\x00\x00\x80",
                        b"\xff" * 7 + b"\x7f", b"\x00\x00\x80\x3f"))
    at = rng.randrange(max(1, len(data) - len(value) + 1))
    return data[:at] + value + data[at + len(value):]


def nudge_real(data, rng, _):
    """Changes four bytes that may be a float to another number of its order."""
    at = rng.randrange(max(1, len(data) - 3))
    (value,) = struct.unpack("<f", data[at:at + 4].ljust(4, b"\0"))
    if not 1e-6 < abs(value) < 1e6:
        return data
    return data[:at] + struct.pack("<f", value * rng.choice((-1, 0, 0.5, 2, 1000, 1e-6, 1e12))) + data[at + 4:]


# Damage to text.

def lines_of(data):
    return data.split(b"\n")


def drop_line(data, rng, _):
    lines = lines_of(data)
    del lines[rng.randrange(len(lines))]
    return b"\n".join(lines)


def double_line(data, rng, _):
    lines = lines_of(data)
    at = rng.randrange(len(lines))
    return b"\n".join(lines[:at + 1] + lines[at:at + 1] * rng.choice((1, 1, 2, 30)) + lines[at + 1:])


def swap_lines(data, rng, _):
    lines = lines_of(data)
    a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def line_of_other(data, rng, others):
    lines = lines_of(data)
    lines.insert(rng.randrange(len(lines) + 1), rng.choice(lines_of(rng.choice(others)[:5000])))
    return b"\n".join(lines)


def indent_line(data, rng, _):
    lines = lines_of(data)
    at = rng.randrange(len(lines))
    lines[at] = rng.choice((b"  ", b"\t", b"- ", b"#", b" " * 300)) + lines[at]
    return b"\n".join(lines)


def line_ends(data, rng, _):
    return data.replace(b"\n", rng.choice((b"\r\n", b"\r", b"\n\n", b" ", b"\0\n")))


def replace_match(pattern, data, rng, value):
    found = list(pattern.finditer(data))
    if not found:
        return data
    m = rng.choice(found)
    return data[:m.start()] + value(m.group()) + data[m.end():]


def replace_number(data, rng, _):
    return replace_match(DECIMAL, data, rng, lambda _: encoded(rng.choice(NUMBERS)))


def nudge_number(data, rng, _):
    def nudged(number):
        value = float(number)
        if value == int(value) if abs(value) < 1e15 else False:
            return str(int(value) + rng.choice((-1, 1, 2, 100))).encode()
        return repr(value * rng.choice((-1, 0.5, 2, 1000, 1e-6))).encode()
    return replace_match(DECIMAL, data, rng, nudged)


def replace_token(data, rng, _):
    return replace_match(TOKEN, data, rng, lambda _: encoded(rng.choice(NAMES)))


def drop_token(data, rng, _):
    return replace_match(TOKEN, data, rng, lambda _: b"")


def double_token(data, rng, _):
    return replace_match(TOKEN, data, rng, lambda t: t + rng.choice((b" ", b",", b"")) + t)


def swap_tokens(data, rng, _):
    found = list(TOKEN.finditer(data))
    if len(found) < 2:
        return data
    a, b = sorted(rng.sample(found, 2), key=lambda m: m.start())
    return data[:a.start()] + b.group() + data[a.end():b.start()] + a.group() + data[b.end():]


def nest_token(data, rng, _):
    n = rng.choice((100, 100000))
    return replace_match(TOKEN, data, rng, lambda _: b"[" * n + b"]" * n)


def token_of_other(data, rng, others):
    tokens = TOKEN.findall(rng.choice(others)[:5000]) or [b""]
    return replace_match(TOKEN, data, rng, lambda _: rng.choice(tokens))


BYTES = [flip_bits, flip_bits, set_bytes, insert_bytes, delete_bytes, duplicate_bytes, truncate, append, splice,
         whole_other, real_numbers, real_numbers, nudge_real, nudge_real, nudge_real]
TEXT = [drop_line, double_line, swap_lines, line_of_other, indent_line, line_ends, replace_number, replace_number,
        replace_number, nudge_number, nudge_number, replace_token, replace_token, drop_token, double_token,
        swap_tokens, token_of_other, nest_token]


# Damage to JSON that stays JSON.

def places(value):
    """Lists (container, key) of every value within a JSON value."""
    found, todo = [], [value]
    while todo:
        one = todo.pop()
        pairs = one.items() if isinstance(one, dict) else enumerate(one) if isinstance(one, list) else ()
        for key, inner in pairs:
            found.append((one, key))
            todo.append(inner)
    return found


def strange_value(old, rng, found):
    if isinstance(old, str) and rng.random() < 0.7:
        return rng.choice(NAMES)
    if isinstance(old, (int, float)) and rng.random() < 0.4:
        return rng.choice((old + 1, old - 1, -old, old * 1000, old * 1e-6))
    if rng.random() < 0.2:
        container, key = rng.choice(found)
        return container[key]
    return rng.choice(VALUES)


def mutate_json(data, rng, _):
    try:
        root = json.loads(data)
    except (ValueError, RecursionError):
        return data
    found = places(root)
    if not found:
        return data
    container, key = rng.choice(found)
    what, old = rng.choice(("set", "set", "set", "drop", "double", "rename")), container[key]
    if what == "set":
        container[key] = DEEP if rng.random() < 0.02 else strange_value(old, rng, found)
    elif what == "drop":
        del container[key]
    elif isinstance(container, list):
        container[key:key] = [old] * (rng.choice((1, 1, 100)) if len(data) < 100000 else 1)
    else:
        if what == "rename":
            del container[key]
        container[rng.choice(NAMES + [str(key) + "x"])] = old
    try:
        # Half a surrogate pair goes into the file as it is, which is not UTF-8.
        text = json.dumps(root, ensure_ascii=rng.random() < 0.5, indent=1)
        n = rng.choice((300, 5000, 200000))
        return encoded(text.replace(f'"{DEEP}"', "[" * n + "]" * n))
    except (ValueError, RecursionError):
        return data


def deep_json(_, rng, __):
    n = rng.choice((100, 10000, 200000))
    return b"[" * n + b"]" * rng.choice((0, n)) if rng.random() < 0.5 else b'{"a":' * n


def deep_yaml(_, rng, __):
    n = rng.choice((50, 1000, 20000))
    return rng.choice((b"name: " + b"[" * n, b"name: " + b"[" * n + b"]" * n, b"- " * n, b"{a: " * n,
                       b"a: &a [x,x,x,x]\nb: &b [*a,*a,*a,*a]\nname: *b\n"))


JSON = [mutate_json] * 12 + [deep_json]
YAML = [deep_yaml]


def glb_chunks(data, rng, others):
    """Damages the JSON of a GLB file and writes the lengths anew."""
    length = int.from_bytes(data[12:16], "little")
    text = mutate_json(data[20:20 + length].rstrip(b" "), rng, others)
    text += b" " * (-len(text) % 4)
    rest = data[20 + length:]
    total = 20 + len(text) + len(rest)
    return data[:8] + total.to_bytes(4, "little") + len(text).to_bytes(4, "little") + data[16:20] + text + rest


def on_header(change, end):
    """Returns the change applied to the text up to the end of a header, and not to the numbers behind it."""
    def changed(data, rng, others):
        m = end.search(data)
        cut = m.end() if m else min(len(data), 300)
        return change(data[:cut], rng, others) + data[cut:]
    return changed


HEADER_END = re.compile(rb"end_header\n|DATA binary\w*\n|\(5,\), \}[ ]*\n")
FORMS = {
    "bytes": BYTES,
    "text": TEXT * 2 + BYTES,
    "header": [on_header(change, HEADER_END) for change in TEXT] + BYTES * 2,
    "json": JSON * 4 + TEXT + BYTES,
    "yaml": YAML + TEXT * 2 + BYTES,
    "glb": [glb_chunks] * 12 + BYTES,
}


def mutate(data, form, rng, others):
    """Returns damaged bytes: one to four changes of the form's kind, one after the other."""
    for _ in range(100):
        out = data
        for _ in range(rng.choice((1, 1, 1, 1, 2, 2, 4))):
            out = rng.choice(FORMS[form])(out, rng, others)[:LARGEST]
        if out != data:
            break
    return out
