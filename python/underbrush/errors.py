"""Errors of the package."""
from __future__ import annotations


class FormatError(ValueError):
    """A file is damaged or not of the expected format. Its text is 'FILE: PLACE: REASON'."""

    def __init__(self, file: object, place: str, reason: str) -> None:
        super().__init__(": ".join(str(part) for part in (file, place, reason) if str(part)))
        self.file, self.place, self.reason = str(file), place, reason
