"""The program `photorque` in a binary wheel."""

import os
import pathlib
import sys


def main() -> None:
    """Runs the program with this process's arguments, in this process's place."""
    program = pathlib.Path(__file__).resolve().parent / "bin" / "photorque"
    os.execv(program, [str(program), *sys.argv[1:]])
