"""The light and the circuit of the independent oracle against closed forms and published tables."""

import dataclasses
import math
import types
import unittest

import numpy as np
from scipy import constants
from scipy.spatial.transform import Rotation

from validation.light import effects, identifiability, readings, scenarios, setting
from validation.light.circuit import Cell, Circuit, LitCircuit
from validation.light.illumination import Beam, Box, Cells, Lamp, Plate, Points, Room, Wall, fresnel_ratio

LEVEL = np.eye(3)
LAMBERT = Beam("cosine_power", exponent=1.0)
PLATE = Plate(-0.1, 0.1, -0.1, 0.1, 0.0)


def lamp_above(height_m=1.0, radius_m=1e-4, power_W=3.0, beam=LAMBERT, x_m=0.0):
    return Lamp((x_m, 0.0, height_m), (0.0, 0.0, -1.0), power_W, radius_m, beam)


def irradiance(room, *points, attitude=LEVEL):
    u, v = np.array(points).T
    return room.irradiance(Points(room.plate, u, v), attitude)


class LightOfLamps(unittest.TestCase):
    def test_small_lamp_follows_inverse_square_and_cosine(self):
        m, power_W = 30.0, 3.0
        room = Room(PLATE, [lamp_above(beam=Beam("cosine_power", exponent=m))])
        on_axis = power_W * (m + 1.0) / (2.0 * math.pi)
        centre, side = irradiance(room, (0.0, 0.0), (0.08, 0.06))
        self.assertAlmostEqual(centre / on_axis, 1.0, delta=1e-6)
        # cos^m of the lamp, cos of the incidence, and h²/r² = cos².
        self.assertAlmostEqual(side / on_axis, (1.0 / math.sqrt(1.01)) ** (m + 3.0), delta=1e-6)
        room.lamps = [dataclasses.replace(room.lamps[0], position_m=(0.0, 0.0, 2.0))]
        self.assertAlmostEqual(irradiance(room, (0.0, 0.0))[0] / on_axis, 0.25, delta=1e-6)

    def test_tilted_plate_follows_the_cosine(self):
        room = Room(PLATE, [lamp_above()])
        tilted = Rotation.from_rotvec([0.0, math.radians(25.0), 0.0]).as_matrix()
        level, turned = (irradiance(room, (0.0, 0.0), attitude=a)[0] for a in (LEVEL, tilted))
        self.assertAlmostEqual(turned / level, math.cos(math.radians(25.0)), delta=1e-6)
        # A bias of the attitude turns it likewise.
        room.bias_rad = (0.0, math.radians(25.0))
        self.assertAlmostEqual(irradiance(room, (0.0, 0.0))[0], turned, delta=1e-9)

    def test_beams_emit_one_watt(self):
        for beam in (Beam("gaussian", 0.15), Beam("super_gaussian", 0.5, 4.0), Beam("cosine_power", exponent=20.0)):
            angles = np.linspace(0.0, 0.5 * math.pi, 200001)
            per_angle = 2.0 * math.pi * beam.on_axis_per_sr() * beam.relative(np.cos(angles)) * np.sin(angles)
            self.assertAlmostEqual(np.trapz(per_angle, angles), 1.0, delta=1e-7, msg=beam)
            self.assertEqual(beam.relative(np.array(-0.5)), 0.0)
        half = Beam("super_gaussian", 0.5, 4.0).relative(np.cos(0.25))
        self.assertAlmostEqual(float(half), 0.5, delta=1e-12)

    def test_view_factor_of_coaxial_discs(self):
        # J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-41.
        source, receiver = 0.3, 0.2
        room = Room(PLATE, [lamp_above(radius_m=source, power_W=1.0)])
        squares, weights = np.polynomial.legendre.leggauss(8)
        radii = receiver * np.sqrt(0.5 * (squares + 1.0))
        mean = 0.5 * weights @ irradiance(room, *[(r, 0.0) for r in radii])
        s = 1.0 + (1.0 + receiver**2) / source**2
        expected = 0.5 * (s - math.sqrt(s**2 - 4.0 * (receiver / source) ** 2))
        self.assertAlmostEqual(mean * math.pi * receiver**2, expected, delta=1e-5 * expected)

    def test_mean_over_a_cell_is_that_of_its_points(self):
        room = Room(PLATE, [lamp_above(0.8, 0.014, beam=Beam("gaussian", math.radians(4.5)), x_m=0.03)])
        cells = room.irradiance(Cells(PLATE, 4, 2), LEVEL)
        side = (np.arange(200) + 0.5) / 200 * 0.05
        u, v = np.meshgrid(0.05 + side, 2.0 * side)  # of the last cell: column 3, row 1
        points = room.irradiance(Points(PLATE, u.ravel(), v.ravel()), LEVEL)
        self.assertAlmostEqual(cells[7] / points.mean(), 1.0, delta=1e-5)

    def test_edge_across_the_aperture_hides_half(self):
        room = Room(PLATE, [lamp_above(radius_m=0.01)])
        whole = irradiance(room, (0.0, 0.0))[0]
        for on_body in (False, True):
            room.boxes = [Box(on_body, (0.0, -1.0, 0.4), (1.0, 1.0, 0.41))]
            self.assertAlmostEqual(irradiance(room, (0.0, 0.0))[0] / whole, 0.5, delta=2e-3)

    def test_box_in_the_lab_stays_where_a_plate_turns(self):
        tilt = math.radians(20.0)
        room = Room(PLATE, [lamp_above(radius_m=0.01)])
        tilted = Rotation.from_rotvec([0.0, tilt, 0.0]).as_matrix()
        whole = irradiance(room, (0.08, 0.0), attitude=tilted)[0]
        # The point moves to (0.08 cos, 0, -0.08 sin); the edge stands half way between lamp and point.
        x, z = 0.04 * math.cos(tilt), 0.5 - 0.04 * math.sin(tilt)
        room.boxes = [Box(False, (x, -1.0, z - 1e-4), (1.0, 1.0, z + 1e-4))]
        half = irradiance(room, (0.08, 0.0), attitude=tilted)[0]
        self.assertAlmostEqual(half / whole, 0.5, delta=0.03)

    def test_shadow_of_a_box_covers_its_part_of_a_cell(self):
        # From a small lamp at 1 m a box at half the height hides twice its own width.
        plate = Plate(-0.05, 0.05, -0.05, 0.05, 0.0)
        room = Room(plate, [lamp_above()])
        whole = room.irradiance(Cells(plate, 1, 1), LEVEL)[0]
        room.boxes = [Box(False, (-0.01, -0.005, 0.5), (0.01, 0.005, 0.5))]
        share = 0.04 * 0.02 / 0.1**2
        shaded = room.irradiance(Cells(plate, 1, 1), LEVEL)[0]
        # The hidden part lies in the middle, where the light is as bright as at this point.
        hidden = share * irradiance(Room(plate, room.lamps), (0.01, 0.005))[0]
        self.assertAlmostEqual((whole - shaded) / hidden, 1.0, delta=5e-3)

    def test_white_wall_has_the_configuration_factor_of_a_rectangle(self):
        # Howell's catalogue, B-4: an element at a distance c from a rectangle at 90°, at its corner.
        wall = Wall(0, -0.1, 0.0, 0.3, 0.0, 0.2, 1.0)
        places = Points(PLATE, np.array([-0.05]), np.array([0.0]))
        factor = Room(PLATE, walls=[wall])._transfer(wall, places).sum()
        c, b, a = 0.05, 0.3, 0.2
        slant = math.hypot(a, c)
        expected = (math.atan(b / c) - c / slant * math.atan(b / slant)) / (2.0 * math.pi)
        self.assertAlmostEqual(factor / expected, 1.0, delta=1e-3)

    def test_reflections_add_light_of_the_wall(self):
        wall = Wall(0, -0.2, -5.0, 5.0, 0.0, 50.0, 1.0, specular=1.0)
        room = Room(PLATE, [lamp_above()], [wall])
        direct = irradiance(dataclasses.replace(room, walls=[]), (0.05, 0.0))[0]
        image = irradiance(Room(PLATE, [lamp_above(x_m=-0.4)]), (0.05, 0.0))[0]
        self.assertAlmostEqual(irradiance(room, (0.05, 0.0))[0], direct + image, delta=1e-6)
        room.walls = [dataclasses.replace(wall, specular=0.0, diffuse=0.5)]
        more = irradiance(room, (0.05, 0.0))[0] - direct
        room.walls = [dataclasses.replace(wall, specular=0.0, diffuse=0.25)]
        self.assertGreater(more, 0.0)
        self.assertAlmostEqual(more, 2.0 * (irradiance(room, (0.05, 0.0))[0] - direct), delta=1e-9)

    def test_glass_at_the_angle_of_brewster(self):
        index = 1.5
        reflected = 0.5 * ((index**2 - 1.0) / (index**2 + 1.0)) ** 2
        straight = 1.0 - ((index - 1.0) / (index + 1.0)) ** 2
        ratio = fresnel_ratio(index, math.cos(math.atan(index)))
        self.assertAlmostEqual(ratio, (1.0 - reflected) / straight, delta=1e-12)


