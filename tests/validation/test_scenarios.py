"""The cases of a plan: what they are made of, what they show, what stands in their files."""

import gzip
import json
import math
import pathlib
import re
import tempfile
import unittest

import numpy as np

from validation import files, scenarios
from validation.case import Noise
from validation.draw import Draw
from validation.instruments import errors
from validation.laws import CATALOGUE, NOT_INJECTED, Conditions
from validation.makers import draw_second
from validation.motion import Motion
from validation.plan import Plan
from validation.strength import stays_physical

ROOT = pathlib.Path(__file__).parents[2]
NOTHING = {"per_kind": 0, "none": 0, "pairs": 0, "outside": 0}


def documented_kinds():
    """{kind: its meaning in docs/disturbances.md, with the expected sizes of its parameters}."""
    page = (ROOT / "docs/disturbances.md").read_text()
    tables = re.findall(r"<!-- keys disturbance .*?begin -->(.*?)<!-- keys", page, re.DOTALL)
    return dict(re.findall(r"^\| \*\*`(\w+)`\*\* \|  \|  \| (.*) \|$", "".join(tables), re.MULTILINE))


class Catalogue(unittest.TestCase):
    def test_every_documented_kind_is_injected_or_has_a_reason(self):
        names = [kind.name for kind in CATALOGUE]
        self.assertEqual(len(names), len(set(names)))
        self.assertEqual(set(names) | set(NOT_INJECTED), set(documented_kinds()))
        self.assertFalse(set(names) & set(NOT_INJECTED))

    def test_examples_have_the_keys_that_a_diagnosis_fits(self):
        conditions = Conditions(400.0, np.array([0.11, 0.12, 0.19]), 2.5)
        documented = documented_kinds()
        for kind in CATALOGUE:
            example = kind.draw(Draw(1, 1), conditions)
            for key, value in example.items():
                self.assertIn(f"`{key}`", documented[kind.name], kind.name)
                if f"`{key}`" in documented[kind.name] and "(≥ 0)" in documented[kind.name].split(f"`{key}`")[1][:20]:
                    self.assertGreaterEqual(np.min(value), 0.0, kind.name)
            self.assertEqual(bool(kind.strength), kind.strength in example, kind.name)
            if kind.strength:
                self.assertEqual(np.size(example[kind.strength]), kind.components, kind.name)


class Errors(unittest.TestCase):
    """The errors of instruments against the moments of their distributions."""

    def drawn(self, noise, count=100000):
        return errors(Draw(7, 11), noise, count, 0.1)

    def product_at(self, values, lag):
        return float(np.mean(values[:, lag:] * values[:, : values.shape[1] - lag]))

    def test_as_stated_they_are_white_and_of_unit_level(self):
        values = self.drawn(Noise())
        self.assertAlmostEqual(self.product_at(values, 0), 1.0, delta=0.02)
        self.assertAlmostEqual(self.product_at(values, 1), 0.0, delta=0.02)
        self.assertAlmostEqual(self.product_at(self.drawn(Noise(scale=1.7)), 0), 1.7**2, delta=0.06)

    def test_correlation_falls_with_its_time(self):
        values = self.drawn(Noise(time_s=0.5))
        for lag, expected in ((0, 1.0), (5, math.exp(-1.0)), (10, math.exp(-2.0))):
            self.assertAlmostEqual(self.product_at(values, lag), expected, delta=0.04)

    def test_students_t_has_heavy_tails_at_the_stated_level(self):
        """With 5 degrees of freedom, at unit variance: half of the values lie within 0.7267·√(3/5)."""
        values = self.drawn(Noise(student_degrees=5))
        self.assertAlmostEqual(self.product_at(values, 0), 1.0, delta=0.05)
        self.assertAlmostEqual(np.mean(np.abs(values) < 0.7267 * math.sqrt(0.6)), 0.5, delta=0.005)
        self.assertGreater(np.mean(np.abs(values) > 4.0), 10.0 * 6.3e-5)

    def test_outliers_are_five_times_the_level(self):
        self.assertAlmostEqual(self.product_at(self.drawn(Noise(outlier_share=0.05)), 0), 0.95 + 0.05 * 25, delta=0.1)


