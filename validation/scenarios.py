"""The cases of a plan: their effects, platform and strength."""

import math

import numpy as np

from . import files
from .case import Noise
from .draw import Draw
from .errors import MotionError
from .laws import CATALOGUE, OUTSIDE, Conditions
from .makers import draw_first, draw_second
from .motion import Effect
from .strength import fit_strengths, stays_physical

COMPANIONS = tuple(kind for kind in CATALOGUE if kind.pairs)
ADJUSTABLE = tuple(kind for kind in CATALOGUE if kind.strength)
VISIBLE_GAIN, HOPELESS_GAIN = 30.0, 6.0  # of chi²: name required above; no conclusion below
TRIALS = 40


def case_count(plan):
    """Number of cases in a plan."""
    return (plan.none + plan.per_kind * len(CATALOGUE) + plan.pairs + plan.outside * len(OUTSIDE) + plan.triples
            + plan.known_unknown + plan.noise_none + plan.noise_effect)  # fmt: skip


def _companions(draw, count):
    """Different kinds, none of which is a special case of another."""
    chosen = []
    while len(chosen) < count:
        kind = COMPANIONS[draw.below(len(COMPANIONS))]
        if not any(k is kind or k.name in kind.contained_in or kind.name in k.contained_in for k in chosen):
            chosen.append(kind)
    return chosen


