"""The program `photorque` that a binary wheel carries beside the module."""

import os
import pathlib
import sys


def main() -> None:
    """Runs the program with this process's arguments, in this process's place."""
    program = pathlib.Path(__file__).resolve().parent / "bin" / "photorque"
    os.execv(program, [str(program), *sys.argv[1:]])
