"""Experiments from files and dicts, and what is said of wrong ones."""

import pathlib
import subprocess
import tomllib
import unittest

import numpy as np
import photorque
from support import FolderTest, attitude, nominal, program

few_rays = {"trace.rays": 65536}


class FromDict(unittest.TestCase):
    def test_the_dict_of_a_file_gives_the_same_numbers(self):
        with open(nominal, "rb") as file:
            keys = tomllib.load(file)
        ours = photorque.Experiment(keys, folder=nominal.parent, keys=few_rays)
        theirs = photorque.Experiment(nominal, keys=few_rays)
        self.assertEqual(ours.to_dict(), theirs.to_dict())
        name = "irradiance_solar_array"
        np.testing.assert_array_equal(photorque.trace(ours).maps[name].value,
                                      photorque.trace(theirs).maps[name].value)

    def test_values_of_every_type_come_back(self):
        keys = {"a": {"flag": True, "whole": 3, "real": 0.1, "tiny": 5e-324, "large": 1e300,
                      "round": 4.0, "text": "käse \"x\" \\ \n\t", "list": [1, 2.5, [3]],
                      "deep": {"one": {"two": "x"}}},
                "b": [{"x": 1}, {"x": 2, "y": {"z": [{"w": 1}]}}], "top": 7}
        self.assertEqual(photorque.Experiment(keys).to_dict(), keys)
        self.assertEqual(tomllib.loads(photorque.Experiment(keys).text), keys)

    def test_numpy_and_paths(self):
        keys = {"v": np.arange(3.0), "n": np.float64(2.5), "i": np.int64(4), "p": pathlib.Path("a/b")}
        self.assertEqual(photorque.Experiment(keys).to_dict(),
                         {"v": [0.0, 1.0, 2.0], "n": 2.5, "i": 4, "p": "a/b"})

    def test_changes_leave_the_experiment_alone(self):
        first = photorque.Experiment({"attitude": {"tilt_deg": 1.0}})
        second = first.with_keys({"attitude.tilt_deg": 2.5})
        self.assertEqual(first.to_dict()["attitude"]["tilt_deg"], 1.0)
        self.assertEqual(second.to_dict()["attitude"]["tilt_deg"], 2.5)


class Check(unittest.TestCase):
    def test_a_good_and_a_bad_one(self):
        good = photorque.check(photorque.Experiment(nominal))
        self.assertEqual(good.mistakes, [])
        self.assertIn("49 lamps", good.commands["trace"])
        bad = photorque.check(photorque.Experiment(nominal, keys={"source[0].direction": [0, 0, 1]}))
        self.assertEqual(len(bad.mistakes), 1)
        self.assertIn("source[0].direction", bad.mistakes[0])


class Errors(FolderTest):
    def line_of_program(self, verb, file):
        done = subprocess.run([program, verb, str(file)], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 2)
        return done.stderr.rstrip("\n")

    def test_the_same_line_as_the_program(self):
        text = nominal.read_text().replace("stasis.gltf", str(nominal.parent / "stasis.gltf"))
        for wrong, verb, run in (
                (text.replace("fwhm_deg = 3.0", "fwhm_deg = -3.0"), "trace", photorque.trace),
                (text.replace("fwhm_deg = 3.0", "fwhm_dog = 3.0"), "trace", photorque.trace),
                (text.replace("[array]", "[arrray]"), "power", photorque.power),
                (text + "\n[array]\n", "power", photorque.power),
                (text + "\n[environment]\ngravty_m_s2 = 9.8\n", "budget", photorque.budget),
                ("", "trace", photorque.trace)):
            file = self.folder / "wrong.toml"
            file.write_text(wrong)
            with self.assertRaises(photorque.InputError) as raised:
                run(photorque.Experiment(str(file)))
            self.assertEqual(str(raised.exception), self.line_of_program(verb, file))

    def test_what_no_experiment_can_hold(self):
        for keys in ({"a": None}, {1: 2}, {"a": [object()]}, {"a": 2**70}):
            with self.assertRaises(photorque.InputError):
                photorque.Experiment(keys)
        with self.assertRaises(photorque.InputError):
            photorque.Experiment(self.folder / "absent.toml")

    def test_a_value_of_another_type_is_named_in_one_line(self):
        experiment = photorque.Experiment(nominal)
        for act, words in ((lambda: photorque.Experiment(None), "source: found None, expected the path"),
                           (lambda: photorque.Experiment("a\0b"), "source: found 'a.x00b'"),
                           (lambda: photorque.Experiment(nominal, keys={1: 2}), "keys: found 1, expected names"),
                           (lambda: experiment.with_keys({None: 2}), "keys: found None"),
                           (lambda: photorque.Experiment({"a": "\ud800"}), "a: found '.ud800', expected a text"),
                           (lambda: photorque.propagate(photorque.Experiment(attitude), torques={3: len}),
                            "torques: found 3, expected names")):
            with self.assertRaisesRegex(photorque.InputError, "^[^\n]*" + words + "[^\n]*$"):
                act()

    def test_input_errors_are_value_errors(self):
        self.assertTrue(issubclass(photorque.InputError, ValueError))
        self.assertTrue(issubclass(photorque.NumericalError, ArithmeticError))

    def test_outside_a_table_is_no_number(self):
        keys = {"trace.rays": 4096, "torque_map.tilt_deg": [0, 10], "torque_map.heading_deg": [0]}
        table = photorque.torque_map(photorque.Experiment(nominal, keys=keys))
        with self.assertRaises(photorque.NumericalError):
            table.at(polar_rad=1.0, around_rad=0.0)
