"""The benchmark against the program: two implementations of every kind, in two languages, with two integrators."""

import csv
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

from validation import files, prove, scenarios
from validation.case import Case, Run, Sensors
from validation.laws import CATALOGUE, NOT_INJECTED
from validation.motion import Command, Effect, Start, World, read_one
from validation.plan import Plan
from validation.vectors import conjugate, length, product, quaternion_of, turn_of

PROGRAM = os.environ.get("PHOTORQUE_PROGRAM", "")
ROOT = pathlib.Path(__file__).parents[2]

# Strong enough to turn the platform far from where it would be otherwise.
NUMBERS = {
    "static_unbalance": {"offset_m": [2e-6, -3e-6, 4e-6]},
    "mass_shift": {"time_s": 31.4, "offset_m": [2e-6, -3e-6, 4e-6]},
    "battery_discharge": {"shift_m_per_Ah": [3e-5, 2e-5, -1e-5]},
    "elastic_sag": {"compliance_s2": [1e-6, 2e-6, 3e-7]},
    "bearing_drag": {"coefficient_N_m_s": 2e-4},
    "turbine_torque": {"torque_N_m": 2e-5},
    "dry_friction": {"torque_N_m": 5e-6},
    "air_friction": {"coefficient": 3e-4},
    "air_pressure_drag": {"coefficient_N_m_s2": 3e-3},
    "room_draft": {"torque_lab_N_m": [1e-5, -2e-5, 3e-6]},
    "magnetic_dipole": {"dipole_A_m2": [0.3, -0.2, 0.1]},
    "eddy_damping": {"coefficient_N_m_s_per_T2": 5e4},
    "gravity_gradient": {},
    "earth_rotation": {},
    "rotor_momentum": {"momentum_N_m_s": [2e-3, -4e-3, 3e-3]},
    "tether": {"stiffness_N_m_per_rad": 1e-3},
    "floor_vibration": {"acceleration_m_s2": [0.05, 0.02, -0.04], "frequency_Hz": 0.7, "phase": 0.4},
    "periodic_torque": {"torque_N_m": [3e-5, -5e-5, 2e-5], "frequency_Hz": 0.6, "phase": -1.1},
    "flexible_mode": {"axis": [0.4, -0.3, 0.8], "frequency_Hz": 0.4, "damping": 0.03, "inertia_kg_m2": 0.02},
    "actuator_gain": {"gain_error": 0.3},
    "inertia_error": {"delta_kg_m2": [2e-3, -3e-3, 4e-3, 1e-3, -2e-3, 5e-4]},
    "gravity_tilt": {"tilt_rad": [3e-3, -5e-3]},
    "attitude_latency": {"latency_s": 0.13},
    "gyro_bias": {"bias_rad_s": [1e-3, -2e-3, 3e-3]},
    "gyro_scale": {"scale": [0.01, -0.02, 0.03]},
    "gyro_misalignment": {"misalignment_rad": [0.01, -0.02, 0.03]},
    "camera_misalignment": {"misalignment_rad": [0.01, -0.02, 0.03]},
}
TOLERANCE = 1e-7  # rad, and rad/s
DURATION_S, RATE_HZ = 60.0, 5.0


def case_of(kind):
    world = World(7.5, np.array([0.11, 0.125, 0.19]), magnetic_field_T=np.array([1e-6, 2.2e-5, -4.1e-5]),
                  latitude_rad=math.radians(45.0), offset_m=np.array([1e-6, -2e-6, -4e-5]), drag_N_m_s=1.3e-5,
                  effects=[Effect(kind, NUMBERS[kind])])  # fmt: skip
    start = Start(quaternion_of([0.08, -0.05, 0.3]), np.array([0.013, -0.02, 0.021]))
    commands = [Command(0.0, np.zeros(3), 3.0), Command(10.0, np.array([3e-4, -2e-4, 1e-4]), 3.0),
                Command(16.0, np.zeros(3), 6.0), Command(40.0, np.array([-1e-4, 4e-4, 2e-4]), 6.0),
                Command(44.0, np.zeros(3), 2.0)]  # fmt: skip
    runs = [Run(start, commands, DURATION_S)] * 2
    return Case(kind, "single", "first", "tabletop", (1,), world, sensors=Sensors(rate_Hz=RATE_HZ), runs=runs)


