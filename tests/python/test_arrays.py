"""Arrays look at the library's own numbers."""

import gc
import unittest

import numpy as np
import photorque
from support import nominal


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.traced = photorque.trace(photorque.Experiment(nominal, keys={"trace.rays": 65536}))

    def test_two_views_of_a_map_share_their_memory(self):
        first = self.traced.flux_maps["solar_array"].irradiance_W_m2
        second = self.traced.flux_maps["solar_array"].irradiance_W_m2
        self.assertEqual(first.shape, (100, 100))
        self.assertTrue(np.shares_memory(first, second))
        self.assertFalse(first.flags.owndata)
        self.assertEqual(first.ctypes.data, second.ctypes.data)

    def test_value_and_error_stand_side_by_side(self):
        array = self.traced.flux_maps["solar_array"]
        value, error = array.irradiance_W_m2, array.irradiance_standard_error_W_m2
        self.assertEqual(error.ctypes.data - value.ctypes.data, 8)
        self.assertEqual(value.strides, (1600, 16))
        self.assertTrue((error >= 0).all())

    def test_views_cannot_be_written(self):
        with self.assertRaises(ValueError):
            self.traced.flux_maps["solar_array"].irradiance_W_m2[0, 0] = 1.0

    def test_an_array_outlives_its_run(self):
        traced = photorque.trace(photorque.Experiment(nominal, keys={"trace.rays": 65536}))
        values = traced.flux_maps["solar_array"].irradiance_W_m2
        column = traced.tables["absorbed_by_part"]["absorbed_W"]
        total = column.sum()
        copy = values.copy()
        del traced
        gc.collect()
        _ = [np.random.default_rng(1).random(10000) for _ in range(50)]
        np.testing.assert_array_equal(values, copy)
        self.assertEqual(column.sum(), total)

    def test_a_map_sums_to_the_power_on_it(self):
        array = self.traced.flux_maps["solar_array"]
        power_W = np.nansum(array.irradiance_W_m2 * array.area_m2)
        self.assertAlmostEqual(power_W, array.power_W.value, delta=1e-9 * power_W)

    def test_orientation_is_that_of_the_drawn_map(self):
        drawn = self.traced.maps["irradiance_solar_array"]
        array = self.traced.flux_maps["solar_array"]
        np.testing.assert_array_equal(drawn.value, array.irradiance_W_m2)
        self.assertEqual(drawn.extent, array.extent)
        self.assertEqual(drawn.unit, "W/m²")
