"""Laws and motion of the benchmark against closed forms."""

import math
import unittest

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from validation.draw import Draw
from validation.laws import BOUNDS, KINDS, Conditions, is_possible
from validation.motion import Effect, Motion, Start, World, read_one
from validation.vectors import body_from_lab, conjugate, product, quaternion_of, times, turn_of

LEVEL = np.array([1.0, 0.0, 0.0, 0.0])


def free_body(**changes):
    return World(3.0, np.array([0.11, 0.13, 0.19]), gravity_m_s2=0.0).but(**changes)


def motion_of(world, rate, duration_s=60.0, attitude=LEVEL, count=61):
    times_s = np.linspace(0.0, duration_s, count)
    return times_s, read_one(world, Start(attitude, np.array(rate, dtype=float)), [], times_s)


class Vectors(unittest.TestCase):
    def test_quaternions_turn_as_matrices_do(self):
        turn, v = np.array([0.4, -1.1, 0.7]), np.array([0.3, 0.2, -0.9])
        q = quaternion_of(turn)
        turned = product(conjugate(q), product(np.append(0.0, v), q))[1:]
        np.testing.assert_allclose(times(body_from_lab(q), v), turned, atol=1e-15)
        np.testing.assert_allclose(turn_of(q), turn, atol=1e-15)
        np.testing.assert_allclose(turn_of(-q), turn, atol=1e-15)


