"""Torques written in Python act as the library's own."""

import unittest

import numpy as np
import photorque


def platform(*disturbances):
    return photorque.Experiment({
        "platform": {"topology": "tabletop", "mass_kg": 7.0,
                     "inertia_kg_m2": np.diag([0.11, 0.12, 0.19])},
        "environment": {"gravity_m_s2": 9.80665},
        "disturbance": [{"kind": "static_unbalance", "offset_m": [2e-6, 0, -3e-5]}, *disturbances],
        "propagate": {"duration_s": 30, "initial_tilt_deg": 2.0,
                      "initial_rate_rad_s": [0.01, 0.0, 0.2]},
    })


def drag(time_s, attitude_wxyz, rate_body_rad_s):
    return -2e-3 * rate_body_rad_s


class OwnTorque(unittest.TestCase):
    def test_drag_in_python_is_the_drag_of_the_catalogue(self):
        ours = photorque.propagate(platform(), torques={"mine": drag})
        theirs = photorque.propagate(platform({"kind": "bearing_drag", "coefficient_N_m_s": 2e-3}))
        np.testing.assert_allclose(ours.rate_body_rad_s, theirs.rate_body_rad_s, rtol=0, atol=1e-12)
        np.testing.assert_allclose(ours.attitude_wxyz, theirs.attitude_wxyz, rtol=0, atol=1e-11)
        self.assertIn("torque_mine_x_N_m", ours.history)
        without = photorque.propagate(platform())
        self.assertGreater(np.abs(ours.rate_body_rad_s - without.rate_body_rad_s).max(), 1e-3)

    def test_a_constant_torque_about_a_fixed_axis_has_a_closed_form(self):
        experiment = photorque.Experiment({
            "platform": {"topology": "free", "mass_kg": 7.0,
                         "inertia_kg_m2": np.diag([0.11, 0.12, 0.19])},
            "environment": {"gravity_m_s2": 0.0},
            "propagate": {"duration_s": 20, "tolerance": 1e-11},
        })

        def about_z(time_s, attitude_wxyz, rate_body_rad_s):
            return np.stack([0 * time_s, 0 * time_s, 1e-4 * np.cos(0.3 * time_s)], axis=1)

        motion = photorque.propagate(experiment, torques={"about_z": about_z})
        expected = 1e-4 / 0.19 * np.sin(0.3 * motion.time_s) / 0.3
        np.testing.assert_allclose(motion.rate_body_rad_s[:, 2], expected, rtol=0, atol=1e-12)

    def test_the_provenance_names_it(self):
        motion = photorque.propagate(platform(), torques={"mine": drag})
        self.assertIn("torque mine", motion.provenance["inputs"])

    def test_what_it_raises_reaches_the_caller(self):
        def broken(time_s, attitude_wxyz, rate_body_rad_s):
            raise KeyError("broken")

        with self.assertRaises(KeyError):
            photorque.propagate(platform(), torques={"broken": broken})

    def test_wrong_shapes_and_numbers_are_refused(self):
        for wrong in (lambda t, q, w: np.zeros(3), lambda t, q, w: np.full((len(t), 3), np.nan)):
            with self.assertRaisesRegex(ValueError, "torque \"wrong\""):
                photorque.propagate(platform(), torques={"wrong": wrong})
