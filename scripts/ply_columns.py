"""Reads the columns of a log, a binary ray cloud PLY of one row a beam, without the program."""
import numpy

TYPES = {"double": "<f8", "float": "<f4", "uchar": "u1", "char": "i1", "ushort": "<u2", "short": "<i2", "uint": "<u4",
         "int": "<i4"}


def read(path):
    """Returns the table of the columns, and the range of each beam, m; NaN without a return."""
    with open(path, "rb") as file:
        head, _, body = file.read().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    rows = next(int(words[2]) for words in lines if words[:2] == ["element", "vertex"])
    columns = numpy.dtype([(words[2], TYPES[words[1]]) for words in lines if words[:1] == ["property"]])
    table = numpy.frombuffer(body, columns, rows)
    length = numpy.sqrt(sum(table[axis].astype(float) ** 2 for axis in ("nx", "ny", "nz")))
    return table, numpy.where(table["alpha"] > 0, length, numpy.nan)
