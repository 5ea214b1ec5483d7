"""The Markdown tables of the documentation: which hold figures, how they are marked, and what is claimed of them.

A comment directly before a table says what becomes of it:

  <!-- results: NAME -->          `scripts/results.py` makes the table NAME anew and compares every figure
  <!-- not compared: REASON -->

claims.txt has what is claimed of each table, below `[NAME]`: a line a claim, such as `F1 of sharp > F1 of mesh`. A
claim is a relation of two terms (< > <= >= =). A term is a number or a figure, or several with × or / between, all
words parted by spaces. A figure is `COLUMN of ROW` or `ROW of COLUMN`; `#2` after it takes the second figure of the
cell. Labels may be shortened to a beginning that is unique. A heading `GROUP: LABEL` gives its group to the headings
after it. Where the first column holds names of groups over empty cells, a row is GROUP/LABEL. `*` stands for every
label, or in `*/LABEL` for every group, the same one on both sides. `=` asks for as many digits as its right side has.
"""
import dataclasses
import operator
import pathlib
import re

NUMBER = re.compile(r"(?<![\w.])(?P<number>[−-]?(?:\d{1,3}(?:[  ]\d{3})+|\d+)(?:\.\d+)?)(?:\s?(?P<unit>%|M\b))?(?![\w⁰-⁹])")
UNITS = {None: 1.0, "%": 0.01, "M": 1e6}
MARK = re.compile(r"<!--\s*(?P<kind>results|not compared):\s*(?P<text>.*?)\s*-->\s*\Z", re.DOTALL)
RELATIONS = {"<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge}
HEADING = "heading"  # the label of the row of headings
CLAIMS = "scripts/documented/claims.txt"


def claims_of(root):
    """{name of a table: its claims} of a tree."""
    out, path = {}, pathlib.Path(root) / CLAIMS
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        if name := re.fullmatch(r"\[(.+)\]", line.strip()):
            claims = out.setdefault(name[1], [])
        elif line.strip() and not line.startswith("#"):
            claims.append(line.strip())
    return out


@dataclasses.dataclass(frozen=True)
class Figure:
    """A printed number: its value, and half a unit of its last digit."""
    value: float
    half_unit: float
    text: str


def figures(cell):
    """Lists the figures of a cell in order."""
    out = []
    for m in NUMBER.finditer(cell.replace("*", "")):
        digits = re.sub(r"[  ]", "", m["number"]).replace("−", "-")
        scale = UNITS[m["unit"]]
        decimals = len(digits.partition(".")[2])
        out.append(Figure(float(digits) * scale, 0.5 * 10 ** -decimals * scale, m.group().strip()))
    return out


def with_numbers(cell, numbers):
    """A cell with other values in the place of its last figures, with as many decimals each."""
    found = list(NUMBER.finditer(cell))[-len(numbers):]
    for m, number in reversed(list(zip(found, numbers))):
        text = f"{abs(number) / UNITS[m['unit']]:.{len(m['number'].partition('.')[2])}f}"
        whole, dot, rest = text.partition(".")
        if len(whole) > 4:
            whole = f"{int(whole):,}".replace(",", " ")
        sign = "−" if number < 0 and float(text) else ""
        cell = cell[:m.start("number")] + sign + whole + dot + rest + cell[m.end("number"):]
    return cell


def plain(cell):
    return re.sub(r"[*`]", "", cell).strip()


def begins(label, words):
    """Whether `words` is a beginning of the label that ends with a word."""
    return label.startswith(words) and not re.match(r"[\w.]", label[len(words):])


def holds_figures(rows):
    return any(re.match(r"[*]*[−-]?\d", cell) for row in rows for cell in row[1:])


class Table:
    """A table of a page with its mark. Rows and columns count from 0; row −1 is that of the headings."""

    def __init__(self, line, mark, headings, rows, claims):
        self.line, self.headings, self.rows = line, headings, rows
        self.kind = mark["kind"] if mark else None
        words = " ".join(mark["text"].split()) if mark else ""
        self.name = words if self.kind == "results" else None
        self.reason = words if self.kind == "not compared" else None
        self.claims = claims.get(self.name, [])
        self.has_figures = holds_figures(rows)
        self._name_rows()
        self._name_columns()

    def _name_rows(self):
        """Labels of each row, the likeliest first: the first cells, one, two or more, and GROUP/LABEL."""
        self.groups, self.row_labels, group = [], [], None
        grouped = any(not plain(row[0]) for row in self.rows)
        for row in self.rows:
            cells = [plain(cell) for cell in row]
            if grouped:
                group = cells[0] or group
                if group not in self.groups:
                    self.groups.append(group)
                self.row_labels.append([f"{group}/{cells[1]}"])
            else:
                self.row_labels.append([", ".join(cells[:n]) for n in range(1, len(cells) + 1)])

    def _name_columns(self):
        self.column_labels, group = [], None
        for heading in map(plain, self.headings):
            before, colon, own = heading.partition(":")
            if colon:
                group = before
                self.column_labels.append([heading, own.strip()])
            else:
                self.column_labels.append([heading] + ([f"{group}: {heading}"] if group else []))

    @staticmethod
    def _find(labels, words, same):
        for k in range(max(map(len, labels), default=0)):
            found = [i for i, names in enumerate(labels) if k < len(names) and same(names[k], words)]
            if found:
                return found[0] if len(found) == 1 else None
        return None

    def row(self, words):
        """The number of the row with this label or a beginning of it; None if there is none or several."""
        if words == HEADING:
            return -1
        found = self._find(self.row_labels, words, operator.eq)
        if found is None and self.groups and "/" in words:
            group, _, own = words.partition("/")
            return self._find(self.row_labels, own, lambda label, own: begins(label, group)
                              and any(label == f"{g}/{own}" for g in self.groups))
        return found if found is not None else self._find(self.row_labels, words, begins)

    def column(self, words):
        """The number of the column with this label or a beginning of it; None if there is none or several."""
        found = self._find(self.column_labels, words, operator.eq)
        return found if found is not None else self._find(self.column_labels, words, begins)

    def cell(self, row, column):
        return (self.headings if row < 0 else self.rows[row])[column]

    def place(self, row, column):
        return f"{HEADING if row < 0 else self.row_labels[row][0]} | {self.column_labels[column][0]}"

    def cells_with_figures(self):
        """Lists (row, column) of the cells that begin with a figure, apart from the first column."""
        return [(r, c) for r, row in enumerate(self.rows) for c, cell in enumerate(row)
                if c > 0 and re.match(r"[*]*[−-]?\d", cell)]


def tables(text, claims=None):
    """Lists the tables of a page; `claims` are those of `claims_of`."""
    out, lines, fenced, at = [], text.split("\n"), False, 0
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)

    def cells(line):
        return [cell.strip() for cell in line.strip().strip("|").split("|")]

    while at < len(lines):
        if re.match(r"\s*(```|~~~)", lines[at]):
            fenced = not fenced
        if fenced or not lines[at].startswith("|") or at + 1 == len(lines) \
                or not re.fullmatch(r"\|[\s|:-]+\|?\s*", lines[at + 1]):
            at += 1
            continue
        end = at + 2
        while end < len(lines) and lines[end].startswith("|"):
            end += 1
        before = text[:starts[at]]
        mark = MARK.search(before[max(before.rfind("<!--"), 0):])
        headings = cells(lines[at])
        rows = [(cells(line) + [""] * len(headings))[:len(headings)] for line in lines[at + 2:end]]
        out.append(Table(at + 1, mark, headings, rows, claims or {}))
        at = end
    return out


