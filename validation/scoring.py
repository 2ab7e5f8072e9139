"""Scores of diagnoses compared with the injected effects, for motion and for light."""

import dataclasses
import itertools
import math
import pathlib
import statistics

from .errors import InputError
from .files import read_json
from .laws import is_possible

VISIBLE_GAIN = 30.0  # of chi², above which a name is required
HOPELESS_GAIN = 6.0  # of chi², below which nothing can be concluded
STRONG_GAIN = 5e4
MAX_SIGMA = 5.0  # of the held-out residuals above the prediction
MAX_OVER_ORACLE = 1.1
MAX_EXPECTED = 1.05
NAN = math.nan


@dataclasses.dataclass
class CaseScore:
    """Outcome of one case. NaN: not stated."""

    name: str
    family: str = "case"
    maker: str = ""
    true_verdict: str = ""
    verdict: str = ""
    true_kinds: list = dataclasses.field(default_factory=list)
    kinds: list = dataclasses.field(default_factory=list)
    chi2_gain: float = NAN  # visibility of the injected effects in the data
    answered: bool = False  # a diagnosis.json was written
    failure: str = ""  # message of the program instead of an answer
    exit_status: int = 0  # of `diagnose`; −1: stopped
    verdict_right: bool = False
    right: bool = False  # verdict and set of names are accepted by the truth
    right_within_group: bool = False  # as `right`, up to names that the answer calls indistinguishable
    false_alarm: bool = False  # an effect named, or "unexplained", although nothing is missing
    wrong_name: bool = False  # an effect named that neither acts nor is accepted
    dependence_right: bool = False  # for an unknown law: the first variable named is correct
    known_named: bool = False  # with an unknown law: exactly the known effects were named
    indices: int = 0  # effects on one lamp, cell, string or diode with a correct name
    indices_right: int = 0  # number of these with a correct index
    impossible: list = dataclasses.field(default_factory=list)  # named numbers outside physical bounds
    confidence: float = NAN
    claims: list = dataclasses.field(default_factory=list)  # (stated probability of a name, whether it is correct)
    pulls: list = dataclasses.field(default_factory=list)  # (fitted − true) / sigma
    holdout_chi2: float = NAN  # per number, with the improved model
    oracle_chi2: float = NAN
    predictive_chi2: float = NAN  # holdout_chi2 predicted by diagnose
    predictive_sigma: float = NAN  # standard errors of holdout_chi2 above the prediction
    expected_chi2: float = NAN  # holdout_chi2 expected from the errors of the parameters
    fit_chi2: float = NAN  # per number of the recording, with the improved model
    attitude_chi2: float = NAN  # as fit_chi2, of the attitudes only, by medians
    replay_status: float = NAN  # exit status of the propagation of improved.toml
    replay_chi2: float = NAN
    processor_s: float = NAN

    # Types of cases.

    @property
    def is_outside(self):
        return self.true_verdict == "unexplained"

    @property
    def is_none(self):
        return not self.true_kinds

    @property
    def is_inside(self):
        return not self.is_outside and not self.is_none

    @property
    def is_visible(self):
        """Whether the readings show the effects of the catalogue. Cases from other sources do not state their gain
        and are all meant to be visible."""
        return self.is_inside and self.true_verdict == "missing_physics" and not self.chi2_gain <= VISIBLE_GAIN

    @property
    def names_missing_physics(self):
        return self.answered and self.verdict == "missing_physics"

    @property
    def replays_as_stated(self):
        """Whether improved.toml propagates and its attitudes deviate from the recorded ones by no more than the
        diagnosis states for its fit, with a tolerance of a third and 0.2."""
        stated = self.attitude_chi2 if math.isfinite(self.attitude_chi2) else self.fit_chi2
        return self.replay_status == 0 and self.replay_chi2 <= 0.2 + 1.33 * max(1.0, stated)


# Reading one case.


def _number(table, key):
    value = table.get(key) if isinstance(table, dict) else None
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else NAN


def _numbers(value):
    if isinstance(value, (int, float)):
        return [float(value)]
    if not isinstance(value, list):
        return []
    return [float(x) if isinstance(x, (int, float)) else NAN for x in value]


def _true_number(effect, key):
    """True number of a key. Older cases write "attitude_latency_s" for the experiment's key "latency_s"."""
    unit = key.rfind("_")
    return effect.get(key, effect.get(effect.get("kind", "") + key[unit:]) if unit >= 0 else None)


def _value_and_truth(parameters, truth):
    for key, fitted in parameters.items():
        wanted = _true_number(truth, key)
        if wanted is not None and isinstance(fitted, dict):
            yield key, _numbers(fitted.get("value")), _numbers(fitted.get("sigma")), _numbers(wanted)


