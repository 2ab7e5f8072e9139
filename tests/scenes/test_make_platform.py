"""tools/make_platform: its solids against the closed forms of volume, centre and inertia, and the platforms
that it makes. Closed forms: H. Goldstein, Classical Mechanics, and tables of moments of inertia as in R. C.
Weast (ed.), CRC Handbook of Chemistry and Physics."""

import collections
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import tempfile
import tomllib
import unittest
from math import pi

import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
loader = importlib.machinery.SourceFileLoader("make_platform", str(ROOT / "tools/make_platform"))
make = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_platform", loader))
loader.exec_module(make)

FINE = 512  # corners of a circle: inertia of curved solids within 1e-4


def cap(R, h):
    return pi * h * h * (3 * R - h) / 3


def solids(segments):
    """Each with the volume of the true solid."""
    hole = pi * 0.1 * 0.1
    return {
        "box": (make.box((0.3, 0.2, 0.1)), 0.006),
        "box_with_hole": (make.box_with_hole((0.5, 0.3, 0.02), 0.1, segments), (0.15 - hole) * 0.02),
        "long_box_with_hole": (make.box_with_hole((0.66, 0.02, 0.01), 0.004, segments),
                               (0.66 * 0.02 - pi * 0.004 * 0.004) * 0.01),
        "cylinder": (make.cylinder(0.1, 0.1, 0.4, 0, segments), pi * 0.01 * 0.4),
        "tube": (make.cylinder(0.1, 0.1, 0.4, 0.06, segments), pi * (0.01 - 0.0036) * 0.4),
        "frustum": (make.cylinder(0.2, 0.1, 0.3, 0, segments), pi * 0.1 * (0.04 + 0.02 + 0.01)),
        "cone": (make.cylinder(0.2, 0.0, 0.3, 0, segments), pi * 0.04 * 0.1),
        "ball": (make.ball(0.2, -0.2, 0.2, segments), 4.0 / 3 * pi * 0.008),
        "cut_ball": (make.ball(0.2, -0.2, 0.05, segments), cap(0.2, 0.25)),
        "ball_zone": (make.ball(0.2, -0.1, 0.05, segments), cap(0.2, 0.25) - cap(0.2, 0.1)),
        "shell": (make.shell(0.2, 0.01, 0.1, segments), cap(0.2, 0.3) - cap(0.19, 0.29)),
        "dish": (make.dish(0.4, 0.3, 0.01, segments), pi * 0.16 * 0.01),
    }


def volume_by_flux(mesh):
    """The flux of (0, 0, z) through the faces: not the sum of tetrahedra that the generator uses."""
    a, b, c = np.moveaxis(np.array(mesh.vertices_m)[np.array(mesh.triangles)], 1, 0)
    return (0.5 * np.cross(b - a, c - a)[:, 2] * (a + b + c)[:, 2] / 3).sum()


def at_rest(mesh, mass_kg):
    return make.mass_properties(make.moments_of(mesh), mass_kg, np.eye(3), np.zeros(3))


class Solids(unittest.TestCase):
    def test_are_closed_face_outwards_and_have_the_volume_of_the_true_solid(self):
        for segments in (12, 13, 48, 101):
            for name, (mesh, volume_m3) in solids(segments).items():
                with self.subTest(name, segments=segments):
                    edges = collections.Counter((t[i], t[(i + 1) % 3]) for t in mesh.triangles for i in range(3))
                    self.assertEqual(set(edges.values()), {1})
                    self.assertTrue(all(a != b and (b, a) in edges for a, b in edges))
                    self.assertAlmostEqual(make.moments_of(mesh)[0] / volume_m3, 1.0, delta=1e-12)
                    self.assertAlmostEqual(volume_by_flux(mesh) / volume_m3, 1.0, delta=1e-12)

    def test_keep_their_outline(self):
        def outline(mesh):
            return np.ptp(mesh.vertices_m, axis=0), np.max(mesh.vertices_m, axis=0)

        plate = (0.5, 0.3, 0.02)
        np.testing.assert_allclose(outline(make.box(plate))[0], plate, atol=1e-15)
        np.testing.assert_allclose(outline(make.box_with_hole(plate, 0.1, 48))[0], plate, atol=1e-15)
        self.assertAlmostEqual(outline(make.ball(0.2, -0.2, 0.05, 48))[1][2], 0.05, delta=1e-15)
        self.assertAlmostEqual(outline(make.shell(0.2, 0.01, 0.1, 48))[1][2], 0.1, delta=1e-15)
        self.assertAlmostEqual(outline(make.dish(0.4, 0.3, 0.01, 48))[1][2], 0.16 / 1.2, delta=1e-15)
        # Polygons of equal area stick out of their circles by less than half a percent at 48 corners.
        self.assertLess(outline(make.ball(0.2, -0.2, 0.2, 48))[1][0], 0.2 * 1.005)


