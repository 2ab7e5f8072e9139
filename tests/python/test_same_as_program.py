"""Every run gives the program's files, byte for byte."""

import pathlib
import unittest

import numpy as np
import photorque
from support import FolderTest, attitude, nominal, rows_of

few_rays = {"trace.rays": 65536}


class SameAsProgram(FolderTest):
    def test_trace(self):
        files = self.run_program("trace", nominal, keys=few_rays)
        traced = photorque.trace(photorque.Experiment(nominal, keys=few_rays))
        self.assert_same_files(traced, files, 10)

    def test_power_and_its_numbers(self):
        keys = few_rays | {"attitude.tilt_deg": 30}
        files = self.run_program("power", nominal, keys=keys)
        power = photorque.power(photorque.Experiment(nominal, keys=keys))
        self.assert_same_files(power, files, 20)
        table = rows_of(files["iv.csv"])
        for column in ("voltage_V", "current_A", "power_W"):
            np.testing.assert_array_equal([float(row[column]) for row in table],
                                          power.curve[column])
        self.assertEqual(power.maxima["power_W"].max(), power.figures["array_power_W"].value)

    def test_torque_map(self):
        keys = {"trace.rays": 65536, "torque_map.tilt_deg": [0, 30], "torque_map.heading_deg": [0, 90]}
        files = self.run_program("torque-map", nominal, keys=keys)
        table = photorque.torque_map(photorque.Experiment(nominal, keys=keys))
        self.assert_same_files(table, files, 5)
        self.assertEqual(table.torque_body_N_m.shape, (2, 2, 3))
        written = table.tables["wrench_table_body"]
        np.testing.assert_array_equal(table.torque_body_N_m[..., 1].ravel(), written["torque_y_N_m"])
        force, torque = table.at(polar_rad=table.polar_rad[1], around_rad=table.around_rad[0])
        np.testing.assert_array_equal(torque, table.torque_body_N_m[0, 1])
        np.testing.assert_array_equal(force, table.force_body_N[0, 1])

    def test_page_of_a_torque_map(self):
        keys = {"trace.rays": 25088, "torque_map.tilt_deg": [0, 30], "torque_map.heading_deg": [0]}
        experiment = photorque.Experiment(nominal, keys=keys)
        files = self.run_program("torque-map", nominal, "--page", keys=keys)
        table = photorque.torque_map(experiment, page=True)
        written = pathlib.Path(table.write_page(self.folder / "own.html")).read_bytes()

        def without_command(page):  # which the page names, and its nonce follows
            return [line for line in page.split(b"\n") if b"photorque torque-map" not in line
                    and b"photorque.torque_map" not in line and b"nonce" not in line]

        self.assertGreater(len(written), 100000)
        self.assertEqual(len(written.split(b"\n")), len(files["page.html"].split(b"\n")))
        self.assertEqual(without_command(written), without_command(files["page.html"]))
        with self.assertRaisesRegex(photorque.InputError, "page=True"):
            photorque.torque_map(experiment).write_page(self.folder / "none.html")

    def test_render(self):
        small = {"trace.rays": 25088, "camera.width": 160, "camera.height": 120}
        rendered = photorque.render(photorque.Experiment(nominal, keys=small))
        files = self.run_program("render", nominal, keys=small)
        written = pathlib.Path(rendered.write(self.folder / "module")).read_bytes()
        self.assertTrue(written == files["render.png"])
        pixels = rendered.pixels
        self.assertEqual((pixels.dtype, pixels.ndim, pixels.shape[2]), (np.uint8, 3, 3))
        self.assertEqual(int.from_bytes(written[16:20], "big"), pixels.shape[1])  # of the PNG
        self.assertEqual(int.from_bytes(written[20:24], "big"), pixels.shape[0])
        self.assertTrue(np.shares_memory(pixels, rendered.pixels))
        self.assertFalse(pixels.flags.writeable)
        self.assertGreater(len(np.unique(pixels.reshape(-1, 3), axis=0)), 200)

    def test_budget(self):
        files = self.run_program("budget", attitude)
        budget = photorque.budget(photorque.Experiment(attitude))
        self.assert_same_files(budget, files, 3)
        sizes = [np.linalg.norm(entry.torque_body_N_m) for entry in budget.entries]
        self.assertEqual(sizes, sorted(sizes, reverse=True))

    def test_propagate(self):
        short = {"propagate.duration_s": 20}
        files = self.run_program("propagate", attitude, "--seed", "7", keys=short)
        motion = photorque.propagate(photorque.Experiment(attitude, keys=short), seed=7)
        self.assert_same_files(motion, files, 5)
        np.testing.assert_array_equal(motion.time_s, motion.recording["t_s"])
        np.testing.assert_allclose(np.linalg.norm(motion.attitude_wxyz, axis=1), 1, rtol=1e-14)
        self.assertEqual(motion.rate_body_rad_s.shape, (len(motion.time_s), 3))

    def test_diagnose(self):
        recorded = photorque.propagate(
            photorque.Experiment(attitude, keys={"propagate.duration_s": 60}))
        recorded.write(self.folder / "recorded")
        recording = self.folder / "recorded" / "recording.csv"
        files = self.run_program("diagnose", attitude, "--recording", recording)
        diagnosis = photorque.diagnose(photorque.Experiment(attitude), [recording])
        self.assertEqual(diagnosis.json.encode(), files["diagnosis.json"])
        self.assertEqual(diagnosis.report_html.encode(), files["report.html"])
        self.assertEqual(diagnosis.improved(self.folder / "module").encode(),
                         files["improved.toml"])
        self.assertIn(diagnosis.verdict, ("consistent", "missing_physics", "unexplained"))

    def test_fit_cell(self):
        text = """[fit]
cells_in_series = 36
[[fit.datasheet]]
short_circuit_A = 5.116
open_circuit_V = 22.05
maximum_A = 4.66
maximum_V = 17.63
"""
        file = self.folder / "fit.toml"
        file.write_text(text)
        files = self.run_program("fit-cell", file)
        fit = photorque.fit_cell(photorque.Experiment(file))
        self.assert_same_files(fit, files, 2)
        self.assertGreater(fit.figures["series_ohm"].value, 0)
