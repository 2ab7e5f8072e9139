"""plot(), to_xarray() and progress_bar(): the numbers of the result are those that matplotlib draws."""

import contextlib
import importlib.util
import io
import unittest

import numpy as np
import photorque
from support import attitude, nominal

has_matplotlib = importlib.util.find_spec("matplotlib") is not None
if has_matplotlib:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot


@unittest.skipUnless(has_matplotlib, "no matplotlib")
class Plots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.power = photorque.power(photorque.Experiment(nominal, keys={"trace.rays": 2**14}))

    def tearDown(self):
        pyplot.close("all")

    def test_a_map_is_the_image(self):
        axes = self.power.plot("irradiance_solar_array")
        image, = axes.get_images()
        np.testing.assert_array_equal(image.get_array(), self.power.maps["irradiance_solar_array"].value)
        self.assertEqual(tuple(image.get_extent()), self.power.maps["irradiance_solar_array"].extent)
        torque, = self.power.maps["torque_x_solar_array"].plot().get_images()
        low, high = torque.get_clim()
        self.assertEqual(low, -high)

    def test_curves_are_those_of_the_table(self):
        axes = pyplot.figure().add_subplot()
        self.assertIs(self.power.plot("iv_curve", axes), axes)
        voltage_V, current_A = axes.lines[0].get_data()
        np.testing.assert_array_equal(voltage_V, self.power.curve["voltage_V"])
        np.testing.assert_array_equal(current_A, self.power.curve["current_A"])
        self.assertEqual(axes.get_ylabel(), "current [A]")

    def test_a_waterfall_has_a_bar_for_every_stage(self):
        axes = self.power.plot("loss_waterfall")
        losses = self.power.tables["losses"]
        power_W = losses["power_W"]
        # The first stage, the losses after it, and the last stage from zero.
        heights = [power_W[0], *(-losses["lost_W"][1:]), power_W[-1]]
        np.testing.assert_allclose([bar.get_height() for bar in axes.patches], heights, rtol=1e-12)
        np.testing.assert_allclose([bar.get_y() for bar in axes.patches], [0, *power_W[:-1], 0], rtol=1e-12)
        names = [label.get_text() for label in axes.get_xticklabels()]
        self.assertEqual(names, [losses["stage"][0], *losses["lost_to"][1:], losses["stage"][-1]])

    def test_panels_share_time(self):
        motion = photorque.propagate(photorque.Experiment(attitude, keys={"propagate.duration_s": 5}))
        axes = motion.plot("rates")
        self.assertEqual(len(axes), 3)
        np.testing.assert_array_equal(axes[1].lines[0].get_ydata(), motion.history["rate_y_rad_s"])

    def test_a_result_shows_its_first_figures(self):
        self.assertRegex(repr(self.power), r"^<power: emitted_W = 88, absorbed_W = 76\.[0-9]+ ± .*, …>$")

    def test_all_of_a_run_and_names_that_it_lacks(self):
        self.assertEqual(len(self.power.plot()), len(self.power.maps) + len(self.power.plots))
        with self.assertRaisesRegex(KeyError, "no map or plot 'iv', expected one of .*iv_curve"):
            self.power.plot("iv")

    @unittest.skipUnless(importlib.util.find_spec("xarray"), "no xarray")
    def test_xarray_has_the_middles_of_the_bins(self):
        field = self.power.maps["irradiance_solar_array"]
        data = field.to_xarray()
        left, right = field.extent[:2]
        width_m = (right - left) / field.value.shape[1]
        np.testing.assert_allclose(data.x, np.linspace(left + width_m / 2, right - width_m / 2, len(data.x)))
        np.testing.assert_array_equal(data.value, field.value)
        np.testing.assert_array_equal(data.standard_error, field.standard_error)

    def test_a_bar_ends_full(self):
        text = io.StringIO()
        with contextlib.redirect_stdout(text):
            bar = photorque.progress_bar(width=4)
            bar("tracing", 0.5)
            bar("tracing", 1.0)
        self.assertEqual(text.getvalue(), "\r[##..]  50 % tracing\r[####] 100 % tracing\n")
