"""Shared by the tests of the module: the program beside it, and folders to compare."""

import csv
import os
import pathlib
import subprocess
import tempfile
import unittest

source = pathlib.Path(os.environ["PHOTORQUE_SOURCE_DIR"])
program = os.environ["PHOTORQUE_PROGRAM"]
nominal = source / "scenes" / "stasis" / "nominal.toml"
attitude = source / "scenes" / "stasis" / "attitude.toml"


def files_of(folder):
    """Name and bytes of every file, without the one line of a summary that may differ."""
    found = {}
    for path in sorted(pathlib.Path(folder).rglob("*")):
        if path.is_file():
            content = path.read_bytes()
            if path.name == "summary.json":
                content = b"\n".join(l for l in content.split(b"\n") if b"wall_time_s" not in l)
            found[path.name] = content
    return found


def rows_of(content):
    """The rows of a CSV file by the names of its columns."""
    lines = [line for line in content.decode().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


class FolderTest(unittest.TestCase):
    """Has a separate folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_program(self, *arguments, keys=None):
        """The program's files by name; with changed keys of its experiment."""
        out = self.folder / "program"
        changes = [word for key, value in (keys or {}).items()
                   for word in ("--set", f"{key}={value}")]
        command = [program, *map(str, arguments), *changes, "--quiet", "--out", str(out)]
        subprocess.run(command, check=True)
        return files_of(out)

    def assert_same_files(self, ours, program_files, least):
        """`ours`: a run of the module, which writes its files."""
        ours.write(self.folder / "module")
        written = files_of(self.folder / "module")
        self.assertGreaterEqual(len(written), least)
        self.assertEqual(sorted(written), sorted(program_files))
        for name, content in written.items():
            self.assertTrue(content == program_files[name], name)
