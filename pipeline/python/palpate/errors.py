"""What goes wrong, as exceptions. Each has a message that says what, which value, where, what is allowed and what to do."""

from __future__ import annotations

import re

__all__ = ["Error", "InvalidInput", "FileError", "SolverFailure", "LimitReached"]

_PLACE = re.compile(r"(?P<file>[^'\"\n,]*?[/.][^'\"\n:,]*?)(?:, line (?P<line>\d+)(?:, column [^:]+)?)?: ")


class Error(Exception):
    """Any of the package's own. As far as its message tells them, else None: `file` that is wrong, as it was named;
    `line` of it, from 1; `remedy`, what to do."""

    file: str | None = None
    line: int | None = None
    remedy: str | None = None

    def __init__(self, *args: object) -> None:
        super().__init__(*args)
        message = str(args[0]) if args else ""
        place = _PLACE.match(message)
        if place:
            self.file = place["file"]
            self.line = int(place["line"]) if place["line"] else None
        told = message[place.end() :] if place else message
        parts = re.split(r"; (?!.*; )|(?<=[a-z0-9)\]'])\. (?=[A-Z])", told)
        self.remedy = parts[-1].strip() if len(parts) > 1 else None

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class InvalidInput(Error, ValueError):
    """Something that you can mend."""


class FileError(Error, OSError):
    """A file that cannot be opened, read or written."""


class SolverFailure(Error, ArithmeticError):
    """A computation that did not come to a result."""


class LimitReached(SolverFailure):
    """A limit of time or memory was reached: a second try comes no further."""
