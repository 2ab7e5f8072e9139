"""Motion and light of one platform: what neither shows alone. tests/diagnosis/joint/make.py makes the recordings."""

import importlib.util
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ.get("PHOTORQUE_PROGRAM", "")
MAKE = pathlib.Path(__file__).parents[1] / "diagnosis/joint/make.py"


def maker():
    spec = importlib.util.spec_from_file_location("make", MAKE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@unittest.skipUnless(PROGRAM, "PHOTORQUE_PROGRAM is not set")
class Together(unittest.TestCase):
    def diagnosed(self, case):
        with tempfile.TemporaryDirectory() as holder:
            maker().main(holder, [case])
            folder = pathlib.Path(holder) / case
            run = subprocess.run([PROGRAM, "diagnose", "experiment.toml", "--recording", "run1.csv.gz", "--holdout",
                                  "run2.csv.gz", "--out", "out", "--quiet", "--threads", "1"],
                                 cwd=folder, capture_output=True, text=True, timeout=600, check=False)  # fmt: skip
            self.assertEqual(run.returncode, 0, run.stderr)
            return json.loads((folder / "out" / "diagnosis.json").read_text())

    def expect(self, diagnosis, verdict, kinds):
        self.assertEqual(diagnosis["verdict"], verdict, diagnosis.get("sentence"))
        self.assertEqual(sorted(e["kind"] for e in diagnosis["effects"]), sorted(kinds))
        return {e["kind"]: e["parameters"] for e in diagnosis["effects"]}

    def expect_numbers(self, fitted, expected):
        for value, sigma, true in zip(fitted["value"], fitted["sigma"], expected, strict=True):
            self.assertLess(abs(value - true), 5.0 * sigma)
            self.assertGreater(sigma, 0.0)

    def test_nothing_is_missing(self):
        self.expect(self.diagnosed("nothing"), "consistent", [])

    def test_a_draught_is_no_tilt(self):
        """Light shows that the platform stands as it is recorded."""
        found = self.expect(self.diagnosed("draught"), "missing_physics", ["room_draft"])
        self.expect_numbers(found["room_draft"]["torque_lab_N_m"], [2.5e-5, -1.5e-5, 1.0e-5])

    def test_a_cell_is_no_tilt(self):
        self.expect(self.diagnosed("cell"), "missing_physics", ["cell_degraded"])
