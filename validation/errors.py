"""Errors: the user's input, or a case that cannot be made."""


class InputError(Exception):
    """Wrong input; the message is one line: place, value found, value expected."""

    def __init__(self, where, key, found, expected):
        place = f"{where}: " if where else ""
        key = f"{key}: " if key else ""
        super().__init__(f"{place}{key}found {found}, expected {expected}")


class MotionError(Exception):
    """A motion that diverges, or a case for which no visible example was found."""
