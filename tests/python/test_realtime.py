"""The client of `serve` in Python: over UDP, in lockstep, against the program."""

import re
import struct
import subprocess
import unittest

from photorque import realtime
from support import FolderTest, files_of, program, source

PLATFORM = """[platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
[[disturbance]]
kind = "static_unbalance"
offset_m = [2e-6, -1e-6, -3e-5]
[sensors.camera]
noise_arcsec = [37, 37, 12]
[sensors.gyro]
noise_rad_s = 2e-4
[propagate]
duration_s = 2
initial_tilt_deg = 3
[serve]
mode = "lockstep"
port = 0
"""


def content(text):
    return b"\n".join(line for line in text.split(b"\n") if not line.startswith(b"#"))


class Lockstep(FolderTest):
    def served(self, name, *more, **client):
        (self.folder / "p.toml").write_text(PLATFORM)
        command = [program, "serve", str(self.folder / "p.toml"), "--out", str(self.folder / name), *more]
        seen = []
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            said = server.stdout.readline()
            found = re.search(r"127\.0\.0\.1:(\d+)", said)
            if found:
                client["port"] = int(found.group(1))
            with realtime.Client(**client) as one:
                for measurement in one.measurements():
                    seen.append(measurement)
                    one.command([-0.1 * rate for rate in measurement.gyro_rad_s])
            server.stdout.read()
        self.assertEqual(server.returncode, 0)
        return seen, files_of(self.folder / name)

    def test_is_the_run_that_propagate_computes(self):
        seen, files = self.served("s")
        self.assertEqual([m.tick for m in seen], list(range(320)))
        self.assertTrue(all(m.is_new and m.wants_answer for m in seen))
        again = self.run_program(
            "propagate", self.folder / "p.toml", "--set", "propagate.tick_rate_Hz=160", "--set",
            "propagate.output_rate_Hz=160", "--set",
            f'propagate.commands="{self.folder / "s" / "commands.csv"}"')
        self.assertEqual(content(files["recording.csv"]), content(again["recording.csv"]))


class Packets(unittest.TestCase):
    def test_sizes_are_those_of_the_header(self):
        text = (source / "tools/realtime/gate.cpp").read_text()
        sizes = dict(re.findall(r"sizeof\(photorque_(\w+)\) == (\d+)", text))
        self.assertEqual(realtime._HEADER.size, int(sizes["header"]))
        self.assertEqual(realtime._HEADER.size + realtime._COMMAND.size, int(sizes["command_packet"]))
        self.assertEqual(realtime._SIZE, int(sizes["measurement_packet"]))

    def test_damaged_packets_are_nothing(self):
        body = realtime._MEASUREMENT.pack(*[0] * 3, *[0.0] * 22, realtime.NEW, 0)
        packet = realtime.seal(realtime.MEASUREMENT, 1, 2, 3, body)
        run, measurement = realtime.unseal(packet)
        self.assertEqual((run, measurement.tick, measurement.is_new), (3, 2, True))
        self.assertIsNone(realtime.unseal(packet[:-1]))
        for at in range(0, len(packet), 7):
            damaged = bytearray(packet)
            damaged[at] ^= 0x10
            self.assertIsNone(realtime.unseal(bytes(damaged)), at)
        self.assertIsNone(realtime.unseal(struct.pack("<256x")))