class Inertia(unittest.TestCase):
    def check(self, found, principal, relative):
        np.testing.assert_allclose(found.inertia_kg_m2, np.diag(principal), rtol=relative,
                                   atol=1e-9 * np.linalg.norm(principal))

    def test_of_a_box(self):
        m, a, b, c = 3, 0.3, 0.2, 0.1
        self.check(at_rest(make.box((a, b, c)), m),
                   m / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b]), 1e-13)

    def test_of_a_box_with_a_hole(self):
        a, b, h, r, density = 0.5, 0.3, 0.02, 0.1, 1000
        box_kg, hole_kg = density * a * b * h, density * pi * r * r * h
        box = box_kg / 12 * np.array([b * b + h * h, a * a + h * h, a * a + b * b])
        across = 3 * r * r + h * h
        hole = hole_kg / 12 * np.array([across, across, 6 * r * r])
        self.check(at_rest(make.box_with_hole((a, b, h), r, FINE), box_kg - hole_kg), box - hole, 1e-6)

    def test_of_a_tube_and_a_cone(self):
        m, r, q, h = 2, 0.1, 0.06, 0.4
        across, along = m / 12 * (3 * (r * r + q * q) + h * h), m / 2 * (r * r + q * q)
        self.check(at_rest(make.cylinder(r, r, h, q, FINE), m), [across, across, along], 1e-8)
        cone = at_rest(make.cylinder(0.2, 0, 0.3, 0, FINE), m)
        self.assertAlmostEqual(cone.centre_m[2], -0.3 / 4, delta=1e-12)  # a quarter of the height above the base
        self.assertAlmostEqual(cone.inertia_kg_m2[2, 2] / (0.3 * m * 0.2**2), 1.0, delta=1e-8)

    def test_of_a_ball_and_a_shell(self):
        m, r = 2, 0.2
        self.check(at_rest(make.ball(r, -r, r, FINE), m), 3 * [0.4 * m * r * r], 1e-4)
        # Half a ball: its centre lies 3/8 of the radius from the cut.
        half = at_rest(make.ball(r, -r, 0, FINE), m)
        self.assertAlmostEqual(half.centre_m[2] / (-0.375 * r), 1.0, delta=1e-4)
        # A thin shell cut through the middle: half the radius.
        thin = at_rest(make.shell(r, 1e-4 * r, 0, FINE), m)
        self.assertAlmostEqual(thin.centre_m[2] / (-0.5 * r), 1.0, delta=2e-4)

    def test_of_a_dish(self):
        # A sheet of constant thickness along z over the disc: the integral of r² dm is m R²/2, the height of the
        # centre R²/(8 f) for its middle surface.
        m, R, f, t = 2.5, 0.4, 0.32, 0.01
        dish = at_rest(make.dish(R, f, t, FINE), m)
        self.assertAlmostEqual(dish.inertia_kg_m2[2, 2] / (m * R * R / 2), 1.0, delta=1e-4)
        self.assertAlmostEqual(dish.centre_m[2] / (R * R / (8 * f) - t / 2), 1.0, delta=1e-4)

    def test_of_a_placed_part_follows_steiners_theorem(self):
        m, a, b, c = 3, 0.3, 0.2, 0.1
        at_m = np.array([0.4, -0.7, 0.2])
        quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])  # about z: swaps x and y
        found = make.mass_properties(make.moments_of(make.box((a, b, c))), m, quarter, at_m)
        principal = m / 12 * np.diag([a * a + c * c, b * b + c * c, a * a + b * b])
        steiner = m * (at_m @ at_m * np.eye(3) - np.outer(at_m, at_m))
        np.testing.assert_allclose(found.centre_m, at_m, atol=1e-14)
        np.testing.assert_allclose(found.inertia_kg_m2, principal + steiner, atol=1e-13)