PHOTON_A_PER_W = 730e-9 * constants.e / (constants.h * constants.c)


def light_for(circuit, current_A):
    """Irradiance that gives a photocurrent at the reference temperature."""
    return current_A / (circuit.efficiency * circuit.cell_area_m2 * PHOTON_A_PER_W)


def two_cells(**changes):
    """Two cells in series, one bypass diode each, without resistances to speak of."""
    return Circuit(2, 1, cell=Cell(series_ohm=0.0, shunt_ohm=1e9), **changes)


class CurvesOfArrays(unittest.TestCase):
    thermal_V = constants.k * 298.15 / constants.e

    def test_published_curve_of_a_module(self):
        # cwhanse/ivcurves (BSD-3), test set case1, curve 1: 72 cells, 40 digits.
        cell = Cell(5e-10, 1.01, 0.1 / 72, 300.0 / 72)
        circuit = Circuit(72, 1, 1, 72, cell=cell)
        lit = LitCircuit(circuit, [light_for(circuit, 1.0)] * 72, 298.15)
        voltage = [0.0, 10.0374008535024597, 20.0748017070049194, 30.1122025605073809, 38.1421232433093493]
        current = [0.99966677771328115, 0.96621981099155219, 0.93274870238333074]
        current += [0.8940892507624992, 0.49556813052516346]
        np.testing.assert_allclose(lit.current_A([voltage])[0], current, rtol=1e-9)
        self.assertAlmostEqual(lit.open_voltage_V()[0], 39.7481073798697327, delta=1e-8)
        [(maximum_V, maximum_A)] = lit.maxima()[0]
        self.assertAlmostEqual(maximum_V * maximum_A, 28.7148160456399206, delta=1e-9)
        self.assertAlmostEqual(maximum_V, 33.9368943154555520, delta=1e-4)

    def test_ideal_cell_follows_the_diode_equation(self):
        circuit = two_cells()
        light_A = 0.7
        lit = LitCircuit(circuit, [light_for(circuit, light_A)] * 2, 298.15)
        self.assertAlmostEqual(lit.open_voltage_V()[0], 2.0 * self.thermal_V * math.log1p(light_A / 1e-11), delta=1e-8)
        self.assertAlmostEqual(lit.current_A([[0.0]])[0, 0], light_A, delta=1e-8)

    def test_bypass_diode_takes_the_current_of_a_shaded_cell(self):
        circuit = two_cells(cell_light=np.array([1.0, 0.4]))
        lit = LitCircuit(circuit, [light_for(circuit, 1.0)] * 2, 298.15)
        first = self.thermal_V * math.log1p((1.0 - 0.7) / 1e-11)
        self.assertAlmostEqual(lit.current_A([[first - circuit.drop_V]])[0, 0], 0.7, delta=1e-8)
        both = first + self.thermal_V * (math.log1p((0.4 - 0.3) / 1e-11) - math.log1p((1.0 - 0.7) / 1e-11))
        both += self.thermal_V * math.log1p((1.0 - 0.3) / 1e-11)
        self.assertAlmostEqual(lit.current_A([[both]])[0, 0], 0.3, delta=1e-8)
        # Two maxima, the same as a dense scan of the curve shows.
        maxima = lit.maxima()[0]
        self.assertEqual(len(maxima), 2)
        voltage = np.linspace(0.0, lit.open_voltage_V()[0], 20001)
        power = voltage * lit.current_A([voltage])[0]
        self.assertAlmostEqual(maxima[0][0] * maxima[0][1], power.max(), delta=1e-7)
        circuit.bypass_shorted[1] = True
        alone = LitCircuit(circuit, [light_for(circuit, 1.0)] * 2, 298.15)
        self.assertAlmostEqual(alone.open_voltage_V()[0], self.thermal_V * math.log1p(1.0 / 1e-11), delta=1e-8)

    def test_strings_in_parallel_add_their_currents(self):
        for blocking in (False, True):
            circuit = Circuit(4, 1, 2, 1, False, blocking, cell=Cell(series_ohm=0.02, shunt_ohm=50.0))
            light = light_for(circuit, np.array([1.0, 1.0, 0.5, 0.6]))
            single = Circuit(2, 1, 1, 1, False, blocking, cell=circuit.cell)
            voltage = np.linspace(0.0, 1.2, 7)
            parts = [LitCircuit(single, light[k : k + 2], 300.0).current_A([voltage])[0] for k in (0, 2)]
            whole = LitCircuit(circuit, light, 300.0)
            np.testing.assert_allclose(whole.current_A([voltage])[0], sum(parts), rtol=1e-9, atol=1e-10)
            dense = np.linspace(0.0, whole.open_voltage_V()[0], 5001)
            powers = dense * whole.current_A([dense])[0]
            best_V, best_A = whole.maxima()[0][0]
            self.assertAlmostEqual(best_V * best_A, powers.max(), delta=1e-6)
            self.assertAlmostEqual(whole.current_A([[whole.open_voltage_V()[0]]])[0, 0], 0.0, delta=1e-8)
            circuit.string_open[0] = True
            left = LitCircuit(circuit, light, 300.0).current_A([voltage])[0]
            np.testing.assert_allclose(left, parts[1], rtol=1e-9, atol=1e-10)

    def test_resistance_in_series_moves_the_voltage(self):
        for strings in (1, 2):
            circuit = Circuit(4, 1, strings, 1, False)
            light = [light_for(circuit, 0.8)] * 4
            voltage = np.linspace(0.0, 1.0, 5)
            current = LitCircuit(circuit, light, 298.15).current_A([voltage])[0]
            circuit.series_ohm = 0.3
            moved = LitCircuit(circuit, light, 298.15).current_A([voltage - 0.3 * current])[0]
            np.testing.assert_allclose(moved, current, rtol=1e-9)

    def test_open_circuit_falls_with_temperature(self):
        # M. A. Green, Solar Cells (1982), section 5.3: dV/dT = -(Eg - V + 3 k T / q) / T, at a constant gap.
        cell = Cell(series_ohm=0.0, shunt_ohm=1e9, gap_slope_per_K=0.0, photocurrent_slope_per_K=0.0)
        circuit = Circuit(1, 1, cell=cell)
        light = [[light_for(circuit, 0.8)]] * 3
        cold, middle, warm = LitCircuit(circuit, light, [319.95, 320.0, 320.05]).open_voltage_V()
        expected = -(cell.gap_eV - middle + 3.0 * constants.k * 320.0 / constants.e) / 320.0
        self.assertAlmostEqual((warm - cold) / 0.1, expected, delta=1e-7)

    def test_warm_cell_follows_its_coefficients(self):
        plain, other = Circuit(1, 1), Circuit(1, 1, voltage_V_per_K=-0.001, photocurrent_per_K=0.002)
        light = [light_for(plain, 0.8)]
        without, warm = (LitCircuit(c, light, 308.15) for c in (plain, other))
        # 10 K above the reference: the voltage moves by -10 mV, the photocurrent by 2 % of that at 25 °C.
        ratio = warm.current_A([[-0.01]])[0, 0] / without.current_A([[0.0]])[0, 0]
        self.assertAlmostEqual(ratio, (1.0 + 0.024) / (1.0 + 0.004), delta=1e-4)

    def test_serpentine_turns_at_the_end_of_a_line(self):
        self.assertEqual(Circuit(3, 2, along_columns=True).serpentine().tolist(), [0, 3, 4, 1, 2, 5])
        self.assertEqual(Circuit(3, 2, along_columns=False).serpentine().tolist(), [0, 1, 2, 5, 4, 3])


