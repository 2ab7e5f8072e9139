"""Scores of hand-made answers, their tables, and the sections of documents."""

import json
import math
import pathlib
import tempfile
import unittest

from validation import blind_run, files, plan, tables
from validation.errors import InputError
from validation.scoring import CaseScore, Fraction, figures, questions, score_case


def tone(torque, phase):
    return {"kind": "periodic_torque", "torque_N_m": torque, "frequency_Hz": 1.0, "phase": phase}


def found_tone(torque, phase):
    parameters = {"torque_N_m": {"value": torque, "sigma": [1e-6] * 3}, "frequency_Hz": {"value": 1.001, "sigma": 0.001},
                  "phase": {"value": phase, "sigma": 0.1}}  # fmt: skip
    return {"verdict": "missing_physics", "confidence": 0.9,
            "effects": [{"kind": "periodic_torque", "probability": 0.9, "parameters": parameters}]}  # fmt: skip


def truth(verdict, accept, effects, **more):
    return {"verdict": verdict, "accept": accept, "effects": effects, **more}


CONSISTENT = truth("consistent", [[]], [])
QUIET = {"verdict": "consistent", "confidence": 0.9, "effects": []}


def hits_of(scores, part):
    """(hits, of) of the question with `part` in its text."""
    return next((f.hits, f.of) for text, f, _ in questions(scores) if part in text)