HEAD = """title = "t"
topology = "tabletop"
segments = 512
[[material]]
name = "m"
base_colour = [1, 1, 1]
density_kg_m3 = 2700
"""
PART = '[[part]]\nnode = "a/b"\nmaterial = "m"\n'


class Generator(unittest.TestCase):
    def test_assembly_agrees_with_closed_forms(self):
        """A plate with four posts at its corners and a rod through the side: boxes, cylinders, Steiner's theorem."""
        platform = make.generated(tomllib.loads(HEAD + """
[[part]]
node = "p/plate"
shape = "box"
size_m = [0.4, 0.2, 0.01]
position_m = [0, 0, 0.05]
material = "m"
[[part]]
node = "p/post"
shape = "cylinder"
radius_m = 0.01
height_m = 0.1
position_m = [0.1, 0, -0.02]
copies_deg = [45, 135, 225, 315]
mass_kg = 0.5
material = "m"
[[part]]
node = "p/rod"
shape = "cylinder"
radius_m = 0.02
height_m = 0.3
axis = [1, 0, 0]
position_m = [0.2, 0, 0]
mass_kg = 1
material = "m"
"""))
        plate, post, rod = 2700 * 0.4 * 0.2 * 0.01, 0.5, 1.0
        post_across, post_along = post / 12 * (3 * 1e-4 + 0.01), post / 2 * 1e-4
        rod_across, rod_along = rod / 12 * (3 * 4e-4 + 0.09), rod / 2 * 4e-4
        mass = plate + 4 * post + rod
        self.assertAlmostEqual(platform.mass.mass_kg, mass, delta=1e-12)
        np.testing.assert_allclose(platform.mass.centre_m,
                                   [rod * 0.2 / mass, 0, (plate * 0.05 - 4 * post * 0.02) / mass], atol=1e-12)
        # A post stands at (±0.0707, ±0.0707): 0.005 m² from either axis, 0.01 m² from z.
        x = plate / 12 * (0.04 + 1e-4) + plate * 0.0025 + 4 * (post_across + post * (0.005 + 4e-4)) + rod_along
        y = (plate / 12 * (0.16 + 1e-4) + plate * 0.0025 + 4 * (post_across + post * (0.005 + 4e-4)) + rod_across +
             rod * 0.04)
        z = plate / 12 * (0.16 + 0.04) + 4 * (post_along + post * 0.01) + rod_across + rod * 0.04
        np.testing.assert_allclose(platform.mass.inertia_kg_m2, np.diag([x, y, z]), rtol=1e-8, atol=1e-10)

    def test_refuses_what_makes_no_platform(self):
        cases = {
            "": "title: found nothing, expected a text in quotes",
            'title = "t"\ntopology = "tabeltop"\n': 'did you mean "tabletop"?',
            HEAD: "part: found nothing, expected at least one [[part]]",
            HEAD + PART + 'shape = "bux"\n': 'did you mean "box"?',
            HEAD + PART + 'shape = "box"\nsize_m = [1, 0, 1]\n': "part[0].size_m: found a length",
            HEAD + PART + 'shape = "box"\nsize_m = [1, 1]\n': "part[0].size_m: found [1, 1], expected 3 numbers",
            HEAD + PART + 'shape = "box"\nsize_m = [1, 1, 1]\nhole_radius_m = 0.5\n':
                "part[0].hole_radius_m: found 0.5, expected a number in (0, 0.49]",
            HEAD + PART + 'shape = "cylinder"\nradius_m = 1\nheight_m = 1\ninner_radius_m = 1\n':
                "part[0].inner_radius_m: found 1, expected a number in [0, 1)",
            HEAD + PART + 'shape = "ball"\nradius_m = 1\nlow_m = 0.5\nhigh_m = 0.5\n': "part[0].high_m: found 0.5",
            HEAD + PART + 'shape = "shell"\nradius_m = 1\nthickness_m = 0.1\nhigh_m = 0.95\n':
                "part[0].high_m: found 0.95, expected a number in (-0.9, 0.9)",
            HEAD + PART + 'shape = "ball"\nradius_m = 1\nmass_kg = 0\n': "part[0].mass_kg: found 0",
            HEAD + PART + 'shape = "ball"\nradius_m = 1\naxis = [0, 0, 0]\n': "part[0].axis",
            HEAD + PART + 'shape = "ball"\nradius_m = 1\nradios_m = 2\n': 'did you mean "radius_m"?',
            HEAD + 2 * (PART + 'shape = "ball"\nradius_m = 1\n'): "found a second a/b",
            HEAD + PART + 'shape = "ball"\nradius_m = 1\n' + PART.replace("a/b", "a") + 'shape = "ball"\nradius_m = 1\n':
                "expected parents first",
            HEAD.replace("density_kg_m3 = 2700\n", "") + PART + 'shape = "ball"\nradius_m = 1\n':
                "found nothing, expected mass_kg, or density_kg_m3 of its material",
            HEAD.replace("[1, 1, 1]", "[1, 1, 2]"): "material[0].base_colour",
        }  # fmt: skip
        for text, expected in cases.items():
            with self.subTest(text), self.assertRaises(make.InputError) as caught:
                make.generated(tomllib.loads(text))
            self.assertIn(expected, str(caught.exception))


