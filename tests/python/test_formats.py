"""Files for other programs, read by their readers where these are installed."""

import importlib.util
import pathlib
import re
import shutil
import subprocess
import unittest

import numpy as np
import photorque
from support import FolderTest, nominal


def there(module):
    return importlib.util.find_spec(module) is not None


class Formats(FolderTest):
    def setUp(self):
        super().setUp()
        self.power = photorque.power(photorque.Experiment(nominal, keys={"trace.rays": 65536}))
        self.power.write(self.folder, formats=["vtkhdf"])

    @unittest.skipUnless(there("h5py"), "no h5py (python3-h5py)")
    def test_h5py_reads_everything_of_the_run(self):
        import h5py

        with h5py.File(self.folder / "run.h5") as file:
            for name, map in self.power.maps.items():
                np.testing.assert_array_equal(file[f"maps/{name}/value"][:], map.value)
            for name, figure in self.power.figures.items():
                value, error = file[f"figures/{name}"][:]
                self.assertEqual((value, error), (figure.value, figure.standard_error))
            for name, table in self.power.tables.items():
                for column, values in table.to_dict().items():
                    found = file[f"tables/{name}/{column}"]
                    if isinstance(values, list):
                        self.assertEqual([text.decode() for text in found[:]], values)
                    else:
                        np.testing.assert_array_equal(found[:], values)
            self.assertEqual(file.attrs["git_hash"].decode(), photorque.git_hash)

    @unittest.skipUnless(shutil.which("h5dump"), "no h5dump (hdf5-tools)")
    def test_h5dump_reads_a_figure_and_a_map(self):
        def dumped(path, *more):
            text = subprocess.run(["h5dump", "-m", "%.17g", "-y", "-w", "1", "-d", path, *more, self.folder / "run.h5"],
                                  check=True, capture_output=True, text=True).stdout
            return [float(x) for x in re.search(r"DATA \{(.*?)\}", text, re.S).group(1).split(",")]

        power = self.power.figures["array_power_W"]
        self.assertEqual(dumped("/figures/array_power_W"), [power.value, power.standard_error])
        some = dumped("/maps/irradiance_solar_array/value", "-s", "7,5", "-c", "1,10")
        self.assertEqual(some, list(self.power.maps["irradiance_solar_array"].value[7, 5:15]))

    @unittest.skipUnless(there("vtk"), "no VTK (python3-vtk9)")
    def test_vtk_reads_the_maps(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOHDF import vtkHDFReader

        reader = vtkHDFReader()
        reader.SetFileName(str(self.folder / "irradiance_solar_array.vtkhdf"))
        reader.Update()
        image = reader.GetOutput()
        map = self.power.maps["irradiance_solar_array"]
        height, width = map.value.shape
        self.assertEqual(image.GetDimensions(), (width, height, 2))
        values = vtk_to_numpy(image.GetPointData().GetArray("value")).reshape(2, height, width)
        np.testing.assert_array_equal(values[0], map.value)
        np.testing.assert_array_equal(values[1], map.value)
        errors = vtk_to_numpy(image.GetPointData().GetArray("standard_error"))
        np.testing.assert_array_equal(errors.reshape(2, height, width)[0], map.standard_error)
        x_low, _, y_low, _ = map.extent
        dx, dy, _ = image.GetSpacing()
        x, y, _ = image.GetPoint(0)
        self.assertAlmostEqual(x - dx / 2, x_low, places=12)
        self.assertAlmostEqual(y - dy / 2, y_low, places=12)


    def test_page(self):
        page = pathlib.Path(self.power.write_page(self.folder / "look.html")).read_text()
        self.assertTrue(page.startswith("<!doctype html>"))
        self.assertIn(repr(self.power.power_W.value)[:9], page)


class Sweeps(unittest.TestCase):
    def test_a_grid_is_its_runs(self):
        experiment = photorque.Experiment(nominal, keys={"trace.rays": 25088})
        reports = []
        axes = {"source[0].total_power_W": [88, 44], "attitude.tilt_deg": [0, 15, 30]}
        swept = photorque.sweep(experiment, axes, photorque.trace, ["power_on_solar_array_W", "emitted_W"],
                                progress=lambda task, done: reports.append(done))
        light = swept.figures["power_on_solar_array_W"]
        self.assertEqual(light.shape, (2, 3))
        alone = photorque.trace(experiment.with_keys({"source[0].total_power_W": 44, "attitude.tilt_deg": 15}))
        figure = alone.figures["power_on_solar_array_W"]
        self.assertEqual((light[1, 1], swept.standard_errors["power_on_solar_array_W"][1, 1]),
                         (figure.value, figure.standard_error))
        np.testing.assert_allclose(swept.figures["emitted_W"], [[88] * 3, [44] * 3], rtol=1e-12)
        self.assertEqual(swept.best("power_on_solar_array_W"),
                         {"source[0].total_power_W": 88, "attitude.tilt_deg": 0})
        self.assertEqual((len(reports), reports[-1]), (6, 1.0))
        with self.assertRaises(photorque.InputError):
            photorque.sweep(experiment, {"source[0].colour": [1]}, photorque.trace)
