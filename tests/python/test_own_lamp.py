"""Lamps written in Python shine as the library's own."""

import math
import unittest

import numpy as np
import photorque
from support import FolderTest, nominal


def square_model(folder):
    """A black square of 0.2 m at the origin, its front upwards."""
    (folder / "square.obj").write_text(
        "o board\nusemtl black\nv -0.1 -0.1 0\nv 0.1 -0.1 0\nv 0.1 0.1 0\nv -0.1 0.1 0\nf 1 2 3 4\n")
    return {
        "scene": {"file": "square.obj", "unit": "m", "up": "z"},
        "material": [{"name": "black", "absorptance": 1.0}],
        "receiver": [{"node": "board", "bins": [20, 20]}],
        "trace": {"rays": 65536},
    }


def round_beam(points):
    """Parallel light, even over a disc of 50 mm radius."""
    radius_m, around_rad = 0.05 * np.sqrt(points[:, 0]), 2 * math.pi * points[:, 1]
    origin_m = np.stack([radius_m * np.cos(around_rad), radius_m * np.sin(around_rad), 0 * radius_m], axis=1)
    return origin_m, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def cone(points):
    """A point that shines evenly into a cone of 3 deg half angle."""
    cosine = 1 - points[:, 2] * (1 - math.cos(math.radians(3)))
    sine, around_rad = np.sqrt(1 - cosine**2), 2 * math.pi * points[:, 3]
    return 0 * points[:, :3], np.stack([sine * np.cos(around_rad), sine * np.sin(around_rad), cosine], axis=1)


