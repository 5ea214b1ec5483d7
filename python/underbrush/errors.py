"""Errors of the package."""
from __future__ import annotations

import sys


class FormatError(ValueError):
    """A file is damaged or not of the expected format. Its text is 'FILE: PLACE: REASON'."""

    def __init__(self, file: object, place: str, reason: str) -> None:
        super().__init__(": ".join(str(part) for part in (file, place, reason) if str(part)))
        self.file, self.place, self.reason = str(file), place, reason


def failed(error: Exception) -> int:
    """Prints the error of a command, in one line, and returns its exit code: 3 for bad data in a file, 4 for the file
    system, and 2 for a caller's mistake or a missing package."""
    print(f"underbrush: {' '.join(str(error).split())}", file=sys.stderr)
    if isinstance(error, FormatError):
        return 3
    return 2 if isinstance(error, (ValueError, ImportError)) else 4
