"""The stubs name what the module has, and mypy reads them."""

import ast
import importlib.util
import pathlib
import subprocess
import sys
import unittest

import photorque
from photorque import _photorque

folder = pathlib.Path(photorque.__file__).parent
stub = ast.parse((folder / "_photorque.pyi").read_text())


def names_in(body):
    found = set()
    for item in body:
        if isinstance(item, (ast.ClassDef, ast.FunctionDef)):
            found.add(item.name)
        elif isinstance(item, ast.AnnAssign):
            found.add(item.target.id)
    return {name for name in found if not name.startswith("_")}


def public(names):
    return {name for name in names if not name.startswith("_")}


class Stubs(unittest.TestCase):
    def test_every_name_of_the_module(self):
        self.assertEqual(names_in(stub.body), public(vars(_photorque)))
        self.assertEqual(set(photorque.__all__) - {"__version__", "Sweep", "progress_bar", "sweep"}, public(vars(_photorque)))

    def test_every_member_of_every_class(self):
        classes = {item.name: item for item in stub.body if isinstance(item, ast.ClassDef)}

        def members(item):
            inherited = set()
            for base in item.bases:
                if base.id in classes:
                    inherited |= members(classes[base.id])
            return inherited | names_in(item.body)

        checked = 0
        for name, item in classes.items():
            if name.startswith("_") or name.endswith("Error"):
                continue
            self.assertEqual(members(item), public(dir(getattr(_photorque, name))), name)
            checked += 1
        self.assertGreater(checked, 10)

    def test_everything_that_is_called_has_a_docstring(self):
        for name in photorque.__all__:
            if not name.startswith("_") and name != "git_hash":
                self.assertTrue(getattr(photorque, name).__doc__, name)

    def test_the_oracle_is_part_of_the_package(self):
        shown = subprocess.run([sys.executable, "-m", "photorque.prove", "--help"], capture_output=True, text=True)
        self.assertIn("--only-make", shown.stdout, shown.stderr)

    @unittest.skipUnless(importlib.util.find_spec("mypy"), "no mypy")
    def test_mypy(self):
        checked = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--exclude", "photorque/prove/", str(folder)],
                                 capture_output=True, text=True, cwd=folder.parent)
        self.assertEqual(checked.returncode, 0, checked.stdout)