class Committed(unittest.TestCase):
    """The platforms of scenes/."""

    EXPERIMENTS = {"stasis": "nominal", "dumbbell": "dumbbell", "tabletop": "tabletop", "hollow": "hollow",
                   "spacecraft": "spacecraft"}  # fmt: skip

    @classmethod
    def setUpClass(cls):
        cls.made = {}
        for name in cls.EXPERIMENTS:
            text = (ROOT / "scenes" / name / "parameters.toml").read_text(encoding="utf-8")
            cls.made[name] = make.generated(tomllib.loads(text))

    def test_are_byte_for_byte_what_the_generator_writes(self):
        for name, platform in self.made.items():
            committed = (ROOT / "scenes" / name / f"{name}.gltf").read_text(encoding="utf-8")
            self.assertTrue(make.gltf_text(platform) == committed, name)
            self.assertLess(len(committed), 500000)

    def test_have_their_centre_of_mass_at_the_centre_of_rotation(self):
        # Hand-set to 0.1 mm of the balancing parts, far below what moving masses correct.
        for name, platform in self.made.items():
            self.assertLess(np.linalg.norm(platform.mass.centre_m), 2e-5, name)

    def test_agree_with_the_mass_properties_of_their_experiments(self):
        for name, experiment in self.EXPERIMENTS.items():
            text = (ROOT / "scenes" / name / f"{experiment}.toml").read_text(encoding="utf-8")
            stated, platform = tomllib.loads(text)["platform"], self.made[name]
            self.assertEqual(stated["topology"], platform.topology)
            self.assertAlmostEqual(stated["mass_kg"] / platform.mass.mass_kg, 1.0, delta=1e-5)
            difference = np.array(stated["inertia_kg_m2"]) - platform.mass.inertia_kg_m2
            self.assertLess(np.linalg.norm(difference), 1e-5 * np.linalg.norm(platform.mass.inertia_kg_m2))

    def test_stasis_weighs_seven_kilograms_and_moves_its_masses_by_the_published_step(self):
        platform = self.made["stasis"]
        self.assertAlmostEqual(platform.mass.mass_kg, 7.0, delta=0.05 * 7.0)
        step_deg, lead_m = 1.8, 2e-3  # assumed in parameters.toml
        moving = [part for part in platform.parts if "_mass_" in part.node]
        self.assertEqual(len(moving), 8)
        for part in moving:  # half a full step of the motors
            shift_m = 0.5 * step_deg / 360 * lead_m * part.mass_kg / platform.mass.mass_kg
            self.assertAlmostEqual(shift_m, 1.79e-7, delta=0.005e-7)


class Program(unittest.TestCase):
    def test_wrong_parameters_are_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            parameters = pathlib.Path(folder) / "p.toml"
            parameters.write_text('title = "t"\n', encoding="utf-8")
            scene = pathlib.Path(folder) / "p.gltf"
            run = subprocess.run([ROOT / "tools/make_platform", parameters, scene], capture_output=True, text=True,
                                 timeout=60, check=False)  # fmt: skip
            self.assertEqual(run.returncode, 2)
            self.assertEqual(run.stderr.count("\n"), 1)
            self.assertIn("topology: found nothing", run.stderr)
            self.assertFalse(scene.exists())


if __name__ == "__main__":
    unittest.main()
