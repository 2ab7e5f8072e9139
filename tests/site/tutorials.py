#!/usr/bin/env python3
"""Runs a tutorial of docs/tutorials as its reader would, and compares what it prints with what the page says it prints.

tutorials.py PROGRAM PAGE [FOLDER]     FOLDER: where to run it, and to leave what it made; else a temporary one

A ```toml block with title="FILE" is that file; a ```sh block is run, in an empty folder with the files beside the page
that the page links; each line of a ```text block stands in what the last ```sh block printed. Words are equal there,
numbers agree within 1 %, or what a comment before the block says (<!-- within 3 % -->), or four of the standard errors beside
them; … stands for any words.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def words(line):
    """The line's words; (a ± b)×10ⁿ becomes three: a, ±, b."""
    line = line.translate(RAISED)
    line = re.sub(r"\((\S+) ± (\S+)\)×10(-?\d+)", r"\1e\3 ± \2e\3", line)
    line = re.sub(r"×10(-?\d+)", r"e\1", line)
    return re.sub(r"[(),]", " ", line).split()


def number(word):
    try:
        return float(word)
    except ValueError:
        return None


def agree(expected, found, relative):
    """Whether two lists of words say the same."""
    if not expected:
        return not found
    if expected[0] == "…":
        return any(agree(expected[1:], found[n:], relative) for n in range(len(found) + 1))
    if not found:
        return False
    e, f = number(expected[0]), number(found[0])
    if e is None or f is None:
        return expected[0] == found[0] and agree(expected[1:], found[1:], relative)
    error = number(found[2]) if len(found) > 2 and found[1] == "±" else None
    if abs(e - f) > max(relative * abs(e), 4.0 * (error or 0.0)):
        return False
    if error is not None and len(expected) > 2 and expected[1] == "±":
        if not 0.2 * error <= number(expected[2]) <= 5.0 * error:  # errors have errors
            return False
        return agree(expected[3:], found[3:], relative)
    return agree(expected[1:], found[1:], relative)


def blocks(text):
    """(language, title, relative tolerance, lines) of every fenced block."""
    fence = re.compile(r"(?:<!-- within ([\d.]+) % -->\n)?^```(\w+)(?: title=\"([^\"]+)\")?\n(.*?)^```$", re.M | re.S)
    for m in fence.finditer(text):
        yield m[2], m[3], float(m[1] or 1.0) / 100.0, m[4]


def run(program, page, folder):
    """Number of commands run and of lines compared; what is wrong ends the program."""
    text = page.read_text(encoding="utf-8")
    for name in re.findall(r"\]\(([\w.-]+)\)", text):
        if not name.endswith(".md"):
            shutil.copy(page.parent / name, folder)
    (folder / "scenes").symlink_to(pathlib.Path(__file__).resolve().parents[2] / "scenes")
    (folder / "bin").mkdir()
    (folder / "bin/photorque").symlink_to(program)
    environment = dict(os.environ, PATH=f"{folder / 'bin'}:{os.environ['PATH']}")
    commands = compared = 0
    printed = None
    for language, title, relative, body in blocks(text):
        if title:
            (folder / title).write_text(body, encoding="utf-8")
        elif language == "sh":
            made = subprocess.run(["bash", "-euo", "pipefail", "-c", body], cwd=folder, env=environment, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            printed = made.stdout
            if made.returncode:
                sys.exit(f"{page.name}: exit status {made.returncode} of\n{body}\n{printed}")
            commands += body.count("photorque ")
        elif language == "text":
            lines = [words(line) for line in printed.splitlines()]
            for line in filter(str.strip, body.splitlines()):
                if not any(agree(words(line), found, relative) for found in lines):
                    sys.exit(f"{page.name}: no line agrees with\n{line}\nin\n{printed}")
                compared += 1
    return commands, compared


def main():
    program, page = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
    if len(sys.argv) > 3:
        folder = pathlib.Path(sys.argv[3])
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        commands, compared = run(program, page, folder.resolve())
    else:
        with tempfile.TemporaryDirectory() as folder:
            commands, compared = run(program, page, pathlib.Path(folder))
    if commands < 1 or compared < 1:
        sys.exit(f"{page.name}: {commands} commands, {compared} lines compared")
    print(f"{page.name}: {commands} commands, {compared} lines as the page says")


if __name__ == "__main__":
    main()
