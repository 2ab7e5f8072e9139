"""Pages of runs (--page) in a headless Chromium: what they show is what summary.json and the tables say."""
import base64
import csv
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

from browser import Browser, program

SOURCE = pathlib.Path(os.environ["PHOTORQUE_SOURCE_DIR"])
PROGRAM = os.environ["PHOTORQUE_PROGRAM"]
NOMINAL = SOURCE / "scenes/stasis/nominal.toml"

# A square of 0.2 m in a node whose name tries to be a script.
HOSTILE = "</script><script>window.broken=1</script><img src=x onerror=window.broken=2>"
SQUARE = {
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"name": HOSTILE, "mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "materials": [{"name": "<b>black</b>", "extras": {"photorque": {"absorptance": 1.0}}}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-0.1, 0, -0.1], "max": [0.1, 0, 0.1]},
        {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
}
LAB = """
[scene]
file = "square.gltf"
[[source]]
kind = "led"
name = "<script>window.broken=3</script>"
power_W = 1.0
aperture_diameter_mm = 20
profile = "gaussian"
fwhm_deg = 6.0
wavelength_nm = 730
position_m = [0, 0, 0.5]
aim_m = [0, 0, 0]
[[receiver]]
node = '''%s'''
name = "board"
bins = [20, 20]
[trace]
rays = 65536
""" % HOSTILE


MOTION = """
[platform]
topology = "tabletop"
mass_kg = 5.0
inertia_kg_m2 = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.18]]
tilt_limit_deg = 20
[environment]
gravity_m_s2 = 9.80665
[[disturbance]]
kind = "static_unbalance"
offset_m = [0, 0, -1e-5]
[propagate]
duration_s = 40
output_rate_Hz = 2
initial_tilt_deg = 4
initial_rate_rad_s = [0, 0, 0.1]
"""


def write_square(folder):
    """A model of one square and an experiment that lights it, all with hostile names."""
    corners = [(-0.1, 0, -0.1), (0.1, 0, -0.1), (0.1, 0, 0.1), (-0.1, 0, 0.1)]
    data = b"".join(struct.pack("<3f", *c) for c in corners) + struct.pack("<6H", 0, 2, 1, 0, 3, 2)
    buffer = {"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}
    (folder / "square.gltf").write_text(json.dumps(dict(SQUARE, buffers=[buffer])))
    lab = folder / "<i>lab&amp;.toml"
    lab.write_text(LAB)
    return lab


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)


def rows(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def number(text):
    """The value of "(−1.5 ± 0.2)×10⁻⁹ N m", and half a unit of its last digit."""
    match = re.match(r"\(?(−?[\d.]+)(?: ± [\d.]+\))?(?: ± [\d.]+)?(?:×10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?", text)
    plain = match[1].replace("−", "-")
    exponent = int((match[2] or "0").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))
    decimals = len(plain.split(".")[1]) if "." in plain else 0
    return float(plain) * 10.0 ** exponent, 0.5001 * 10.0 ** (exponent - decimals)


def linear(encoded):
    """Of sRGB, IEC 61966-2-1."""
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def cube_root(luminance):
    """Of CIE 1976 lightness."""
    return luminance ** (1 / 3) if luminance > 216 / 24389 else (24389 / 27 * luminance + 16) / 116


def tearDownModule():
    if PageTest.browser:
        PageTest.browser.close()


class PageTest(unittest.TestCase):
    browser = None  # one for all tests: it takes seconds to start

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        PageTest.browser = PageTest.browser or Browser()

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def open(self, page):
        """Opens it; nothing goes wrong, and nothing is fetched but the page itself."""
        seconds = self.browser.open(page)
        self.assertEqual(self.browser.errors, [])
        self.assertEqual([url for url in self.browser.requests if not url.startswith(("data:", "blob:"))],
                         [pathlib.Path(page).resolve().as_uri()])
        return seconds

    def colours(self):
        """How many different colours the stage has."""
        return self.browser.value("""(() => {
          const from = document.getElementById('stage'), to = document.createElement('canvas');
          to.width = from.width; to.height = from.height;
          const context = to.getContext('2d');
          context.drawImage(from, 0, 0);
          return new Set(new Uint32Array(context.getImageData(0, 0, to.width, to.height).data.buffer)).size;
        })()""")

    def stage(self):
        self.browser.settle()
        return self.browser.value("document.getElementById('stage').toDataURL()")

    def assertShown(self, text, value):
        shown, half = number(text)
        self.assertLessEqual(abs(shown - value), half + 1e-12 * abs(value), f"{text} for {value}")

    def every_control_is_reached(self):
        """By the tab key, and what has the focus is outlined."""
        asked = "a[href], button, select, input, summary, [tabindex='0']"
        wanted = self.browser.value(f"""(() => {{
          window.wanted = [...document.querySelectorAll("{asked}")].filter((e) => e.checkVisibility() && !e.disabled);
          return window.wanted.length;
        }})()""")
        self.assertGreater(wanted, 10)
        reached = set()
        for _ in range(wanted + 2):
            self.browser.key("Tab", draws=False)
            at, style, width = self.browser.value("""(() => {
              const e = document.activeElement, style = getComputedStyle(e);
              return [window.wanted.indexOf(e), style.outlineStyle, parseFloat(style.outlineWidth)];
            })()""")
            if at < 0:
                continue
            reached.add(at)
            self.assertTrue(style != "none" and width >= 2, f"control {at} does not show its focus")
        self.assertEqual(len(reached), wanted)

    def text(self, selector):
        return self.browser.value(f"document.querySelector('{selector}').textContent")

    def slide_to(self, value):
        """Moves the first slider; `value` is JavaScript."""
        self.browser.value(f"""(() => {{
          const slider = document.getElementById('axis-0');
          slider.value = {value};
          slider.dispatchEvent(new Event('input'));
        }})()""")

    def read_map_at(self, across, down):
        """What the first map shows at these fractions of its width and height, from the upper left."""
        left, top, width, height = self.browser.value("""(() => {
          const field = document.querySelector('.field');
          field.scrollIntoView({ block: 'center' });
          const b = field.getBoundingClientRect();
          return [b.left, b.top, b.width, b.height];
        })()""")
        self.browser.point(left + across * width, top + down * height)
        return self.text(".map-section .reading b")

    def readings(self):
        """The readings beside the stage, in order: [label, value]."""
        return self.browser.value("""[...document.querySelectorAll('.readings dt')].map(
          (dt) => [dt.textContent, dt.nextElementSibling.textContent])""")


class Trace(PageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.out = cls.folder / "trace"
        run("trace", NOMINAL, "--set", "attitude.tilt_deg=20", "--set", "trace.rays=400000", "--page", "--out", cls.out, "--quiet")
        cls.page = cls.out / "page.html"

    def test_figures_are_those_of_the_summary(self):
        self.open(self.page)
        summary = json.loads((self.out / "summary.json").read_text())
        cells = self.browser.value("""[...document.querySelectorAll('#figures [data-key]')].map(
          (e) => [e.dataset.key, Number(e.dataset.value), Number(e.dataset.error), e.textContent])""")
        self.assertEqual([cell[0] for cell in cells],
                         [key for key, entry in summary.items() if isinstance(entry, dict) and "value" in entry])
        for key, value, error, text in cells:
            self.assertEqual(value, summary[key]["value"], key)
            self.assertEqual(error, summary[key]["standard_error"], key)
            self.assertShown(text, value)
        force = [summary[f"force_{axis}_platform_body_N"]["value"] for axis in "xyz"]
        shown = [value for label, value in self.readings() if label.startswith("body ")]
        for text, value in zip(shown[:3], force):
            self.assertShown(text, value)

    def test_stands_within_five_megabytes_and_shows_the_scene(self):
        self.assertLess(self.page.stat().st_size, 5e6)
        for width, height in ((2560, 1440), (1366, 768), (390, 844)):
            self.browser.size(width, height)
            self.assertLess(self.open(self.page), 30.0)
            self.assertGreater(self.colours(), 200, "the stage is empty")
            self.assertLessEqual(self.browser.value("document.documentElement.scrollWidth"), width)
        self.browser.size(1440, 900)

    def test_every_control_is_reached_by_tab_and_shows_it(self):
        self.open(self.page)
        self.every_control_is_reached()

    def test_colours_differ_without_red_or_green(self):
        """The ramp of the bar as eyes without red or green cones see it: G. M. Machado et al., "A Physiologically-based
        Model for Simulation of Color Vision Deficiency", IEEE TVCG 15 (2009), severity 1, in linear light."""
        self.open(self.page)
        ramp = self.browser.value("""(() => {
          const canvas = document.querySelector('.colour-bar canvas');
          return [...canvas.getContext('2d').getImageData(0, 0, 1, canvas.height).data];
        })()""")
        colours = [[linear(value / 255) for value in ramp[i:i + 3]] for i in range(0, len(ramp), 4)]
        self.assertEqual(len(colours), 256)
        for name, matrix in {
                "protanopia": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
                "deuteranopia": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
        }.items():
            seen = [[sum(m * v for m, v in zip(row, colour)) for row in matrix] for colour in colours]
            lightness = [116 * cube_root(0.2126 * r + 0.7152 * g + 0.0722 * b) - 16 for r, g, b in seen]
            # From the largest value down: ever darker, over most of the range of lightness, in even steps.
            steps = [above - below for above, below in zip(lightness, lightness[1:])]
            self.assertGreater(min(steps), -0.05, name)
            self.assertGreater(lightness[0] - lightness[-1], 60, name)
            self.assertLess(max(steps), 1.5, name)

    def test_map_is_read_by_pointer_and_keys(self):
        self.open(self.page)
        bins = {(float(row["x_m"]), float(row["y_m"])): row for row in rows(self.out / "irradiance_solar_array.csv")}
        columns, lines = (sorted({place[k] for place in bins}) for k in (0, 1))
        text = self.read_map_at(0.305, 0.505)
        self.assertTrue(text.endswith(" W/m²"), text)
        under_pointer = bins[columns[30], lines[49]]  # of 100 × 100, rows from below
        shown, half = number(text)
        self.assertLess(abs(shown - float(under_pointer["value_W_m2"])), half + 1e-7 * shown)  # single precision
        before = self.text(".map-section .reading")
        self.browser.value("document.querySelector('.field').focus()")
        self.browser.key("ArrowRight")
        self.assertNotEqual(before, self.text(".map-section .reading"))

    def test_stage_turns_by_keys(self):
        self.open(self.page)
        before = self.stage()
        self.browser.value("document.getElementById('stage').focus()")
        self.browser.key("ArrowLeft")
        self.assertNotEqual(before, self.stage())
        self.browser.key("Home")
        self.assertEqual(before, self.stage())


class TorqueMap(PageTest):
    def test_slider_moves_the_platform_and_reads_the_table(self):
        out = self.folder / "map"
        run("torque-map", NOMINAL, "--set", "torque_map.rays=100000", "--set", "torque_map.tilt_deg=[0,15,30]",
            "--set", "torque_map.heading_deg=[0,90]", "--page", "--out", out, "--quiet")
        self.open(out / "page.html")
        self.every_control_is_reached()
        upright = self.stage()
        self.browser.value("document.getElementById('axis-0').focus()")
        self.browser.key("ArrowRight")
        self.browser.key("ArrowRight")
        self.assertEqual(self.text(".axis output"), "30 deg")
        self.assertNotEqual(upright, self.stage())
        row = next(r for r in rows(out / "wrench_table_body.csv")
                   if float(r["tilt_deg"]) == 30.0 and float(r["heading_deg"]) == 0.0)
        shown = [value for label, value in self.readings() if label.startswith("body ")]
        names = [f"{what}_{axis}_{unit}" for what, unit in (("force", "N"), ("torque", "N_m")) for axis in "xyz"]
        for text, name in zip(shown, names, strict=True):
            self.assertShown(text, float(row[name]))
        power = rows(out / "power_over_attitude.csv")
        at = next(r for r in power if float(r["tilt_deg"]) == 30.0 and float(r["heading_deg"]) == 0.0)
        electric = dict(self.readings())["electric power"]
        self.assertShown(electric, float(at["electric_W"]))


class Propagate(PageTest):
    def compare_with_history(self, out):
        history = rows(out / "time_history.csv")
        stages = []
        for last in (False, True):
            self.slide_to("slider.max" if last else 0)
            stages.append(self.stage())
            shown, row = dict(self.readings()), history[-1 if last else 0]
            self.assertShown(shown["tilt"], float(row["tilt_deg"]))
            self.assertShown(shown["rate about body z"], float(row["rate_z_rad_s"]))
            total = [sum(float(value) for name, value in row.items()
                         if name.startswith("torque_") and name.endswith(f"_{axis}_N_m")) for axis in "xyz"]
            components = [value for label, value in self.readings() if label.startswith("body ")]
            for text, value in zip(components[:3], total, strict=True):
                self.assertShown(text, value)
        self.assertNotEqual(*stages)

    def test_platform_without_scene_moves_as_its_history_says(self):
        out = self.folder / "attitude"
        run("propagate", SOURCE / "scenes/stasis/attitude.toml", "--set", "propagate.duration_s=60", "--page", "--out", out, "--quiet")
        self.open(out / "page.html")
        self.compare_with_history(out)
        self.slide_to(0)
        line = self.browser.value("document.querySelector('.cursor').getAttribute('x1')")
        self.browser.value("document.querySelector('.play').click()")
        for _ in range(5):
            self.browser.settle()
        self.assertGreater(self.browser.value("Number(document.getElementById('axis-0').value)"), 0)
        self.assertNotEqual(line, self.browser.value("document.querySelector('.cursor').getAttribute('x1')"))

    def test_light_goes_with_the_platform(self):
        write_square(self.folder)
        lab = self.folder / "lit.toml"
        lab.write_text(LAB + MOTION)
        out = self.folder / "lit"
        run("propagate", lab, "--page", "--out", out, "--quiet")
        self.open(out / "page.html")
        self.assertIn("torque of light [N m]", dict(self.readings()))
        self.compare_with_history(out)
        self.assertGreater(self.colours(), 50)


class Diagnose(PageTest):
    def at(self, json_path, document):
        """The value that a figure's key names: "effects[0].parameters.dipole_A_m2[1]"."""
        *way, name = re.sub(r"\[(\d+)\]", r".\1", json_path).split(".")
        for step in way:
            document = document[int(step) if isinstance(document, list) else step]
        return document[int(name) if isinstance(document, list) else name]

    def assertFiguresAgree(self, found):
        cells = self.browser.value("""[...document.querySelectorAll('[data-key]')].map(
          (e) => [e.dataset.key, Number(e.dataset.value), e.textContent])""")
        cells = [cell for cell in cells if not cell[0].startswith(("effects", "priors_refined"))]
        self.assertIn("holdout.chi2_per_sample_after", [key for key, *_ in cells])
        for key, value, text in cells:
            self.assertEqual(value, self.at(key, found), key)
            self.assertShown(text, value)

    def test_motion_shows_measured_and_simulated_platform(self):
        case, out = SOURCE / "tests/data/cases/01", self.folder / "motion"
        run("diagnose", case / "experiment.toml", "--recording", case / "run1.csv.gz", "--holdout", case / "run2.csv.gz",
            "--page", "--out", out, "--quiet")
        self.open(out / "report.html")
        found = json.loads((out / "diagnosis.json").read_text())
        self.assertEqual(found["effects"][0]["kind"], "magnetic_dipole")
        self.assertEqual(self.text(".verdict-words"), "\u25c6Missing physics found")
        self.assertEqual(self.browser.value("document.querySelector('.finding h3').firstChild.textContent"), "magnetic dipole")
        dipole = found["effects"][0]["parameters"]["dipole_A_m2"]
        shown = self.browser.value("""[...document.querySelector('.finding').querySelectorAll('[data-key]')].map(
          (e) => [Number(e.dataset.value), Number(e.dataset.error), e.textContent])""")
        self.assertEqual([value for value, *_ in shown], dipole["value"])
        self.assertEqual([error for _, error, _ in shown], dipole["sigma"])
        self.assertFiguresAgree(found)
        # The platform moves, and the readings of the residual decrease with the improved model.
        before = self.stage()
        self.slide_to(300)
        self.assertNotEqual(before, self.stage())
        readings = dict(self.readings())
        self.assertIn("tilt, measured", readings)
        nominal, found_off = (number(readings[f"measured \u2212 {which} [arcsec]"])[0] for which in ("nominal", "found"))
        self.assertGreater(nominal, 0.0)
        self.assertGreater(found_off, 0.0)
        self.assertEqual(self.browser.value("document.querySelectorAll('.swatch').length"), 3)
        # Curves are those of the recording that is shown; what lies under the pointer is read.
        titles = "[...document.querySelectorAll('.chart')].filter((c) => !c.hidden).map((c) => c.firstChild.textContent)"
        self.assertTrue(all(title.endswith("run1.csv.gz") for title in self.browser.value(titles)))
        self.browser.value("document.getElementById('axis-1').focus()")
        self.browser.key("ArrowRight")
        self.assertTrue(all(title.endswith("run2.csv.gz") for title in self.browser.value(titles)))
        self.assertEqual(len(self.browser.value(titles)), 6)
        self.browser.value("[...document.querySelectorAll('.chart')].find((c) => !c.hidden).querySelector('svg').focus()")
        self.browser.key("ArrowRight")
        reading = self.browser.value("[...document.querySelectorAll('.chart')].find((c) => !c.hidden).querySelector('.reading').textContent")
        self.assertIn("residual, improved: ", reading)

    def test_a_scan_shows_its_readings_and_what_they_miss(self):
        write_square(self.folder)
        lab = self.folder / "scanned.toml"
        lab.write_text(LAB + "[sensors.irradiance]\nnoise_W_m2 = 0.2\n")
        run("trace", lab, "--out", self.folder / "nominal", "--quiet")
        # The lamp gives a fifth less than stated; noise by a rule in Python.
        scan, state = [], 1
        for row in rows(self.folder / "nominal/irradiance_board.csv"):
            total = 0.0
            for _ in range(12):  # the sum of twelve even draws: a variance of 1
                state = (1103515245 * state + 12345) % 2**31
                total += state / 2**31
            scan.append((row["x_m"], row["y_m"], f"{0.8 * float(row['value_W_m2']) + 0.2 * (total - 6.0):.4f}"))
        recording = self.folder / "scan.csv"
        recording.write_text("u_m,v_m,irradiance_W_m2\n" + "".join(",".join(row) + "\n" for row in scan))
        out = self.folder / "light"
        run("diagnose", lab, "--recording", recording, "--page", "--out", out, "--quiet")
        self.open(out / "report.html")
        found = json.loads((out / "diagnosis.json").read_text())
        self.assertEqual(found["verdict"], "missing_physics")
        self.assertFiguresAgree(found)
        self.assertGreater(self.colours(), 50)
        names = self.browser.value("[...document.querySelectorAll('.map-section option')].map((o) => o.textContent)")
        self.assertEqual([name.split(":")[0] for name in names],
                         ["Measured", "Nominal model", "Measured minus nominal model", "Measured minus improved model"])
        text = self.read_map_at(0.525, 0.475)  # of 20 x 20: the eleventh, from below too
        value = next(float(v) for x, y, v in scan if abs(float(x) - 0.005) < 1e-6 and abs(float(y) - 0.005) < 1e-6)
        shown, half = number(text)
        self.assertLess(abs(shown - value), half + 1e-6 * value, text)


class Hostile(PageTest):
    def test_names_of_files_are_never_markup(self):
        lab = write_square(self.folder)
        run("trace", lab, "--page", "--out", self.folder / "hostile", "--quiet")
        page = self.folder / "hostile/page.html"
        self.open(page)
        self.assertIsNone(self.browser.value("window.broken ?? null"))
        self.assertEqual(self.browser.value("document.querySelectorAll('script').length"), 2)
        self.assertEqual(self.browser.value("document.querySelectorAll('img, main b > b, main i > i').length"), 0)
        self.assertIn(HOSTILE, self.browser.value("document.body.innerText"))
        self.assertTrue(self.text("h1").startswith("<i>lab&amp;"))
        self.assertGreater(self.colours(), 50)


if __name__ == "__main__":
    if program() is None:
        print("page: Skipped\nno Chromium is installed (tools/install --tests)")
        sys.exit(0)
    unittest.main()
