"""The program `photorque` in a binary wheel."""

import os
import pathlib
import sys


def main() -> None:
    """Replaces this process by the program, with the same arguments."""
    program = pathlib.Path(__file__).resolve().parent / "bin" / "photorque"
    os.execv(program, [str(program), *sys.argv[1:]])