def _is_turned_round(parameters, truth):
    """Whether a sinusoid was found with inverted amplitude half a period later, which is the same sinusoid."""
    if "phase" not in parameters:
        return False
    for key, value, _, wanted in _value_and_truth(parameters, truth):
        if key != "phase" and len(value) == len(wanted) == 3:
            return sum(a * b for a, b in zip(value, wanted, strict=True)) < 0.0
    return False


def _pulls(found, truth):
    parameters = found.get("parameters", {})
    turned, pulls = _is_turned_round(parameters, truth), []
    for key, value, sigma, wanted in _value_and_truth(parameters, truth):
        if key == "axis" or not len(value) == len(sigma) == len(wanted):  # sign and length of an axis have no meaning
            continue
        flips = turned and len(wanted) == 3
        for v, s, w in zip(value, sigma, wanted, strict=True):
            miss = (-v if flips else v) - w
            if key == "phase":
                miss = math.remainder(miss + (math.pi if turned else 0.0), 2.0 * math.pi)
            if s > 0.0 and math.isfinite(miss):
                pulls.append(miss / s)
    return pulls


def _can_be(doubles, wanted):
    """Whether the set of names equals `wanted` after each name is kept or replaced by one of its alternatives."""
    return len(doubles) == len(wanted) and any(
        all(name in names for name, names in zip(order, doubles, strict=True)) for order in itertools.permutations(wanted)
    )


def _judge(score, truth, diagnosis, nominal):
    """Compares the answer with the truth. Raises KeyError, TypeError or AttributeError if one of them is incomplete."""
    accept, outside = truth["accept"], score.is_outside
    acceptable, doubles = {name for names in accept for name in names}, []
    for effect in diagnosis["effects"]:
        kind = effect["kind"]
        score.kinds.append(kind)
        doubles.append([kind, *effect.get("indistinguishable_from", [])])
        for key, fitted in effect.get("parameters", {}).items():
            is_nominal = f'"{kind}"' in nominal
            if isinstance(fitted, dict) and not is_possible(kind, key, _numbers(fitted.get("value")), is_nominal):
                score.impossible.append(f"{kind}.{key}")
        known = kind in acceptable
        score.wrong_name = score.wrong_name or not known
        score.claims.append((_number(effect, "probability"), known))
        index = effect.get("parameters", {}).get("index")
        right_indices = truth.get("accept_index", {}).get(kind)
        if right_indices is not None and isinstance(index, dict) and "value" in index:
            score.indices += 1
            score.indices_right += _numbers(index["value"])[:1] in [[v] for v in _numbers(right_indices)]
        for true_effect in truth["effects"]:
            if true_effect["kind"] == kind:
                score.pulls += _pulls(effect, true_effect)
    score.verdict, score.confidence = diagnosis["verdict"], _number(diagnosis, "confidence")
    for names in accept:
        fits = "unexplained" if outside else "missing_physics" if names else "consistent"
        if score.verdict == fits:
            score.right = score.right or sorted(names) == sorted(score.kinds)
            score.right_within_group = score.right_within_group or _can_be(doubles, names)
    score.known_named = outside and score.right and bool(score.kinds)
    # Below the limit, the effects may be named or not.
    either = not outside and [] in accept and (score.right or score.verdict == "consistent")
    score.verdict_right = score.verdict == score.true_verdict or either
    score.false_alarm = score.true_verdict == "consistent" and not score.right
    depends = (diagnosis.get("where") or {}).get("depends_on")
    if depends:
        score.dependence_right = depends[0].get("variable") in truth.get("depends_on", [])
    holdout, fit = diagnosis.get("holdout"), diagnosis.get("fit") or {}
    score.holdout_chi2 = _number(holdout, "chi2_per_sample_after")
    score.predictive_chi2 = _number(holdout, "predictive_chi2_per_sample")
    score.expected_chi2 = _number(holdout, "expected_chi2_per_sample")
    score.predictive_sigma = _number(holdout, "predictive_sigma")
    score.fit_chi2 = _number(fit, "chi2_per_sample_after")
    channels = [_number(c, "chi2_of_median") for c in fit.get("channels", []) if c.get("name", "").startswith("attitude_")]
    score.attitude_chi2 = statistics.fmean(channels) if channels else NAN


