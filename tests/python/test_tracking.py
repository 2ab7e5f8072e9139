"""camera() and estimate(): the program's files, and their numbers as arrays."""

import unittest

import numpy as np
import photorque
from support import FolderTest, rows_of, source

board = source / "scenes" / "stasis" / "camera.toml"


class Tracking(FolderTest):
    def test_camera(self):
        few = {"camera_study.images": 20, "camera_study.grid": 5}
        files = self.run_program("camera", board, keys=few)
        camera = photorque.camera(photorque.Experiment(board, keys=few))
        # The paper's camera, from a board that docs/estimation.md states.
        self.assertAlmostEqual(camera.figures["in_plane_error_arcsec"].value, 12, delta=1)
        self.assertAlmostEqual(camera.figures["out_of_plane_error_arcsec"].value, 37, delta=2)
        self.assertGreater(camera.images_per_s, 160)
        self.assertIn("degradation", camera.tables)
        # The pace is the machine's.
        camera.write(self.folder / "module")
        for name in ("degradation.csv", "images.csv", "markers.csv"):
            self.assertEqual((self.folder / "module" / name).read_bytes(), files[name], name)

    def test_estimate(self):
        short = {"propagate.duration_s": 20, "estimate.runs": 0}
        files = self.run_program("estimate", board, keys=short)
        found = photorque.estimate(photorque.Experiment(board, keys=short))
        self.assert_same_files(found, files, 4)
        smoothed, filtered = found.smoothed(), found.filtered()
        table = rows_of(files["smoothed.csv"])
        np.testing.assert_array_equal([float(row["t_s"]) for row in table], smoothed["t_s"])
        np.testing.assert_allclose([float(row["q_x"]) for row in table],
                                   smoothed["attitude_wxyz"][:, 1], rtol=0, atol=1e-15)
        np.testing.assert_allclose(np.linalg.norm(smoothed["attitude_wxyz"], axis=1), 1, atol=1e-12)
        # All readings say more than those until then, but in the last row.
        self.assertLess(smoothed["attitude_sigma_rad"][0].max(), filtered["attitude_sigma_rad"][0].max())
        np.testing.assert_allclose(smoothed["attitude_sigma_rad"][-1], filtered["attitude_sigma_rad"][-1])
        self.assertEqual(smoothed["rate_sigma_rad_s"].shape, smoothed["rate_body_rad_s"].shape)
        with self.assertRaises(IndexError):
            found.smoothed(1)

    def test_estimate_of_a_recording(self):
        experiment = photorque.Experiment(board, keys={"propagate.duration_s": 10})
        photorque.propagate(experiment).write(self.folder / "flown")
        found = photorque.estimate(experiment, [self.folder / "flown" / "recording.csv"],
                                   truth=self.folder / "flown" / "time_history.csv")
        # The camera reads to 37 arcsec out of the image plane; known torques leave less.
        self.assertLess(found.figures["smoother_error_arcsec"].value, 37)
        self.assertEqual(len(found.smoothed()["t_s"]), 101)
