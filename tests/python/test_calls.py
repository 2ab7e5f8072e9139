"""Progress, Ctrl-C, other threads, and what a call costs."""

import os
import signal
import threading
import time
import unittest

import photorque
from support import nominal


class Calls(unittest.TestCase):
    experiment = photorque.Experiment(nominal, keys={"trace.rays": 2**20})

    def test_progress_rises_to_one(self):
        reports = []
        photorque.trace(self.experiment, progress=lambda task, fraction: reports.append((task, fraction)))
        fractions = [fraction for _, fraction in reports]
        self.assertEqual({task for task, _ in reports}, {"tracing"})
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(fractions[-1], 1.0)

    def test_log_is_what_the_program_prints(self):
        lines = []
        photorque.trace(self.experiment, log=lines.append)
        self.assertIn("Sources", lines)
        self.assertTrue(any(line.startswith("  emitted") for line in lines))

    def test_what_a_callback_raises_ends_the_run(self):
        def stop(task, fraction):
            raise KeyError("enough")

        with self.assertRaises(KeyError):
            photorque.trace(self.experiment, progress=stop)

    def test_ctrl_c_ends_a_long_run(self):
        long = self.experiment.with_keys({"trace.rays": 2**32})
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        start = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            photorque.trace(long)
        self.assertLess(time.monotonic() - start, 20)

    def test_other_threads_go_on(self):
        beats, stop = [], threading.Event()

        def beat():
            while not stop.wait(0.002):
                beats.append(time.monotonic())

        thread = threading.Thread(target=beat)
        thread.start()
        begin = time.monotonic()
        photorque.trace(self.experiment)
        end = time.monotonic()
        stop.set()
        thread.join()
        during = [t for t in beats if begin < t < end]
        # With the lock held throughout there would be none.
        self.assertGreater(len(during), 10)

    def test_the_same_bits_at_any_number_of_threads(self):
        one = photorque.trace(self.experiment, threads=1).flux_maps["solar_array"]
        three = photorque.trace(self.experiment, threads=3).flux_maps["solar_array"]
        self.assertEqual(one.irradiance_W_m2.tobytes(), three.irradiance_W_m2.tobytes())