class Bodies(unittest.TestCase):
    def test_a_free_body_keeps_energy_and_momentum(self):
        _, readings = motion_of(free_body(), (0.3, 0.5, -0.2), 200.0)
        momentum_body = np.array([[0.11], [0.13], [0.19]]) * readings.rate_rad_s
        energy = 0.5 * (momentum_body * readings.rate_rad_s).sum(axis=0)
        lab_from_body = np.swapaxes(body_from_lab(readings.attitude), 0, 1)
        momentum_lab = times(lab_from_body, momentum_body)
        np.testing.assert_allclose(energy, energy[0], rtol=2e-8)
        np.testing.assert_allclose(momentum_lab, momentum_lab[:, :1] + np.zeros(61), atol=2e-9)

    def test_a_pendulum_swings_with_its_period(self):
        inertia, below_m, angle = 0.11, 4e-5, 0.6
        world = World(8.0, np.array([inertia, 0.12, 0.19]), offset_m=np.array([0.0, 0.0, -below_m]))
        slow = math.sqrt(8.0 * 9.80665 * below_m / inertia)
        period_s = 4.0 / slow * ellipk(math.sin(0.5 * angle) ** 2)
        start = Start(quaternion_of([angle, 0.0, 0.0]), np.zeros(3))
        halves = np.array([0.0, 0.5, 1.0]) * period_s - 0.5
        turns = turn_of(Motion([world]).read([start], [], halves).attitude)
        np.testing.assert_allclose(turns[0, 0], [angle, -angle, angle], atol=1e-7)

    def test_drag_stops_exponentially(self):
        times_s, readings = motion_of(free_body(drag_N_m_s=2e-3), (0.0, 0.0, 0.4))
        expected = 0.4 * np.exp(-2e-3 / 0.19 * (times_s + 0.5))
        np.testing.assert_allclose(readings.rate_rad_s[2], expected, rtol=1e-8)

    def test_dry_friction_stops_linearly_and_holds(self):
        world = free_body(effects=[Effect("dry_friction", {"torque_N_m": 1e-3})])
        times_s, readings = motion_of(world, (0.0, 0.0, 0.1), 20.0)
        expected = np.maximum(0.0, 0.1 - 1e-3 / 0.19 * (times_s + 0.5))
        np.testing.assert_allclose(readings.rate_rad_s[2], expected, atol=3e-5)  # creep of 1e-6 rad/s
        self.assertLess(abs(readings.rate_rad_s[2, -1]), 1e-9)

    def test_form_drag_falls_as_a_hyperbola(self):
        world = free_body(effects=[Effect("air_pressure_drag", {"coefficient_N_m_s2": 0.02})])
        times_s, readings = motion_of(world, (0.0, 0.5, 0.0))
        expected = 0.5 / (1.0 + 0.5 * 0.02 / 0.13 * (times_s + 0.5))
        np.testing.assert_allclose(readings.rate_rad_s[1], expected, rtol=1e-8)

    def test_air_friction_falls_as_an_inverse_square(self):
        world = free_body(effects=[Effect("air_friction", {"coefficient": 0.01})])
        times_s, readings = motion_of(world, (0.5, 0.0, 0.0))
        expected = (0.5**-0.5 + 0.5 * 0.01 / 0.11 * (times_s + 0.5)) ** -2
        np.testing.assert_allclose(readings.rate_rad_s[0], expected, rtol=1e-8)

    def test_a_tone_swings_about_its_axis(self):
        tone = {"torque_N_m": [0.0, 0.0, 3e-4], "frequency_Hz": 0.8, "phase": 0.4}
        times_s, readings = motion_of(free_body(effects=[Effect("periodic_torque", tone)]), (0.0, 0.0, 0.0))
        fast = 2 * math.pi * 0.8
        expected = 3e-4 / 0.19 / fast * (np.cos(0.4 - 0.5 * fast) - np.cos(fast * times_s + 0.4))
        np.testing.assert_allclose(readings.rate_rad_s[2], expected, atol=1e-11)

    def test_an_appendage_shifts_the_free_frequency(self):
        """Body and appendage swing against each other at f √(1/(1 − J/I)), the momentum of both is kept."""
        mode = {"axis": [0, 0, 2], "frequency_Hz": 0.5, "damping": 0.0, "inertia_kg_m2": 0.05}
        world = free_body(effects=[Effect("flexible_mode", mode)])
        period_s = math.sqrt(1.0 - 0.05 / 0.19) / 0.5
        motion = Motion([world])
        states = motion.states([Start(LEVEL, np.array([0.0, 0.0, 0.2]))], [], [0.0])
        self.assertEqual(motion.start_s, 0.0)
        start, angle = states[:, 0, 0], 0.02
        self.assertEqual(start[9], 0.2)
        # The body with its appendage turned: after a period everything is as it was.
        y = start.copy()
        y[8] = angle
        solution = solve_ivp(lambda t, s: motion.rates(t, s, np.zeros(3), 0.0), (0.0, period_s), y, method="DOP853",
                             rtol=1e-11, atol=1e-13)  # fmt: skip
        self.assertAlmostEqual(solution.y[8, -1], angle, delta=1e-9)
        momentum = (0.19 - 0.05) * solution.y[6] + 0.05 * solution.y[9]
        np.testing.assert_allclose(momentum, momentum[0], rtol=1e-9)

    def test_a_mass_shift_begins_at_its_instant(self):
        world = World(2.0, np.array([0.1, 0.1, 0.1]),
                      effects=[Effect("mass_shift", {"time_s": 7.3, "offset_m": [1e-6, 0, 0]})])  # fmt: skip
        times_s, readings = motion_of(world, (0.0, 0.0, 0.0), 10.0, count=101)
        expected = 2.0 * 9.80665 * 1e-6 / 0.1 * np.maximum(0.0, times_s - 7.3)
        np.testing.assert_allclose(readings.rate_rad_s[1], expected, atol=1e-10)

    def test_the_earth_turns_the_laboratory(self):
        """A gyro at rest in inertial space: the platform turns against the laboratory once a sidereal day."""
        world = free_body(moments_kg_m2=np.ones(3), latitude_rad=math.pi / 2, effects=[Effect("earth_rotation", {})])
        _, readings = motion_of(world, (0.0, 0.0, -7.292115e-5))
        np.testing.assert_allclose(readings.gyro_rad_s, 0.0, atol=1e-13)
        np.testing.assert_allclose(turn_of(readings.attitude)[2, -1], -7.292115e-5 * 60.5, rtol=1e-9)

    def test_a_late_camera_sees_the_past(self):
        world = free_body(effects=[Effect("attitude_latency", {"latency_s": 0.2})])
        times_s, readings = motion_of(world, (0.0, 0.0, 0.1), 20.0)
        np.testing.assert_allclose(turn_of(readings.camera)[2], 0.1 * (times_s + 0.3), atol=1e-12)

    def test_members_of_a_batch_are_those_alone(self):
        worlds = [free_body(), free_body(effects=[Effect("gyro_bias", {"bias_rad_s": [1e-3, 0, 0]})]),
                  free_body(effects=[Effect("rotor_momentum", {"momentum_N_m_s": [0, 1e-2, 0]})])]  # fmt: skip
        start, times_s = Start(LEVEL, np.array([0.2, 0.1, 0.3])), np.linspace(0.0, 20.0, 21)
        together = Motion(worlds).read([start] * 3, [], times_s)
        for i, world in enumerate(worlds):
            alone = read_one(world, start, [], times_s)
            np.testing.assert_allclose(together.camera[:, i], alone.camera, atol=2e-9)
            np.testing.assert_allclose(together.gyro_rad_s[:, i], alone.gyro_rad_s, atol=2e-9)


class Catalogue(unittest.TestCase):
    def test_bounds_name_keys_of_examples(self):
        self.assertFalse(is_possible("tether", "stiffness_N_m_per_rad", [-1e-9], False))
        self.assertTrue(is_possible("bearing_drag", "coefficient_N_m_s", [-1e-5], True))
        self.assertFalse(is_possible("bearing_drag", "coefficient_N_m_s", [-1e-5], False))
        conditions = Conditions(400.0, np.array([0.11, 0.12, 0.19]), 2.5)
        for (kind, key), (low, high) in BOUNDS.items():
            if kind in KINDS:
                value = np.ravel(KINDS[kind].draw(Draw(1), conditions)[key])
                self.assertTrue(np.all((value >= low) & (value <= high)), kind)
