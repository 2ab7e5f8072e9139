"""Cases of a plan of light and power: their effects, laboratory and strength."""

import dataclasses
import math

import numpy as np
from scipy import optimize

from ..errors import MotionError
from . import effects, readings, setting
from .circuit import LitCircuit
from .files import write_case
from .identifiability import Judge

SHOWS = 30.0  # growth of chi² above which an effect should be named
ATTEMPTS = 40
KINDS = list(effects.CATALOGUE)
LAWS = list(effects.LAWS)
WEAK_KINDS = [  # can be arbitrarily weak
    "led_derated",
    "led_aim",
    "beam_divergence",
    "source_shift",
    "source_power",
    "led_droop",
    "soiling",
    "ambient_light",
    "attitude_bias",
    "detector_gain",
    "cell_degraded",
    "cell_shaded",
    "series_resistance",
    "shunt",
    "temperature_coefficient",
]
# Required growth of chi² (lowest, highest) by family, and by level for single effects. For laws outside the catalogue
# it is the part that the catalogue cannot explain.
GAINS = {"below": (0.3, 3.0), "pair": (500.0, 5e4), "outside": (120.0, 3000.0)}
LEVELS = [(2e4, 1e6), (1000.0, 2e4), (100.0, 1000.0)]
DEPENDS_ON = {"slow_drift": ["time"], "flicker": ["time"]}


@dataclasses.dataclass
class Case:
    """A case before it is written; `accept` and `accept_index` are those of truth.json."""

    name: str
    family: str  # "none", "single", "pair", "outside" or "below"
    seed: tuple
    verdict: str
    believed: readings.World
    sources: list
    noise: readings.Noise
    recordings: dict
    is_dirty: bool
    effects: list = dataclasses.field(default_factory=list)
    accept: list = dataclasses.field(default_factory=lambda: [[]])
    accept_index: dict = dataclasses.field(default_factory=dict)
    depends_on: list = dataclasses.field(default_factory=list)
    chi2_gain: float = 0.0

    def truth(self):
        """The world with the effects."""
        world = self.believed.copy()
        for effect in self.effects:
            effects.act(effect, world)
        return world


def case_count(plan):
    """Number of cases in a plan."""
    return len(KINDS) * plan.per_kind + plan.none + plan.pairs + len(LAWS) * plan.outside + plan.below


def _go_together(a, b):
    """Whether two kinds are visible in the same recordings and can be distinguished."""
    for one, other in ((a, b), (b, a)):
        if one in ("led_droop", "tracker_trapped") and other in setting.NO_RUN_KINDS:
            return False
    alike = ({"source_power", "soiling", "detector_gain"}, {"led_failed", "led_derated"})
    return a != b and not any(a in group and b in group for group in alike)


def _choose(plan, index, attempt):
    """Family, kinds, number within its group and level of the case `index`."""
    if index < len(KINDS) * plan.per_kind:
        number, kind = divmod(index, len(KINDS))
        return "single", [KINDS[kind]], number, (number + index) % 3
    index -= len(KINDS) * plan.per_kind
    if index < plan.none:
        return "none", [], index, 0
    index -= plan.none
    if index < plan.pairs:
        draw = setting.RoundedDraw(plan.seed, 7000 + index, attempt)
        while True:
            pair = [KINDS[draw.below(len(KINDS))] for _ in range(2)]
            if _go_together(*pair):
                return "pair", pair, index, 1
    index -= plan.pairs
    if index < len(LAWS) * plan.outside:
        return "outside", [LAWS[index % len(LAWS)]], index // len(LAWS), 1
    index -= len(LAWS) * plan.outside
    return "below", [WEAK_KINDS[index % len(WEAK_KINDS)]], index // len(WEAK_KINDS), 2


def _effect_of_gain(gain, recipe, wanted):
    """The recipe's effect for which `gain` equals `wanted`; None if this is impossible."""
    full = recipe.at(1.0)
    most = gain([full])
    if not recipe.has_strength:
        return full if most > SHOWS else None
    if most < wanted:
        return full if wanted > 100.0 else None

    def excess(log_strength):
        return math.log(max(gain([recipe.at(math.exp(log_strength))]), 1e-12) / wanted)

    low = math.log(1e-5)
    if excess(low) > 0.0:
        return None
    return recipe.at(math.exp(optimize.brentq(excess, low, 0.0, xtol=1e-3, rtol=1e-3)))


def _shorten_sweeps(case):
    """Ends curves at the present open-circuit voltage if it is far below the nominal one: instruments do not drive
    such reverse currents. Returns whether any curve was changed."""
    truth, changed = case.truth(), False
    for rows in case.recordings.values():
        if rows.kind != "sweep":
            continue
        matrices = rows.matrices()
        rows.voltage_V = rows.voltage_V.copy()
        for number in np.unique(rows.sweep):
            which = np.flatnonzero(rows.sweep == number)
            light = readings.light_on_cells(truth, matrices[which[0]])
            opens = LitCircuit(truth.circuit, light, rows.temperature_K[which[0]]).open_voltage_V()[0]
            scale = 1.003 * opens / rows.voltage_V[which[-1]]
            if scale < 0.97:
                rows.voltage_V[which] *= scale
                changed = True
    return changed


def _attempt(plan, index, attempt):
    """The case `index`, or None if the drawn effects are not visible."""
    family, kinds, number, level = _choose(plan, index, attempt)
    seed = (plan.seed, index, attempt)
    draw = setting.RoundedDraw(*seed, 1)
    is_dirty = draw.chance(plan.dirty_share)
    world, sources, noise, recordings = setting.draw_setting(draw, kinds)
    name = f"{'+'.join(kinds) or 'nothing'}_{number + 1:02d}"
    verdict = "unexplained" if family == "outside" else "missing_physics" if kinds else "consistent"
    case = Case(name, family, seed, verdict, world, sources, noise, recordings, is_dirty)
    if not kinds:
        return case
    judge = Judge(world, noise, recordings)
    durations = [rows.time_s[-1] for rows in recordings.values() if rows.kind == "run" and rows.is_first]
    gain = judge.unexplained if family == "outside" else judge.gain
    for kind in kinds:
        recipe = effects.draw_recipe(draw, world, kind, durations[0] if durations else 0.0)
        effect = _effect_of_gain(gain, recipe, draw.log_uniform(*GAINS.get(family, LEVELS[level])))
        if effect is None:
            return None
        case.effects.append(effect)
    if _shorten_sweeps(case):
        judge = Judge(world, noise, recordings)
    case.chi2_gain = (judge.unexplained if family == "outside" else judge.gain)(case.effects)
    if family == "below":
        case.accept = [[], kinds]
        return case
    if case.chi2_gain < (3.0 if family == "outside" else 2.0) * SHOWS:
        return None
    if family == "outside":
        case.depends_on = DEPENDS_ON.get(kinds[0], ["position", "irradiance"])
        return case
    case.accept, case.accept_index, alone = judge.accepted(case.effects, SHOWS)
    # A pair is rejected if one of its effects is hardly needed.
    return None if family == "pair" and alone < 5.0 * SHOWS else case


def draw_case(plan, index):
    """The case `index` (0-based) of a plan. Raises MotionError if no visible case is found."""
    for attempt in range(ATTEMPTS):
        case = _attempt(plan, index, attempt)
        if case is not None:
            return case
    raise MotionError(f"case {index + 1}: no example of {'+'.join(_choose(plan, index, 0)[1])} shows")


def make_case(plan, index, folder):
    """Makes the case `index` (0-based) of a plan in `folder`. Equal plans give equal cases, independent of their
    order."""
    write_case(draw_case(plan, index), folder)