class OwnLamp(FolderTest):
    def experiment(self, **keys):
        return photorque.Experiment(square_model(self.folder), folder=self.folder, keys=keys)

    def test_parallel_light_has_a_closed_form(self):
        lamp = photorque.Lamp(round_beam, power_W=3.0, wavelength_nm=730, position_m=[0, 0, 1], aim_m=[0, 0, 0])
        traced = photorque.trace(self.experiment(), lamps=[lamp])
        board = traced.flux_maps["board"]
        self.assertAlmostEqual(board.power_W.value, 3.0, delta=1e-9)
        middle = board.irradiance_W_m2[7:13, 7:13]  # within 43 mm of the axis
        np.testing.assert_allclose(middle, 3.0 / (math.pi * 0.05**2), rtol=0.02)
        self.assertEqual(board.irradiance_W_m2[0, 0], 0.0)
        # All momentum stays on the black board: P/c, straight down.
        np.testing.assert_allclose(traced.force_body_N, [0, 0, -3.0 / 299792458.0], rtol=1e-6, atol=1e-15)

    def test_it_is_the_same_lamp_of_the_catalogue(self):
        # A cone from an opening of almost no size: the catalogue's pillbox, even in solid angle.
        own = photorque.Lamp(cone, power_W=2.0, wavelength_nm=730, spectral_fwhm_nm=30,
                             position_m=[0.02, 0, 1], direction=[0, 0, -1])
        catalogue = self.experiment(**{"source": []}).to_dict()
        catalogue["source"] = [{"kind": "led", "power_W": 2.0, "aperture_diameter_mm": 1e-3, "profile": "pillbox",
                                "pillbox_measure": "solid_angle", "half_angle_deg": 3.0, "wavelength_nm": 730,
                                "spectral_fwhm_nm": 30, "position_m": [0.02, 0, 1], "direction": [0, 0, -1]}]
        catalogue["trace"]["direct"] = "rays"
        theirs = photorque.trace(photorque.Experiment(catalogue, folder=self.folder)).flux_maps["board"]
        ours = photorque.trace(self.experiment(), lamps=[own]).flux_maps["board"]
        self.assertAlmostEqual(ours.power_W.value, theirs.power_W.value, delta=1e-6)
        lit = theirs.irradiance_W_m2 > 0.9 * theirs.irradiance_W_m2.max()
        self.assertGreater(lit.sum(), 50)
        np.testing.assert_allclose(ours.irradiance_W_m2[lit], theirs.irradiance_W_m2[lit], rtol=0.05)

    def test_it_shines_beside_those_of_the_experiment(self):
        few = photorque.Experiment(nominal, keys={"trace.rays": 65536})
        lamp = photorque.Lamp(round_beam, power_W=2.0, wavelength_nm=730, position_m=[0, 0, 1], aim_m=[0, 0, 0],
                              name="torch")
        alone, both = photorque.trace(few), photorque.trace(few, lamps=[lamp])
        self.assertEqual(both.figures["emitted_W"].value, alone.figures["emitted_W"].value + 2.0)
        self.assertIn("lamp torch", both.provenance["inputs"])
        more = photorque.power(few, lamps=[lamp]).power_W.value - photorque.power(few).power_W.value
        self.assertGreater(more, 0.05)  # in the middle of an array whose cells stand in series
        table = photorque.torque_map(
            self.experiment(**{"torque_map.tilt_deg": [0, 60], "torque_map.heading_deg": [0]}), lamps=[lamp])
        # Tilted by 60 deg the square of 0.2 m still holds the beam's 0.1 m: the same force from above.
        np.testing.assert_allclose(np.linalg.norm(table.force_body_N, axis=-1), 2.0 / 299792458.0, rtol=1e-6)

    def test_the_same_bits_at_any_number_of_threads(self):
        lamp = photorque.Lamp(cone, power_W=1.0, wavelength_nm=730, position_m=[0, 0, 1], aim_m=[0, 0, 0])
        one, three = (photorque.trace(self.experiment(), lamps=[lamp], threads=n).flux_maps["board"] for n in (1, 3))
        self.assertEqual(one.irradiance_W_m2.tobytes(), three.irradiance_W_m2.tobytes())

    def test_the_provenance_tells_lamps_apart(self):
        def hash_of(power_W):
            lamp = photorque.Lamp(cone, power_W=power_W, wavelength_nm=730, position_m=[0, 0, 1], aim_m=[0, 0, 0])
            return photorque.trace(self.experiment(), lamps=[lamp]).provenance["inputs"]["lamp lamp"]

        self.assertEqual(hash_of(1.0), hash_of(1.0))
        self.assertNotEqual(hash_of(1.0), hash_of(1.5))

    def test_what_it_raises_reaches_the_caller(self):
        def broken(points):
            raise KeyError("broken")

        calls = []

        def breaks_later(points):
            calls.append(len(points))
            if len(calls) > 300:
                raise KeyError("later")
            return round_beam(points)

        for emit in (broken, breaks_later):
            lamp = photorque.Lamp(emit, power_W=1, wavelength_nm=730, position_m=[0, 0, 1], aim_m=[0, 0, 0])
            with self.assertRaises(KeyError):
                photorque.trace(self.experiment(), lamps=[lamp])

    def test_what_makes_no_sense_is_refused(self):
        place = {"position_m": [0, 0, 1], "aim_m": [0, 0, 0]}
        for wrong in (lambda p: p, lambda p: (p[:, :3], p[:5, :3]), lambda p: (0 * p[:, :3], 0 * p[:, :3]),
                      lambda p: (np.nan * p[:, :3], p[:, :3]), lambda p: "ab",
                      lambda p: (p[:, :3], [["a"] * 3] * len(p))):
            lamp = photorque.Lamp(wrong, power_W=1, wavelength_nm=730, **place)
            with self.assertRaisesRegex(ValueError, 'lamp "lamp" gave'):
                photorque.trace(self.experiment(), lamps=[lamp])
        for keys in ({"power_W": 0, "wavelength_nm": 730, **place}, {"power_W": 1, "wavelength_nm": -1, **place},
                     {"power_W": 1, "wavelength_nm": 730, "position_m": [0, 0, 1]},
                     {"power_W": 1, "wavelength_nm": 730, "position_m": [0, 0], "aim_m": [0, 0, 0]},
                     {"power_W": 1, "wavelength_nm": 730, "position_m": "abc", "aim_m": [0, 0, 0]}):
            with self.assertRaises(photorque.InputError):
                photorque.Lamp(cone, **keys)
        with self.assertRaises(photorque.InputError):
            photorque.trace(self.experiment(), lamps=[cone])
        with self.assertRaises(photorque.InputError):
            photorque.trace(self.experiment())  # no lamp at all
