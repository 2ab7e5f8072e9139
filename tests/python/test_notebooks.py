"""The notebooks of docs/notebooks run from top to bottom, and find what they say."""

import importlib.util
import json
import os
import unittest

import numpy as np
from support import source

folder = source / "docs" / "notebooks"


@unittest.skipUnless(importlib.util.find_spec("matplotlib"), "no matplotlib")
class Notebooks(unittest.TestCase):
    def run_notebook(self, name):
        """The variables of a notebook after its last cell."""
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot

        before = os.getcwd()
        self.addCleanup(pyplot.close, "all")
        self.addCleanup(os.chdir, before)
        os.chdir(folder)
        variables = {}
        for cell in json.loads((folder / f"{name}.ipynb").read_text())["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), f"{name}.ipynb {cell['id']}", "exec"), variables)
        return variables

    def test_every_notebook_is_run(self):
        tested = {name.removeprefix("test_") for name in dir(self) if name.startswith("test_")}
        self.assertEqual({path.stem for path in folder.glob("*.ipynb")} - tested, set())

    def test_design(self):
        found = self.run_notebook("design")
        self.assertEqual(found["power_W"].shape, (4, 4))
        # The nominal design is one of the grid.
        self.assertAlmostEqual(found["power_W"][2, 1], float(found["nominal"].power_W), places=6)

    def test_torque_map(self):
        found = self.run_notebook("torque_map")
        self.assertEqual(found["panel"].torque_body_N_m.shape, (2, 4, 3))
        self.assertGreater(found["largest_N_m"], 0)

    def test_day(self):
        found = self.run_notebook("day")
        self.assertEqual(found["motion"].time_s[-1], 3600)
        # Body z of the quaternions leans by the tilt.
        tilt_rad = np.arcsin(np.linalg.norm(found["body_z_lab"], axis=0).max())
        # The largest tilt may lie between two rows.
        largest_deg = float(found["motion"].figures["largest_tilt_deg"])
        self.assertTrue(0.0 <= largest_deg - np.degrees(tilt_rad) < 0.01)

    def test_diagnosis(self):
        answer = self.run_notebook("diagnosis")["answer"]
        self.assertEqual([effect.kind for effect in answer.effects], ["magnetic_dipole"])
        dipole = answer.effects[0].parameters["dipole_A_m2"]
        self.assertTrue((np.abs(dipole["value"] - [0.01, -0.005, 0.008]) < 4 * dipole["standard_error"]).all())