def score_case(case, diagnosis, oracle):
    """CaseScore of the folder `case`, from diagnosis.json in `diagnosis` and, if it exists, in `oracle`. Raises
    InputError if truth.json is invalid; an invalid diagnosis counts as no answer."""
    case, diagnosis, oracle = pathlib.Path(case), pathlib.Path(diagnosis), pathlib.Path(oracle)
    truth = read_json(case / "truth.json")
    score = CaseScore(truth.get("name", case.name), truth.get("family", "case"), truth.get("maker", ""))
    try:
        score.true_verdict, score.true_kinds = truth["verdict"], [e["kind"] for e in truth["effects"]]
        if not all(isinstance(names, list) for names in truth["accept"]):
            raise TypeError("accept")
    except (KeyError, TypeError) as error:
        raise InputError(case / "truth.json", "", f"no {error}", "verdict, effects and accept") from None
    score.chi2_gain = _number(truth, "chi2_gain")
    if (diagnosis / "error.txt").exists():
        score.failure = (diagnosis / "error.txt").read_text()
    if (diagnosis / "runs.json").exists():
        runs = read_json(diagnosis / "runs.json")
        score.processor_s, score.exit_status = _number(runs, "processor_s"), runs.get("exit_status", 0)
        score.replay_status, score.replay_chi2 = _number(runs, "replay_status"), _number(runs, "replay_chi2")
    nominal = (case / "experiment.toml").read_text() if (case / "experiment.toml").exists() else ""
    try:
        _judge(score, truth, read_json(diagnosis / "diagnosis.json"), nominal)
        score.answered = True
    except InputError as error:
        score.failure = score.failure or str(error)
    except (KeyError, TypeError, AttributeError) as error:
        score.failure += f"diagnosis.json: {error!r}"
    if (oracle / "diagnosis.json").exists():
        score.oracle_chi2 = _number(read_json(oracle / "diagnosis.json").get("holdout"), "chi2_per_sample_before")
    return score


# Counts over cases.


@dataclasses.dataclass(frozen=True)
class Fraction:
    """k of n with its interval of 95 % (E. B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209)."""

    hits: int
    of: int

    def _wilson(self, sign):
        if self.of == 0:
            return 0.0 if sign < 0 else 1.0
        z, n, p = 1.959963984540054, self.of, self.hits / self.of
        half = z * math.sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n))
        return min(max((p + z * z / (2.0 * n) + sign * half) / (1.0 + z * z / n), 0.0), 1.0)

    @property
    def low(self):
        return self._wilson(-1.0)

    @property
    def high(self):
        return self._wilson(1.0)


def _question(scores, text, belongs, hits, aim=""):
    of = [s for s in scores if belongs(s)]
    return text, Fraction(sum(bool(hits(s)) for s in of), len(of)), aim


def questions(scores):
    """Main counts: rows of (question, Fraction, aim), for questions that apply to at least one case."""

    def right(s):
        return s.right

    def shows(count):
        return lambda s: s.is_visible and len(s.true_kinds) == count

    def alone(s):
        return s.is_outside and len(s.true_kinds) == 1

    def beside(s):
        return s.is_outside and len(s.true_kinds) > 1

    def has_oracle(s):
        return s.names_missing_physics and s.oracle_chi2 > 0.0

    def near_oracle(s):
        return s.holdout_chi2 <= MAX_OVER_ORACLE * s.oracle_chi2

    def anything(s):
        return True

    def answered(s):
        return s.answered

    def replayed(s):
        return math.isfinite(s.replay_status)

    indices = Fraction(sum(s.indices_right for s in scores), sum(s.indices for s in scores))
    table = [
        ("all cases: verdict and names right", anything, right, "≥ 95 %"),
        ("one detectable effect: name right", shows(1), right, "≥ 95 %"),
        ("one detectable effect: right up to indistinguishable effects", shows(1), lambda s: s.right_within_group),
        ("one strong effect (χ² gain above 50 000): name right",
         lambda s: shows(1)(s) and s.chi2_gain > STRONG_GAIN, right, "≥ 95 %"),
        ("one effect under correlated noise: name right",
         lambda s: s.is_visible and s.family == "noise_effect", right, "≥ 95 %"),
        ("two effects: both names right", shows(2), right, "≥ 95 %"),
        ("three effects: all names right", shows(3), right, "≥ 85 %"),
        ("nothing missing, noise as stated: consistent",
         lambda s: s.is_none and s.family != "noise_none", right, "all"),
        ("nothing missing, noise not as stated: consistent", lambda s: s.family == "noise_none", right, "all"),
        ("below the limit: consistent, or the right name",
         lambda s: s.is_inside and s.chi2_gain < HOPELESS_GAIN, right, "all"),
        ("unknown law: unexplained, nothing wrong named", alone, right, "all"),
        ("unknown law called unexplained: variable right",
         lambda s: alone(s) and s.verdict == "unexplained", lambda s: s.dependence_right),
        ("known effect and unknown law: unexplained, nothing wrong named", beside, right, "≥ 95 %"),
        ("known effect and unknown law: the known one is named", beside, lambda s: s.known_named),
        ("second generator: verdict and names right",
         lambda s: s.maker.startswith("second"), right, "≥ 95 %"),
        None,
        ("cases with a wrong name", anything, lambda s: s.wrong_name, "≤ 1 %"),
        ("missing_physics with held-out residuals more than 5 σ above the prediction",
         lambda s: s.names_missing_physics and math.isfinite(s.predictive_sigma),
         lambda s: s.predictive_sigma > MAX_SIGMA, "none"),
        ("missing_physics without a stated prediction", lambda s: s.names_missing_physics,
         lambda s: not math.isfinite(s.predictive_sigma), "none"),
        ("missing_physics whose held-out χ² is within 10 % of the oracle's", has_oracle, near_oracle, "≥ 95 %"),
        ("as above, if parameter errors are expected to add at most 5 %",
         lambda s: has_oracle(s) and s.expected_chi2 <= MAX_EXPECTED, near_oracle, "≥ 95 %"),
        ("answers with a number beyond physics", answered, lambda s: s.impossible, "none"),
        ("answers without a confidence", answered, lambda s: not math.isfinite(s.confidence), "none"),
        ("cases without an answer", anything, lambda s: not s.answered, "none"),
        ("exits other than 0", anything, lambda s: s.exit_status != 0, "none"),
        ("improved.toml that propagates", replayed, lambda s: s.replay_status == 0, "all"),
        ("improved.toml that reproduces the recording with the stated χ²", replayed,
         lambda s: s.replays_as_stated, "all"),
    ]  # fmt: skip
    rows = [("effects rightly named: index of lamp, cell, string or diode right", indices, "≥ 98 %") if row is None
            else _question(scores, *row) for row in table]  # fmt: skip
    return [row for row in rows if row[1].of > 0]