class Scores(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def scored(self, truth_of_case, diagnosis, runs=None):
        for name, value in (("truth", truth_of_case), ("diagnosis", diagnosis)):
            files.write_file(self.folder / name / f"{name}.json", json.dumps(value))
        if runs is not None:
            files.write_file(self.folder / "diagnosis" / "runs.json", json.dumps(runs))
        return score_case(self.folder / "truth", self.folder / "diagnosis", self.folder / "none")

    def test_a_tone_turned_round_half_a_period_later_is_the_same(self):
        wanted = truth("missing_physics", [["periodic_torque"]], [tone([1e-5, -2e-5, 0.0], 0.5)])
        for found in (found_tone([1.2e-5, -2e-5, 0], 0.6), found_tone([-1.2e-5, 2e-5, 0], 0.6 + math.pi),
                      found_tone([-1.2e-5, 2e-5, 0], 0.6 - 3 * math.pi)):  # fmt: skip
            score = self.scored(wanted, found)
            self.assertTrue(score.right)
            self.assertEqual(len(score.pulls), 5)
            # Two sigma in one component of the amplitude, one in the frequency, one in the phase.
            self.assertAlmostEqual(sum(p * p for p in score.pulls), 6.0, places=6)

    def test_a_wrong_phase_shows(self):
        wanted = truth("missing_physics", [["periodic_torque"]], [tone([1e-5, -2e-5, 0.0], 0.5)])
        pulls = self.scored(wanted, found_tone([1e-5, -2e-5, 0], 1.5)).pulls
        self.assertAlmostEqual(max(map(abs, pulls)), 10.0, places=6)

    def test_wrong_names_and_false_alarms(self):
        score = self.scored(truth("missing_physics", [["tether"]], [{"kind": "tether"}]), found_tone([1e-5, 0, 0], 0.0))
        self.assertEqual((score.right, score.wrong_name, score.verdict_right), (False, True, True))
        self.assertTrue(self.scored(CONSISTENT, found_tone([1e-5, 0, 0], 0.0)).false_alarm)
        quiet = self.scored(CONSISTENT, QUIET)
        self.assertEqual((quiet.right, quiet.false_alarm), (True, False))

    def test_friction_that_drives_is_beyond_physics(self):
        wanted = truth("missing_physics", [["dry_friction"]], [{"kind": "dry_friction", "torque_N_m": 1e-6}])
        for value, impossible in ((1.1e-6, []), (-1.1e-6, ["dry_friction.torque_N_m"])):
            found = {"verdict": "missing_physics", "confidence": 0.9, "effects": [
                {"kind": "dry_friction", "probability": 0.9, "parameters": {"torque_N_m": {"value": value, "sigma": 1e-7}}}]}
            self.assertEqual(self.scored(wanted, found).impossible, impossible)

    def test_names_may_be_swapped_within_their_group(self):
        wanted = truth("missing_physics", [["tether"]], [{"kind": "tether"}])
        found = {"verdict": "missing_physics", "effects": [
            {"kind": "room_draft", "probability": 0.5, "indistinguishable_from": ["tether"]}]}
        score = self.scored(wanted, found)
        self.assertEqual((score.right, score.right_within_group), (False, True))
        self.assertTrue(math.isnan(score.confidence))

    def test_a_known_effect_beside_an_unknown_law_may_be_named_or_not(self):
        wanted = truth("unexplained", [["tether"], []], [{"kind": "tether"}, {"kind": "heading_cogging"}],
                       depends_on=["heading"])  # fmt: skip
        tether = {"kind": "tether", "probability": 0.9}
        where = {"depends_on": [{"variable": "heading"}]}
        named = self.scored(wanted, {"verdict": "unexplained", "effects": [tether], "where": where})
        self.assertEqual((named.right, named.known_named, named.dependence_right), (True, True, True))
        quiet = self.scored(wanted, {"verdict": "unexplained", "effects": []})
        self.assertEqual((quiet.right, quiet.known_named, quiet.dependence_right), (True, False, False))
        self.assertFalse(self.scored(wanted, {"verdict": "missing_physics", "effects": [tether]}).right)
        wrong = self.scored(wanted, {"verdict": "unexplained", "effects": [{"kind": "dry_friction"}]})
        self.assertEqual((wrong.right, wrong.wrong_name), (False, True))

    def test_indices_of_lamps_are_judged(self):
        wanted = truth("missing_physics", [["led_failed"]], [{"kind": "led_failed"}], accept_index={"led_failed": [3, 4]})
        for index, right in ((3, 1), (5, 0)):
            found = {"verdict": "missing_physics", "effects": [
                {"kind": "led_failed", "probability": 1.0, "parameters": {"index": {"value": [index]}}}]}
            score = self.scored(wanted, found)
            self.assertEqual((score.indices, score.indices_right), (1, right))

    def test_an_improved_experiment_has_to_propagate_as_stated(self):
        answer = QUIET | {"fit": {"chi2_per_sample_after": 1.1}}
        runs = {"processor_s": 3.0, "exit_status": 0, "replay_status": 0, "replay_chi2": 1.2}
        self.assertTrue(self.scored(CONSISTENT, answer, runs).replays_as_stated)
        self.assertFalse(self.scored(CONSISTENT, answer, runs | {"replay_chi2": 4.0}).replays_as_stated)
        # Where the attitudes' own misfit is stated, that is what they have to repeat: 0.2 + 1.33 · 3 = 4.19.
        channels = [{"name": "gyro_x_rad_s", "chi2_of_median": 9.0}, {"name": "attitude_x_arcsec", "chi2_of_median": 2.0},
                    {"name": "attitude_y_arcsec", "chi2_of_median": 4.0}]  # fmt: skip
        answer["fit"]["channels"] = channels
        self.assertTrue(self.scored(CONSISTENT, answer, runs | {"replay_chi2": 4.1}).replays_as_stated)
        self.assertFalse(self.scored(CONSISTENT, answer, runs | {"replay_chi2": 4.3}).replays_as_stated)
        failed = self.scored(CONSISTENT, answer, {"exit_status": 3, "replay_status": 2})
        self.assertFalse(failed.replays_as_stated)
        self.assertEqual(hits_of([failed], "exits other than 0"), (1, 1))

    def test_an_answer_that_cannot_be_read_is_none(self):
        for text in ("{", '{"effects": []}', '{"effects": [{}], "verdict": "consistent"}'):
            files.write_file(self.folder / "truth" / "truth.json", json.dumps(CONSISTENT))
            files.write_file(self.folder / "diagnosis" / "diagnosis.json", text)
            score = score_case(self.folder / "truth", self.folder / "diagnosis", self.folder)
            self.assertFalse(score.answered)
            self.assertTrue(score.failure)
        files.write_file(self.folder / "truth" / "truth.json", '{"verdict": "consistent"}')
        with self.assertRaises(InputError):
            score_case(self.folder / "truth", self.folder / "diagnosis", self.folder)


class Counts(unittest.TestCase):
    def test_contradictions_and_oracles(self):
        def answer(**more):
            return CaseScore("a", answered=True, verdict="missing_physics", **more)

        scores = [answer(predictive_sigma=1.2), answer(predictive_sigma=7.0), answer()]
        self.assertEqual(hits_of(scores, "above the prediction"), (1, 2))
        self.assertEqual(hits_of(scores, "without a stated prediction"), (1, 3))
        scores = [answer(oracle_chi2=1.0, holdout_chi2=h, expected_chi2=e) for h, e in ((1.0, 1.01), (1.2, 1.02), (3.0, 2.5))]
        self.assertEqual(hits_of(scores, "within 10 %"), (1, 3))
        self.assertEqual(hits_of(scores, "as above, if parameter"), (1, 2))

    def test_calibration_is_the_mean_distance_by_bins(self):
        """Ten answers at 0.9 of which six are right, ten at 0.45 of which five are: (|9 − 6| + |4.5 − 5|)/20."""
        scores = [CaseScore("a", answered=True, confidence=0.9 if i < 10 else 0.45, right=i < 6 or i >= 15)
                  for i in range(20)]  # fmt: skip
        self.assertAlmostEqual(figures(scores)["confidence_calibration_error"][0], 0.175, places=12)

    def test_every_answer_is_in_the_table_of_calibration(self):
        """Another program may state more than 1 by rounding."""
        scores = [CaseScore("a", answered=True, confidence=1.0 + 4e-16 if i == 0 else i / 11.0) for i in range(12)]
        self.assertEqual(sum(row[2] for row in tables.confidence(scores)[1]), 12)

    def test_pulls_have_their_level(self):
        scores = [CaseScore("a", true_verdict="missing_physics", true_kinds=["tether"], right=True, pulls=[2.0, -1.0])]
        values = figures(scores)
        self.assertAlmostEqual(values["pulls_rms"][0], math.sqrt(2.5))
        self.assertEqual(values["pulls_within_1_sigma"][0], 0.5)

    def test_intervals_are_wilsons(self):
        """The closed form of the paper with z = 1.959964, for 8 of 10."""
        self.assertAlmostEqual(Fraction(8, 10).low, 0.4901625, places=4)
        self.assertAlmostEqual(Fraction(8, 10).high, 0.9433178, places=4)

    def test_a_section_is_renewed_and_nothing_else(self):
        page = "a\n<!-- x begin -->\nold\n<!-- x end -->\nb\n"
        self.assertEqual(tables.with_section(page, "x", "new\n", "page"),
                         "a\n<!-- x begin -->\n\nnew\n\n<!-- x end -->\nb\n")  # fmt: skip
        with self.assertRaises(InputError):
            tables.with_section(page, "y", "new\n", "page")

    def test_a_page_has_all_tables_and_wrong_cases(self):
        scores = [CaseScore("tether_01", "single", "first", "missing_physics", "missing_physics", ["tether"], ["tether"],
                            500.0, answered=True, right=True),
                  CaseScore("none_01", "none", "second: rest, a minute", "consistent", "unexplained", answered=True)]  # fmt: skip
        text = tables.markdown("Cases", "Two.", scores)
        self.assertIn("| all cases: verdict and names right | 1 of 2 | 50.0 % | 9.5 % to 90.5 % | ≥ 95 % |", text)
        self.assertIn(("maker second: rest", 1, 0), [row[:3] for row in tables.by_family(scores)[1]])
        self.assertIn("| none_01 | consistent: – | – | unexplained: – |", text)
        for make in tables.TABLES.values():
            columns, rows = make(scores)
            self.assertTrue(all(len(row) == len(columns) for row in rows))
            tables.csv_text((columns, rows), {"seed": 1})


class Replays(unittest.TestCase):
    def test_the_noise_is_the_one_found(self):
        diagnosis = {"instruments": [{"channel": "attitude_y_arcsec", "what": "noise_level", "value": 67.0},
                                     {"channel": "attitude_z_arcsec", "what": "correlation_time", "value": 3.0},
                                     {"channel": "gyro_x_rad_s", "what": "noise_level", "value": 2e-4}]}  # fmt: skip
        self.assertEqual(blind_run.found_noise_arcsec(diagnosis, [37.0, 37.0, 12.0]), [37.0, 67.0, 12.0])

    def test_a_turn_of_one_sigma_about_every_axis(self):
        """Each axis off by one sigma: the median of the squares is 1, over 0.4549 of a normal distribution."""
        with tempfile.TemporaryDirectory() as holder:
            folder, half = pathlib.Path(holder), 0.5 * math.radians(10.0 / 3600.0)
            rows = [f"{0.1 * i:.3f},1,{half:.12f},{half:.12f},{half:.12f}" for i in range(50)]
            files.write_gzip(folder / "read.csv.gz", "# log\nt_s,q_w,q_x,q_y,q_z\n0.05,,,,\n" + "\n".join(rows) + "\n")
            still = [f"{0.01 * i:.3f},1,0,0,0" for i in range(600)]
            files.write_file(folder / "replay.csv", "t_s,q_w,q_x,q_y,q_z\n" + "\n".join(still) + "\n")
            chi2 = blind_run.replayed_chi2(folder / "read.csv.gz", folder / "replay.csv", [10.0] * 3)
        self.assertAlmostEqual(chi2, 1.0 / 0.454936, places=4)

    def test_a_program_is_stopped_and_its_errors_kept(self):
        stopped = blind_run.run_child("/bin/sh", ["-c", "while :; do :; done"], "/", 1.0)
        self.assertEqual(stopped.status, -1)
        self.assertIn("stopped after 1 s", stopped.errors)
        failed = blind_run.run_child("/bin/sh", ["-c", "echo why >&2; exit 3"], "/", 10.0)
        self.assertEqual((failed.status, failed.errors), (3, "why\n"))
        with self.assertRaises(KeyboardInterrupt):
            blind_run.run_child("/bin/sh", ["-c", "kill -TERM $$"], "/", 10.0)


class Plans(unittest.TestCase):
    def read(self, text, overrides=()):
        with tempfile.TemporaryDirectory() as holder:
            path = pathlib.Path(holder) / "plan.toml"
            path.write_text(text)
            return plan.read_plan(path, overrides)

    def test_values_and_overrides(self):
        read = self.read("[prove]\nseed = 3\nrates_Hz = [5]\n", ["prove.none=7", "prove.section=cases"])
        self.assertEqual((read.seed, read.rates_Hz, read.none, read.section), (3, (5.0,), 7, "cases"))

    def test_every_wrong_value_is_refused_in_one_line(self):
        for key in plan._RULES:
            wrong = "7" if key in ("oracle", "replay", "of", "section", "document", "rates_Hz") else "true"
            with self.assertRaisesRegex(InputError, f"plan.toml: prove.{key}: found .*, expected [^\n]*$"):
                self.read(f"[prove]\n{key} = {wrong}\n")
        for text in ("", "[prove]\nnothing = 1\n", "[prove]\n[other]\n", "[prove\n"):
            with self.assertRaises(InputError):
                self.read(text)