def run_program(folder, *words):
    run = subprocess.run([PROGRAM, *words, "--quiet"], cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    return run.returncode, run.stderr


def columns_of(path, names):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    return np.array([[float(row[name]) for row in rows] for name in names])


@unittest.skipUnless(PROGRAM, "PHOTORQUE_PROGRAM is not set")
class AgainstTheProgram(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def propagated(self, case):
        """Times, attitudes and gyro of `photorque propagate truth1.toml`."""
        files.write_file(self.folder / "truth1.toml", files.truth_text(case, 0))
        files.write_gzip(self.folder / "run1.csv.gz", files.recording_text(case, 0))
        status, errors = run_program(self.folder, "propagate", "truth1.toml", "--out", "out", "--threads", "1",
                                     "--set", "sensors.gyro.noise_rad_s=0")  # fmt: skip
        self.assertEqual(status, 0, errors)
        gyro = [f"gyro_{axis}_rad_s" for axis in "xyz"]
        read = columns_of(self.folder / "out" / "recording.csv", ["t_s", "q_w", "q_x", "q_y", "q_z", *gyro])
        return read[0], read[1:5], read[5:]

    def deviation(self, case, times_s, attitudes, gyro):
        readings = read_one(case.world, case.runs[0].start, case.runs[0].commands, times_s)
        turns = length(turn_of(product(readings.camera, conjugate(attitudes))))
        # A late camera first sees what was before the clock: the program takes the first rate for constant there.
        return max(turns[times_s >= 0.5].max(), length(readings.gyro_rad_s - gyro).max())

    def test_every_kind_moves_the_platform_alike(self):
        self.assertEqual(set(NUMBERS), {kind.name for kind in CATALOGUE})
        for kind in NUMBERS:
            with self.subTest(kind=kind):
                case = case_of(kind)
                program = self.propagated(case)
                self.assertLess(self.deviation(case, *program), TOLERANCE)
                # The comparison shows the effect, and a hundredth of it.
                effect = case.world.effects[0]
                changed = [effect.scaled(1.01)] if effect.numbers else []
                mutant = case_of(kind)
                mutant.world = mutant.world.but(effects=changed)
                self.assertGreater(self.deviation(mutant, *program), (3.0 if effect.numbers else 1.0) * TOLERANCE)

    def test_every_kind_of_the_program_is_known(self):
        run = subprocess.run([PROGRAM, "schema"], capture_output=True, text=True, timeout=60, check=True)
        kind = json.loads(run.stdout)["definitions"]["disturbance"]["properties"]["kind"]
        self.assertEqual(set(kind["enum"]), set(NUMBERS) | set(NOT_INJECTED))

    def test_made_cases_are_read_diagnosed_and_scored(self):
        """The whole path: a dirty case and a clean one, checked, diagnosed blind and scored; the page is renewed."""
        plan = {"per_kind": 1, "none": 1, "pairs": 0, "outside": 0, "duration_s": 100, "holdout_s": 60, "rates_Hz": [10],
                "dirty_share": 1.0, "second_maker_share": 0.0, "oracle": False, "section": "prove"}  # fmt: skip
        index = 1 + [kind.name for kind in CATALOGUE].index("magnetic_dipole")
        for number, i in enumerate((0, index)):
            scenarios.make_case(Plan(**plan | {"rates_Hz": (10.0,)}), i, self.folder / "cases" / f"{number}")
            status, errors = run_program(self.folder / "cases" / f"{number}", "check", "experiment.toml")
            self.assertEqual(status, 0, errors)
        page = self.folder / "page.md"
        page.write_text("<!-- prove begin -->\n<!-- prove end -->\n")
        lines = [f"{key} = {json.dumps(value)}" for key, value in (plan | {"document": "page.md", "at_once": 2}).items()]
        (self.folder / "plan.toml").write_text("[prove]\n" + "\n".join(lines) + "\n")
        words = [str(self.folder / "plan.toml"), "--program", PROGRAM, "--cases", str(self.folder / "cases"),
                 "--out", str(self.folder / "out"), "--quiet"]  # fmt: skip
        self.assertEqual(prove.main(words), 0)
        self.assertIn("| all cases: verdict and names right | 2 of 2 |", page.read_text())
        self.assertIn("| improved.toml that reproduces the recording with the stated χ² | 2 of 2 |", page.read_text())
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual(summary["cases"]["value"], 2)
        # Cases diagnosed by this program are not diagnosed again.
        stamp = self.folder / "out" / "blind" / "0" / "done.txt"
        before = stamp.stat().st_mtime_ns
        self.assertEqual(prove.main(words), 0)
        self.assertEqual(stamp.stat().st_mtime_ns, before)

    def test_wrong_input_is_reported_in_one_line(self):
        wrong = (["nosuch.toml"], ["docs/proof.toml", "--set", "prove.seed=-1"], ["docs/proof.toml", "--cases", "nosuch"],
                 ["docs/proof.toml", "--program", "nosuch", "--cases", "tests/data/cases"])  # fmt: skip
        for words in wrong:
            run = subprocess.run(["tools/prove", *words, "--out", str(self.folder / "out")], cwd=ROOT, text=True,
                                 capture_output=True, timeout=60, check=False)  # fmt: skip
            self.assertEqual(run.returncode, 2, words)
            self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
            self.assertIn("found", run.stderr)