def claims_of_names(scores):
    return [claim for s in scores for claim in s.claims]


def claims_of_verdicts(scores):
    return [(s.confidence, s.right) for s in scores if s.answered and math.isfinite(s.confidence)]


def calibration(claims, edges):
    """Rows (from, to, Fraction, mean stated) of the bins that contain claims (stated probability, whether correct)."""
    rows = []
    for low, high in itertools.pairwise(edges):
        within = [c for c in claims if c[0] >= low and (c[0] < high or high == 1.0)]
        if within:
            right = Fraction(sum(bool(c[1]) for c in within), len(within))
            rows.append((low, high, right, statistics.fmean(c[0] for c in within)))
    return rows


def calibration_error(claims):
    """Mean distance between stated probability and frequency, in ten equal bins, weighted by the number of claims
    (Naeini, Cooper and Hauskrecht, AAAI 2015)."""
    rows = calibration(claims, [i / 10.0 for i in range(11)])
    return sum(abs(stated * right.of - right.hits) for _, _, right, stated in rows) / len(claims)


def figures(scores):
    """Pulls, held-out errors, calibration and times: {name: (value, standard error)}."""
    counted = [s for s in scores if s.right and s.is_visible]
    pulls = [p for s in counted for p in s.pulls]
    ratios = [math.sqrt(s.holdout_chi2 / s.oracle_chi2) for s in counted if s.holdout_chi2 > 0 and s.oracle_chi2 > 0]
    times_s = [s.processor_s for s in scores if s.answered]
    table = {"cases": (len(scores), 0.0)}
    n = len(pulls)
    if n > 1:
        rms = math.sqrt(statistics.fmean(p * p for p in pulls))
        within = sum(abs(p) <= 1.0 for p in pulls)
        table["pulls"] = (n, 0.0)
        table["pulls_rms"] = (rms, rms / math.sqrt(2.0 * n))
        table["pulls_within_1_sigma"] = (within / n, math.sqrt(within * (n - within) / n) / n)
        # The median of |x| of a normal distribution is 0.6745.
        table["pulls_robust_sd"] = (statistics.median(abs(p) for p in pulls) / 0.6745, 0.0)
    if ratios:
        table["holdout_error_over_oracle_median"] = (statistics.median(ratios), 0.0)
        table["holdout_error_over_oracle_largest"] = (max(ratios), 0.0)
        table["holdout_within_10_percent_of_oracle"] = (sum(r <= 1.1 for r in ratios) / len(ratios), 0.0)
    for name, claims in (("confidence", claims_of_verdicts(scores)), ("name", claims_of_names(scores))):
        if claims:
            table[f"{name}_calibration_error"] = (calibration_error(claims), 0.0)
    if times_s:
        table["processor_median_s"] = (statistics.median(times_s), 0.0)
        table["processor_largest_s"] = (max(times_s), 0.0)
        table["processor_over_60_s"] = (sum(t > 60.0 for t in times_s), 0.0)
    return table
