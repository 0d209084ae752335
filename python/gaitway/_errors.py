"""What goes wrong, and the way out."""

from __future__ import annotations


class Error(Exception):
    """Something that gaitway cannot do.

    ``message`` says what, where and with which value; of a scenario it names file, line and key. ``hint`` says what to do about
    it, or is ``None`` where the message says that itself. ``str(error)`` has both.
    """

    message: str
    hint: str | None

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message, hint)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        if not self.hint or self.hint in self.message:
            return self.message
        return f"{self.message}\nhint: {self.hint}"


class BadValue(Error, ValueError):
    """A value, in an argument or in a scenario, that is not allowed."""