def plan(**counts):
    nothing = dict.fromkeys(("per_kind", "none", "pairs", "outside", "below"), 0)
    return types.SimpleNamespace(**(nothing | {"seed": 3, "dirty_share": 0.2} | counts))


def thinned(rows, count=30):
    return rows.take(np.arange(0, len(rows), 1 + len(rows) // count))


def drawn_setting(seed, kind):
    draw = setting.RoundedDraw(seed)
    world, sources, noise, recordings = setting.draw_setting(draw, [kind])
    return draw, world, sources, noise, recordings


class CasesOfLight(unittest.TestCase):
    def test_every_effect_changes_what_is_read(self):
        for number, kind in enumerate([*scenarios.KINDS, *scenarios.LAWS]):
            if kind == "tracker_trapped":  # shows where the array has two maxima, in few settings
                continue
            for seed in range(number, number + 500, 100):  # a dark cell may be bypassed, shaded or not
                draw, world, _, noise, recordings = drawn_setting(seed, kind)
                judge = identifiability.Judge(world, noise, {name: thinned(r, 10) for name, r in recordings.items()})
                recipe = effects.draw_recipe(draw, world, kind, 300.0)
                gain = judge.gain([recipe.at(1.0)])
                if gain > 1e-6:
                    break
            self.assertGreater(gain, 1e-6, kind)
            if recipe.has_strength:
                self.assertLess(judge.gain([recipe.at(1e-6)]), 0.01 * gain, kind)

    def test_scan_sees_a_shaded_cell_and_the_gain(self):
        _, world, _, _, recordings = drawn_setting(5, "detector_gain")
        rows = thinned(recordings["scan1"])
        before = readings.read(world, rows)
        effects.act(effects.Effect("cell_shaded", 0, {"factor": 0.5}), world)
        effects.act(effects.Effect("detector_gain", None, {"factor": 1.1}), world)
        ratio = readings.read(world, rows) / before
        plate, circuit = world.room.plate, world.circuit
        edge = [(plate.u_high_m - plate.u_low_m) / circuit.columns, (plate.v_high_m - plate.v_low_m) / circuit.rows]
        on_first = (rows.u_m < plate.u_low_m + edge[0]) & (rows.v_m < plate.v_low_m + edge[1])
        self.assertTrue(on_first.any() and not on_first.all())
        np.testing.assert_allclose(ratio, np.where(on_first, 0.55, 1.1), rtol=1e-12)

    def test_trapped_tracker_holds_the_second_maximum(self):
        room = Room(PLATE, [lamp_above(power_W=900.0)])
        circuit = Circuit(2, 1, cell_light=np.array([1.0, 0.4]), cell_area_m2=0.02)
        world = readings.World(room, circuit, trapped_s=[(1.0, 1.0)])
        level = np.tile([1.0, 0.0, 0.0, 0.0], (3, 1))
        rows = readings.Rows("run", True, level, time_s=np.arange(3.0), temperature_K=np.full(3, 298.15))
        read = readings.read(world, rows)
        np.testing.assert_allclose(read[0], read[2])
        self.assertGreater(abs(read[1, 0] - read[0, 0]), 0.1)
        self.assertLess(read[1].prod(), read[0].prod())

    def test_same_plan_gives_the_same_case(self):
        index = scenarios.KINDS.index("detector_gain")
        a, b = (scenarios.draw_case(plan(per_kind=1), index) for _ in range(2))
        self.assertEqual([e.kind for e in a.effects], ["detector_gain"])
        self.assertEqual((a.effects, a.sources, a.noise), (b.effects, b.sources, b.noise))
        self.assertGreater(a.chi2_gain, 2.0 * scenarios.SHOWS)
        self.assertIn(["detector_gain"], a.accept)
        # All lamps brighter by one factor are read as the same.
        self.assertIn(["source_power"], a.accept)
        self.assertNotIn(["led_aim"], a.accept)

    def test_plan_counts_its_families(self):
        some = plan(per_kind=1, none=2, pairs=3, outside=1, below=4)
        families = [scenarios._choose(some, k, 0)[0] for k in range(36)]
        counts = {family: families.count(family) for family in families}
        self.assertEqual(counts, {"single": 22, "none": 2, "pair": 3, "outside": 5, "below": 4})
        self.assertEqual(scenarios.case_count(some), 36)

    def test_turned_lamp_cannot_be_taken_for_a_weaker_one(self):
        _, world, _, noise, recordings = drawn_setting(5, "detector_gain")
        judge = identifiability.Judge(world, noise, {"scan1": recordings["scan1"]})
        names, indices, alone = judge.accepted([effects.Effect("led_aim", 1, {"angles_deg": [1.5, 0.5]})], 30.0)
        self.assertEqual(names, [["led_aim"]])
        self.assertEqual(indices, {"led_aim": [1]})
        self.assertLess(alone, 1.0)