def with_cells(text, table, cells):
    """A page with other cells, {(row, column): text}, in one of its tables."""
    lines = text.split("\n")
    for (row, column), cell in cells.items():
        at = table.line + 1 + row if row >= 0 else table.line - 1
        parts = lines[at].split("|")
        parts[column + 1] = f" {cell} "
        lines[at] = "|".join(parts)
    return "\n".join(lines)


class Unknown(ValueError):
    """A claim that names no cell, or several."""


def _figure(table, words, value_of):
    """The value of `COLUMN of ROW` or `ROW of COLUMN`; value_of(row, column, n) is the n-th figure of a cell."""
    m = re.fullmatch(r"(.*?)(?:\s+#(\d+))?", words.strip())
    words, n = m[1], int(m[2] or 1) - 1
    parts, found = words.split(" of "), set()
    for k in range(1, len(parts)):
        left, right = " of ".join(parts[:k]).strip(), " of ".join(parts[k:]).strip()
        for row, column in ((right, left), (left, right)):
            place = table.row(row), table.column(column)
            if None not in place:
                found.add(place)
    if len(found) != 1:
        raise Unknown(f"'{words}' is {len(found)} cells")
    return value_of(*found.pop(), n)


def _term(table, words, value_of):
    value, operation = None, None
    for word in re.split(r" ([×/]) ", words.strip()):
        if word in "×/":
            operation = word
            continue
        number = figures(word)
        if number and number[0].text == word.strip():
            factor = number[0].value
        else:
            factor = _figure(table, word, value_of)
        value = factor if value is None else value * factor if operation == "×" else value / factor
    return value


def _holds(table, claim, value_of):
    m = re.fullmatch(r"(.*?) (<=|>=|<|>|=) (.*)", claim)
    if not m:
        raise Unknown(f"'{claim}' is no relation")
    left, right = _term(table, m[1], value_of), _term(table, m[3], value_of)
    if m[2] == "=":
        printed = figures(m[3])
        return abs(left - right) <= (printed[0].half_unit if printed else 0) * (1 + 1e-6), left, right
    return RELATIONS[m[2]](left, right), left, right


def _cases(table, claim):
    """The claim with each label in the place of `*`."""
    if not re.search(r"(?<!\S)\*(?=[/\s]|$)", claim):
        return [claim]
    if re.search(r"(?<!\S)\*/", claim):
        labels = [re.sub(r" \(.*\)$", "", group) for group in table.groups]
        return [re.sub(r"(?<!\S)\*/", lambda _: f"{label}/", claim) for label in labels]
    out = []
    for labels in (table.row_labels, table.column_labels[1:]):
        for names in labels:
            case = re.sub(r"(?<!\S)\*(?!\S)", lambda _: names[0], claim)
            try:
                _holds(table, case, lambda *_: 1.0)
                out.append(case)
            except Unknown:
                continue
        if out:
            break
    return out


def broken_claims(table, value_of=None):
    """Lists the claims of the table that do not hold. `value_of(row, column, n)` gives figures in place of the
    documented ones."""
    def documented(row, column, n):
        numbers = figures(table.cell(row, column))
        if n >= len(numbers):
            raise Unknown(f"{table.place(row, column)} has no figure {n + 1}")
        return numbers[n].value

    out = []
    for claim in table.claims:
        cases = _cases(table, claim)
        if not cases:
            out.append(f"the claim '{claim}' is about no cell")
        for case in cases:
            try:
                holds, left, right = _holds(table, case, value_of or documented)
            except Unknown as error:
                out.append(f"the claim '{case}' cannot be read: {error}")
                continue
            if not holds:
                out.append(f"the claim '{case}' does not hold: {left:.6g} and {right:.6g}")
    return out
