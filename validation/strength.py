"""Strength of the effects of a case, adjusted to their visibility in the readings."""

import dataclasses
import itertools
import math

import numpy as np

from .errors import MotionError
from .information import Information, competing_kinds, creep_rad_s, with_effects
from .laws import KINDS
from .motion import Motion
from .vectors import length

WITHIN_NOISE = 12.0  # of chi²
LINEAR_GAIN = 5e4  # above it the strength is extrapolated instead of simulated
ROUNDS = 3
FASTEST_RAD_S = 4.0  # of recordings


@dataclasses.dataclass
class Strengths:
    """Gain in chi² of the first run when each effect is known, with all numbers of the case's other effects free; for
    a law outside the catalogue, with all numbers of the catalogue free. `doubles`: sets of kinds that reproduce
    one or two of the effects within the noise."""

    gains: list
    doubles: list

    @property
    def least(self):
        return min(self.gains, default=0.0)


def _others(information, case, without):
    """Columns of the other effects: those of their numbers, or their change if they are not linear."""
    others = []
    for i, effect in enumerate(case.world.effects):
        if i in without:
            continue
        columns = information.columns_of(effect.kind)
        others.append(columns if columns.shape[1] else information.changes[i][:, np.newaxis])
    return others


def _gains(information, case, against_catalogue):
    gains = []
    for i, effect in enumerate(case.world.effects):
        others = _others(information, case, {i})
        if KINDS[effect.kind].is_outside and against_catalogue:
            others += [information.columns_of(kind) for kind in information.competitors()]
        gains.append(information.gain(information.changes[i], others))
    return gains


def _doubles(information, case, factors):
    """Kinds that could replace one of the effects, or two of them at once. `factors`: factors by which each effect
    will still be strengthened."""
    names = [e.kind for e in case.world.effects if not KINDS[e.kind].is_outside]
    doubles = []
    swaps = [(i,) for i in range(len(names))] + list(itertools.combinations(range(len(names)), 2))
    for out in swaps:
        change = sum(factors[i] * information.changes[i] for i in out)
        others = _others(information, case, set(out))
        for kind in information.competitors():
            if kind in names:
                continue
            if information.gain(change, [*others, information.columns_of(kind)]) < WITHIN_NOISE:
                doubles.append([kind] + [name for i, name in enumerate(names) if i not in out])
    return doubles


def stays_physical(case):
    """Whether the platform of both runs is physically possible, stays upright if it stands on a support, and rotates
    no faster than instruments can follow."""
    motion = Motion([case.world], creep_rad_s(case.world))
    moments = np.linalg.eigvalsh(motion.platforms.inertia[..., 0])
    if not (moments[0] > 0.0 and moments[2] <= moments[0] + moments[1]):
        return False
    for run in case.runs:
        times_s = np.arange(0.0, run.duration_s, 0.5)
        try:  # stop early if the platform spins up without limit
            readings = motion.read([run.start], run.commands, times_s, 1e-6, fastest_rad_s=2.0 * FASTEST_RAD_S)
        except MotionError:
            return False
        rate, up = length(readings.rate_rad_s).max(), readings.attitude[:, 0]
        upright = 1.0 - 2.0 * (up[1] ** 2 + up[2] ** 2)
        # Between two camera readings the rotation must remain unambiguous.
        if rate > FASTEST_RAD_S or rate * case.sensors.camera_every / case.sensors.rate_Hz > 0.8:
            return False
        if case.topology != "free" and upright.min() < math.cos(math.radians(60.0)):
            return False
    return True


def _extrapolation(case, index, by, loosened):
    """Factor by which effect `index` can be strengthened to increase its gain in chi² `by` times, reduced until the
    motion stays physical."""
    effect = case.world.effects[index]
    if not effect.numbers or not math.isfinite(by):
        return 1.0
    kind = KINDS[effect.kind]
    room = 10.0 if kind.max_factor >= 30.0 else 1.0  # a torque may exceed the usual range tenfold; an angle is limited
    factor = min(math.sqrt(by), max(1.0, room * kind.max_factor * loosened))
    while factor > 1.05:
        effects = list(case.world.effects)
        effects[index] = effect.scaled(factor)
        if stays_physical(with_effects(case, effects)):
            return factor
        factor = 1.0 + 0.5 * (factor - 1.0)
    return 1.0


def fit_strengths(case, wanted, loosened):
    """(case, Strengths): the effects are scaled until each has about the `wanted` gain, within the limits of its kind
    times `loosened`. Above a gain of 5e4 the strength is extrapolated with its square."""
    count = len(case.world.effects)
    if count == 0:
        return case, Strengths([], [])
    reached, beyond = np.ones(count), np.ones(count)  # times the drawn size; fraction that the catalogue leaves
    acting = [e.kind for e in case.world.effects]
    for round_number in range(ROUNDS + 1):
        final = round_number == ROUNDS
        whole = final or round_number == 1
        kinds = dict.fromkeys(acting + (competing_kinds(case) if whole else []))
        information = Information(case, list(kinds))
        gains = np.array(_gains(information, case, False))
        if whole:
            strong = np.array(_gains(information, case, True))
            beyond = strong / np.maximum(gains, 1e-300)
        factors = np.ones(count)
        for i, effect in enumerate(case.world.effects):
            if effect.numbers and gains[i] * beyond[i] > 0.0:
                by = math.sqrt(min(wanted[i], LINEAR_GAIN) / (gains[i] * beyond[i]))
                largest = KINDS[effect.kind].max_factor * loosened
                factors[i] = min(max(by, 1e-5 / reached[i]), largest / reached[i])
        if final or (whole and np.all(np.abs(factors - 1.0) < 0.1)):
            factors = np.ones(count)
            for i in range(count):
                if wanted[i] > LINEAR_GAIN and strong[i] > 0.0:
                    factors[i] = _extrapolation(case, i, wanted[i] / strong[i], loosened / reached[i])
            strengths = Strengths(list(strong * factors**2), _doubles(information, case, factors))
            return _scaled(case, factors), strengths
        case = _scaled(case, factors)
        reached *= factors
    raise AssertionError("unreachable")


def _scaled(case, factors):
    return with_effects(case, [e.scaled(float(f)) for e, f in zip(case.world.effects, factors, strict=True)])