class Makers(unittest.TestCase):
    def test_the_second_takes_its_share_and_moves_as_the_first_never_does(self):
        plan = Plan(**(NOTHING | {"none": 40, "second_maker_share": 0.25}))
        self.assertEqual(sum(scenarios.Choice(plan, i).is_second for i in range(40)), 10)
        self.assertTrue(all(stays_physical(scenarios.draw_case(plan, i)) for i in range(0, 40, 8)))
        cases = [draw_second(Draw(1, i), plan, []) for i in range(40)]
        self.assertEqual(len({c.maker.split(",")[0] for c in cases}), 4)
        self.assertGreater(max(np.linalg.norm(c.runs[0].start.rate_rad_s) for c in cases), 1.0)
        self.assertLess(min(c.world.mass_kg for c in cases), 3.0)
        self.assertGreater(max(c.world.mass_kg for c in cases), 30.0)
        self.assertEqual(min(c.runs[0].duration_s for c in cases), 60.0)
        for has in ("has_gyro", "has_commands"):
            self.assertEqual({getattr(c.sensors, has) for c in cases}, {True, False})

    def test_commands_begin_on_rows(self):
        plan = Plan(**(NOTHING | {"noise_effect": 1, "seed": 5}))
        case = scenarios.draw_case(plan, 0)
        times_s = [c.time_s for c in case.runs[0].commands]
        self.assertEqual(times_s, sorted(set(times_s)))
        rows = np.array(times_s) * case.sensors.rate_Hz
        np.testing.assert_allclose(rows, np.round(rows), atol=1e-9)


class Cases(unittest.TestCase):
    def test_families_are_as_many_as_planned(self):
        plan = Plan(per_kind=3, none=15, pairs=24, outside=5, triples=40, known_unknown=20, noise_none=50, noise_effect=30)
        choices = [scenarios.Choice(plan, i) for i in range(scenarios.case_count(plan))]
        counts = {family: sum(c.family == family for c in choices) for family in {c.family for c in choices}}
        self.assertEqual(counts, {"none": 15, "single": 81, "pair": 24, "outside": 40, "triple": 40, "known_unknown": 20,
                                  "noise_none": 50, "noise_effect": 30})  # fmt: skip
        for c in choices:
            names = [kind.name for kind in c.kinds]
            self.assertEqual(len(names), len(set(names)))
            self.assertFalse({"turbine_torque", "room_draft"} <= set(names))

    def test_effects_show_as_wanted(self):
        plan = Plan(**(NOTHING | {"triples": 1, "duration_s": 150.0, "holdout_s": 100.0}))
        case = scenarios.draw_case(plan, 0)
        self.assertEqual(len({e.kind for e in case.world.effects}), 3)
        self.assertEqual(case.verdict, "missing_physics")
        self.assertGreaterEqual(case.chi2_gain, 200.0)

    def test_files_are_the_same_every_time(self):
        plan = Plan(**(NOTHING | {"per_kind": 1, "duration_s": 60.0, "holdout_s": 30.0, "dirty_share": 1.0}))
        index = next(i for i, kind in enumerate(CATALOGUE) if kind.name == "magnetic_dipole")
        with tempfile.TemporaryDirectory() as holder:
            folders = [pathlib.Path(holder) / name for name in "ab"]
            for folder in folders:
                scenarios.make_case(plan, index, folder)
            names = sorted(path.name for path in folders[0].iterdir())
            self.assertEqual(names, ["experiment.toml", "oracle.toml", "run1.csv.gz", "run2.csv.gz", "truth.json",
                                     "truth1.toml", "truth2.toml"])  # fmt: skip
            for name in names:
                self.assertEqual((folders[0] / name).read_bytes(), (folders[1] / name).read_bytes(), name)
            self.assertEqual(files.cases_in(holder), folders)
            self.assertNotIn("magnetic_dipole", (folders[0] / "experiment.toml").read_text())
            self.assertIn("magnetic_dipole", (folders[0] / "oracle.toml").read_text())
            truth = json.loads((folders[0] / "truth.json").read_text())
            self.assertEqual(truth["name"], "magnetic_dipole_01")
            lines = gzip.decompress((folders[0] / "run1.csv.gz").read_bytes()).decode().splitlines()
            self.assertTrue(lines[0].startswith("#"))
            self.assertEqual(lines[1].split(",")[:2], ["t_s", "q_w"])
            self.assertEqual({line.count(",") for line in lines[2:]}, {lines[1].count(",")})

    def test_unknown_laws_have_no_true_experiment(self):
        plan = Plan(**(NOTHING | {"outside": 1, "duration_s": 60.0, "holdout_s": 30.0}))
        case = scenarios.draw_case(plan, 7)
        self.assertEqual((case.name, case.verdict, case.accept), ("slack_cable_01", "unexplained", [[]]))
        self.assertIsNone(files.truth_text(case, 0))
        self.assertEqual(Motion([case.world]).start_s, -0.5)