class Choice:
    """Family, kinds and level of a case. Another `variant` combines other effects."""

    def __init__(self, plan, index, variant=0):
        self.level = 0  # of a single effect: 0 strong, 1 medium, 2 weak, 3 below the limit
        self._choose(plan, index, variant)
        self.is_second = _is_of_second_maker(plan, index)

    def _set(self, family, kinds, number, level=0):
        self.family, self.kinds, self.number, self.level = family, kinds, number, level

    def _choose(self, plan, i, variant):
        if i < plan.none:
            return self._set("none", [], i)
        i -= plan.none
        # In rounds over all kinds, so that a part of the plan contains all of them. The levels are strong, then
        # medium, then half of the kinds weak and half below the limit, then vice versa.
        if i < plan.per_kind * len(CATALOGUE):
            number, turn = i // len(CATALOGUE), i // len(CATALOGUE) % 4
            return self._set("single", [CATALOGUE[i % len(CATALOGUE)]], number, turn if turn < 2 else 2 + (turn + i) % 2)
        i -= plan.per_kind * len(CATALOGUE)
        if i < plan.pairs:
            return self._set("pair", _companions(Draw(plan.seed, 2, i, variant), 2), i)
        i -= plan.pairs
        if i < plan.outside * len(OUTSIDE):
            return self._set("outside", [OUTSIDE[i % len(OUTSIDE)]], i // len(OUTSIDE))
        i -= plan.outside * len(OUTSIDE)
        if i < plan.triples:
            return self._set("triple", _companions(Draw(plan.seed, 3, i, variant), 3), i)
        i -= plan.triples
        if i < plan.known_unknown:
            known = _companions(Draw(plan.seed, 4, i, variant), 1)
            return self._set("known_unknown", [*known, OUTSIDE[i % len(OUTSIDE)]], i)
        i -= plan.known_unknown
        if i < plan.noise_none:
            return self._set("noise_none", [], i)
        i -= plan.noise_none
        # Not in the order of the catalogue: a short plan would contain only its first kinds.
        return self._set("noise_effect", [ADJUSTABLE[7 * i % len(ADJUSTABLE)]], i)

    @property
    def name(self):
        kinds = "+".join(kind.name for kind in self.kinds) or "none"
        prefix = f"{self.family}_" if self.family.startswith("noise") else ""
        return f"{prefix}{kinds}_{self.number + 1:02d}"


def _is_of_second_maker(plan, index):
    """Selects one of 1/share cases, at a random position among them."""
    share = plan.second_maker_share
    if share <= 0.0:
        return False
    block = math.floor(index * share)
    first, following = math.ceil(block / share - 1e-9), math.ceil((block + 1) / share - 1e-9)
    return index == first + math.floor(Draw(plan.seed, 9, block).uniform(0.0, following - first))


def _wanted_gain(draw, plan, choice):
    """Required gain in chi² of each effect."""
    if choice.family != "single":
        return draw.log_uniform(300.0, 2e4)
    if choice.level == 0 and draw.chance(plan.strong_share):
        return draw.log_uniform(1e5, 1e9)
    return draw.log_uniform(*((2e3, 5e4), (200.0, 2e3), (40.0, 200.0), (0.2, 4.0))[choice.level])


def _correlated(draw):
    return Noise(time_s=draw.log_uniform(0.3, 4.0))


def _heavy_tails(draw):
    return Noise(student_degrees=3 + draw.below(3)) if draw.chance(0.5) else Noise(outlier_share=0.05)


def _unstated_noise(draw, number):
    """Three of ten cases have another level, three are correlated, three have heavy tails; the tenth is quantised or,
    in every second round, has all of these."""
    turn = number % 10
    if turn == 9 and number // 10 % 2 == 0:
        return Noise(step_sigma=draw.uniform(1.0, 3.0))
    if turn == 9:
        noise = _heavy_tails(draw)
        noise.scale, noise.time_s = draw.log_uniform(0.6, 2.0), draw.log_uniform(0.3, 2.0)
        noise.step_sigma = draw.uniform(0.5, 1.5)
        return noise
    if turn % 3 == 1:
        return _correlated(draw)
    if turn % 3 == 2:
        return _heavy_tails(draw)
    # Different enough from the stated level to be visible in minutes.
    return Noise(scale=draw.log_uniform(0.6, 0.85) if draw.chance(0.4) else draw.log_uniform(1.2, 2.0))


def _draw_noise(draw, sensors, choice):
    if not choice.family.startswith("noise"):
        return
    which = draw.below(3) if sensors.has_gyro else 0  # camera, gyro, both
    for instrument, other in (("camera", 1), ("gyro", 0)):
        if which != other:
            is_effect = choice.family == "noise_effect"
            setattr(sensors, instrument, _correlated(draw) if is_effect else _unstated_noise(draw, choice.number))


def _judge(case, choice, strengths):
    """Sets the verdict and names that are correct."""
    known = [kind.name for kind in choice.kinds if not kind.is_outside]
    case.depends_on = [variable for kind in choice.kinds for variable in kind.depends_on]
    case.chi2_gain = strengths.least
    case.accept = [known]
    if len(known) < len(choice.kinds):
        case.verdict = "unexplained"
        if known:
            case.accept.append([])
    else:
        case.verdict = "consistent" if not known or case.chi2_gain < HOPELESS_GAIN else "missing_physics"
    if case.chi2_gain >= HOPELESS_GAIN:
        case.accept += strengths.doubles
    weak = case.verdict == "missing_physics" and case.chi2_gain < VISIBLE_GAIN
    if weak or (case.verdict == "consistent" and known):
        case.accept.append([])


def _shows(case, choice, wanted):
    """Whether the effects are visible as the family requires. Effects without a strength are always accepted."""
    if not choice.kinds or not case.world.effects[0].numbers:
        return True
    most = max(wanted)
    if case.chi2_gain > 10.0 * most:  # not reached in a few rounds
        return False
    return case.chi2_gain >= (0.5 * min(most, 400.0) if choice.family == "single" else 200.0)


def _attempt(plan, choice, index, trial):
    draw = Draw(plan.seed, 1, index, trial)
    case = (draw_second if choice.is_second else draw_first)(draw, plan, choice.kinds)
    case.name, case.family, case.seed = choice.name, choice.family, (plan.seed, 8, index, trial)
    _draw_noise(draw, case.sensors, choice)
    conditions = Conditions(case.runs[0].duration_s, case.world.moments_kg_m2,
                            0.25 * case.sensors.rate_Hz / case.sensors.camera_every)  # fmt: skip
    wanted = []
    for kind in choice.kinds:
        case.world.effects.append(Effect(kind.name, kind.draw(draw, conditions)))
        wanted.append(_wanted_gain(draw, plan, choice))
    # The kinds draw sizes for a platform of the first generator.
    case, strengths = fit_strengths(case, wanted, 20.0 if choice.is_second else 1.0)
    _judge(case, choice, strengths)
    return case if _shows(case, choice, wanted) and stays_physical(case) else None


def draw_case(plan, index):
    """The case `index` (0-based). Equal plans give equal cases, independent of their order. Raises MotionError if no
    visible case is found."""
    for trial in range(TRIALS):
        choice = Choice(plan, index, trial // 8)  # other effects are tried if these are never visible together
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                case = _attempt(plan, choice, index, trial)
        except MotionError:
            continue  # an effect so strong that the platform tumbles away
        if case is not None:
            return case
    raise MotionError(f"no visible case of {choice.name} in {TRIALS} trials")


def make_case(plan, index, folder):
    """Draws a case and writes it to `folder`. validation.light has functions with the same names and arguments
    (case_count, make_case) for plans with `of = "light"`."""
    files.write_case(draw_case(plan, index), folder)
