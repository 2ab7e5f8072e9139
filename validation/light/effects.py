"""Effects on light and power: how they change a world, random examples, and competing effects.

Kinds and keys are those of [[effect]] in docs/experiment.md. Five laws are outside the catalogue: a
ripple, vignetting, a hair over the plate, a slow drift and a flicker of the lamps.
"""

import dataclasses
import math

import numpy as np

from ..errors import MotionError
from .illumination import Box


@dataclasses.dataclass(frozen=True)
class Effect:
    """An effect with its numbers as stated by truth.json: a number or a list of numbers per key."""

    kind: str
    index: int | None = None  # of a lamp, cell, string, bypass diode or wall
    numbers: dict = dataclasses.field(default_factory=dict)


def _change_lamps(world, change, only=None):
    lamps = world.room.lamps
    for k in range(len(lamps)) if only is None else [only]:
        lamps[k] = dataclasses.replace(lamps[k], **change(lamps[k]))


def _turned(axis, angles_deg):
    """A direction rotated by two angles, towards lab x and y made perpendicular to it."""
    axis = np.array(axis)
    direction = axis.copy()
    for side, angle in zip(np.eye(3), angles_deg):
        side = side - (side @ axis) * axis
        direction = direction + math.tan(math.radians(angle)) * side / np.linalg.norm(side)
    return tuple(direction / np.linalg.norm(direction))


def _aim(world, index, angles_deg):
    _change_lamps(world, lambda lamp: {"axis": _turned(lamp.axis, angles_deg)}, index)


def _derate(world, index, factor):
    _change_lamps(world, lambda lamp: {"power_W": lamp.power_W * factor}, index)


def _widen(world, _, scale):
    """Makes all beams `scale` times as wide; the width of cos^m is proportional to m^(-1/2)."""

    def wider(lamp):
        beam = lamp.beam
        return {"beam": dataclasses.replace(beam, fwhm_rad=beam.fwhm_rad * scale, exponent=beam.exponent / scale**2)}

    _change_lamps(world, wider)


def _shift(world, _, offset_m):
    _change_lamps(world, lambda lamp: {"position_m": tuple(p + o for p, o in zip(lamp.position_m, offset_m))})


def _power(world, _, factor):
    _change_lamps(world, lambda lamp: {"power_W": lamp.power_W * factor})


def _droop(world, _, depth, time_constant_s):
    world.droop_depth, world.droop_time_s = depth, time_constant_s


def _ambient(world, _, irradiance_W_m2):
    world.room.ambient_W_m2 += irradiance_W_m2


def _bias(world, _, bias_deg):
    world.room.bias_rad = tuple(np.radians(bias_deg))


def _reflect(world, index, diffuse=0.0, specular=0.0):
    walls = world.room.walls
    walls[index] = dataclasses.replace(walls[index], diffuse=diffuse, specular=specular)


def _gain(world, _, factor):
    world.detector_gain *= factor


def _soil(world, _, factor):
    world.circuit.soiling *= factor


def _glass(world, _, refractive_index):
    world.room.glass_index = refractive_index


def _degrade(world, index, factor):
    world.circuit.cell_current[index] *= factor


def _shade(world, index, factor):
    world.circuit.cell_light[index] *= factor


def _open(world, index):
    world.circuit.string_open[index] = True


def _short(world, index):
    world.circuit.bypass_shorted[index] = True


def _resist(world, _, resistance_ohm):
    world.circuit.series_ohm += resistance_ohm


def _leak(world, _, resistance_ohm):
    world.circuit.shunt_S += 1.0 / resistance_ohm


def _warm(world, _, photocurrent_per_K, voltage_V_per_K):
    world.circuit.photocurrent_per_K += photocurrent_per_K
    world.circuit.voltage_V_per_K += voltage_V_per_K


def _trap(world, _, interval_s):
    world.trapped_s.append(tuple(interval_s))


def _shadow(world, _, on_body, low_m, high_m):
    world.room.boxes.append(Box(bool(on_body), tuple(low_m), tuple(high_m)))


def _ripple(world, _, depth, period_m, direction_deg, phase):
    wave, angle = 2.0 * math.pi / period_m, math.radians(direction_deg)
    world.laws.append(
        lambda u, v, t: 1.0 + depth * np.cos(wave * (u * math.cos(angle) + v * math.sin(angle)) + phase)
    )


def _vignette(world, _, depth, centre_m, radius_m):
    def law(u, v, t):
        r2 = ((u - centre_m[0]) ** 2 + (v - centre_m[1]) ** 2) / radius_m**2
        return 1.0 - depth * r2**2 / (1.0 + r2**2)

    world.laws.append(law)


def _hair(world, _, depth, through_m, direction_deg, width_m):
    angle = math.radians(direction_deg)

    def law(u, v, t):
        off = (v - through_m[1]) * math.cos(angle) - (u - through_m[0]) * math.sin(angle)
        return np.where(np.abs(off) < 0.5 * width_m, 1.0 - depth, 1.0)

    world.laws.append(law)


def _drift(world, _, depth, period_s, phase):
    rate = 2.0 * math.pi / period_s
    world.laws.append(lambda u, v, t: 1.0 + depth * (np.sin(rate * t + phase) + 0.5 * np.sin(2.3 * rate * t)))


def _flicker(world, _, depth, frequency_Hz, phase):
    world.laws.append(lambda u, v, t: 1.0 + depth * np.cos(2.0 * math.pi * frequency_Hz * t + phase))


LAWS = {  # outside the catalogue
    "ripple": _ripple,
    "vignetting": _vignette,
    "hair": _hair,
    "slow_drift": _drift,
    "flicker": _flicker,
}
CATALOGUE = {
    "led_failed": lambda world, index: _derate(world, index, 0.0),
    "led_derated": _derate,
    "led_aim": _aim,
    "beam_divergence": _widen,
    "source_shift": _shift,
    "source_power": _power,
    "led_droop": _droop,
    "ambient_light": _ambient,
    "unmodelled_shadow": _shadow,
    "attitude_bias": _bias,
    "interreflection": _reflect,
    "detector_gain": _gain,
    "soiling": _soil,
    "angular_response": _glass,
    "cell_degraded": _degrade,
    "cell_shaded": _shade,
    "string_open": _open,
    "bypass_shorted": _short,
    "series_resistance": _resist,
    "shunt": _leak,
    "temperature_coefficient": _warm,
    "tracker_trapped": _trap,
}


def act(effect, world):
    """Applies an effect to a world."""
    (CATALOGUE | LAWS)[effect.kind](world, effect.index, **effect.numbers)


@dataclasses.dataclass(frozen=True)
class Rival:
    """An effect that may explain another effect, with the numbers that a fit varies."""

    kind: str
    index: int | None = None
    neutral: tuple = ()  # values without effect
    step: tuple = ()
    low: tuple = ()
    high: tuple = ()

    def act(self, world, x):
        """Applies the effect to a world. The number of a shunt is its conductance, which is 0 without a shunt."""
        if self.kind == "shunt":
            world.circuit.shunt_S += x[0]
        elif self.kind in ("led_aim", "source_shift", "attitude_bias"):
            CATALOGUE[self.kind](world, self.index, x)
        else:
            CATALOGUE[self.kind](world, self.index, *x)


def rivals_of(world, has_scans, has_circuit, has_runs):
    """All effects that can act on a world with such recordings and that a fit can vary or switch on."""
    circuit = world.circuit
    rivals = []

    def add(kind, index=None, neutral=(), step=(), low=(), high=()):
        rivals.append(Rival(kind, index, neutral, step, low, high))

    for k in range(len(world.room.lamps)):
        add("led_derated", k, (1.0,), (-0.05,), (0.0,), (1.0,))
        add("led_aim", k, (0.0, 0.0), (0.1, 0.1), (-8.0, -8.0), (8.0, 8.0))
    add("beam_divergence", None, (1.0,), (0.01,), (0.5,), (2.0,))
    add("source_shift", None, (0.0, 0.0, 0.0), (5e-4, 5e-4, 1e-3), (-0.05,) * 3, (0.05,) * 3)
    add("source_power", None, (1.0,), (0.01,), (0.3,), (2.0,))
    add("ambient_light", None, (0.0,), (1.0,), (0.0,), (1e4,))
    add("attitude_bias", None, (0.0, 0.0), (0.1, 0.1), (-12.0, -12.0), (12.0, 12.0))
    for k in range(len(world.room.walls) if not has_runs else 0):
        add("interreflection", k, (0.0, 0.0), (0.1, 0.1), (0.0, 0.0), (1.0, 1.0))
    if has_scans:
        add("detector_gain", None, (1.0,), (0.01,), (0.3,), (2.0,))
    for k in range(circuit.cells):
        add("cell_shaded", k, (1.0,), (-0.03,), (0.0,), (1.0,))
        if has_circuit:
            add("cell_degraded", k, (1.0,), (-0.03,), (0.0,), (1.0,))
    if not has_circuit:
        return rivals
    if has_runs:
        add("led_droop", None, (0.0, 300.0), (0.01, 20.0), (0.0, 30.0), (0.9, 3000.0))
    add("soiling", None, (1.0,), (-0.01,), (0.1,), (1.0,))
    add("angular_response", None, (1.0001,), (0.3,), (1.0001,), (4.0,))
    add("series_resistance", None, (0.0,), (0.02,), (0.0,), (20.0,))
    add("shunt", None, (0.0,), (1e-3,), (0.0,), (2.0,))
    add("temperature_coefficient", None, (0.0, 0.0), (1e-4, 1e-4), (-0.02, -0.02), (0.02, 0.02))
    for k in range(circuit.strings if circuit.strings > 1 else 0):
        add("string_open", k)
    for k in range(circuit.bypasses):
        add("bypass_shorted", k)
    return rivals


@dataclasses.dataclass(frozen=True)
class Recipe:
    """An effect with variable strength: `at` returns it at a strength from 0 (no effect) to 1."""

    at: object
    has_strength: bool = True


def _one(kind, key, none, full, index=None, **others):
    """A recipe of one number that varies from `none` to `full`."""
    return Recipe(lambda s: Effect(kind, index, {**others, key: none + s * (full - none)}))


def _several(kind, key, full, index=None):
    """A recipe of numbers that vary from 0 to `full`."""
    return Recipe(lambda s: Effect(kind, index, {key: [float(s * x) for x in full]}))


def _shadow_recipe(draw, plate):
    """A thin box above the plate, up to 6 cm wide."""
    on_body = draw.chance(0.5)
    wide, high = plate.u_high_m - plate.u_low_m, plate.v_high_m - plate.v_low_m
    u = 0.5 * (plate.u_low_m + plate.u_high_m) + draw.uniform(-0.3, 0.3) * wide
    v = 0.5 * (plate.v_low_m + plate.v_high_m) + draw.uniform(-0.3, 0.3) * high
    z, a, b = plate.z_m + draw.uniform(0.08, 0.3), draw.uniform(0.6, 1.0), draw.uniform(0.6, 1.0)

    def at(strength):
        half = 0.5 * min(max(0.06 * strength, 0.004), 0.06)
        low, high = [u - a * half, v - b * half, z], [u + a * half, v + b * half, z + 0.006]
        return Effect("unmodelled_shadow", None, {"on_body": on_body, "low_m": low, "high_m": high})

    return Recipe(at)


def draw_recipe(draw, world, kind, duration_s):
    """A recipe of a kind for a world; `duration_s` is that of its run."""
    plate, circuit = world.room.plate, world.circuit
    sign, angle = draw.sign(), draw.uniform(0.0, 2.0 * math.pi)
    around = np.array([math.cos(angle), math.sin(angle)])
    wide, high = plate.u_high_m - plate.u_low_m, plate.v_high_m - plate.v_low_m
    middle = (0.5 * (plate.u_low_m + plate.u_high_m), 0.5 * (plate.v_low_m + plate.v_high_m))
    lamp, cell = draw.below(len(world.room.lamps)), draw.below(circuit.cells)

    def near_middle(share):
        return [middle[k] + draw.uniform(-share, share) * size for k, size in enumerate((wide, high))]

    match kind:
        case "led_failed":
            return Recipe(lambda s: Effect(kind, lamp), False)
        case "led_derated":
            return _one(kind, "factor", 1.0, 0.05, lamp)
        case "led_aim":
            return _several(kind, "angles_deg", 4.0 * around, lamp)
        case "beam_divergence":
            return _one(kind, "scale", 1.0, 1.0 + 0.25 * sign)
        case "source_shift":
            return _several(kind, "offset_m", [*(0.02 * around), draw.uniform(-0.02, 0.02)])
        case "source_power":
            return _one(kind, "factor", 1.0, 1.0 + 0.25 * sign)
        case "led_droop":
            time_constant_s = duration_s * draw.log_uniform(0.1, 0.8)
            return _one(kind, "depth", 0.0, 0.3, time_constant_s=time_constant_s)
        case "ambient_light":
            return _one(kind, "irradiance_W_m2", 0.0, 60.0)
        case "unmodelled_shadow":
            return _shadow_recipe(draw, plate)
        case "attitude_bias":
            return _several(kind, "bias_deg", 3.0 * around)
        case "interreflection":
            return _one(kind, "diffuse" if draw.chance(0.6) else "specular", 0.0, 0.9, 0)
        case "detector_gain":
            return _one(kind, "factor", 1.0, 1.0 + 0.2 * sign)
        case "soiling":
            return _one(kind, "factor", 1.0, 0.7)
        case "angular_response":
            return _one(kind, "refractive_index", 1.0, 1.8)
        case "cell_degraded" | "cell_shaded":
            return _one(kind, "factor", 1.0, 0.05, cell)
        case "string_open":
            string = draw.below(circuit.strings)
            return Recipe(lambda s: Effect(kind, string), False)
        case "bypass_shorted":
            diode = draw.below(circuit.bypasses)
            return Recipe(lambda s: Effect(kind, diode), False)
        case "series_resistance":
            return _one(kind, "resistance_ohm", 0.0, 1.0)
        case "shunt":
            return Recipe(lambda s: Effect(kind, None, {"resistance_ohm": 3.0 / s}))
        case "temperature_coefficient":
            other = draw.sign()
            full = {"photocurrent_per_K": 0.003 * sign, "voltage_V_per_K": 0.002 * other}
            return Recipe(lambda s: Effect(kind, None, {key: s * x for key, x in full.items()}))
        case "tracker_trapped":
            start = math.floor(draw.uniform(0.05, 0.6) * duration_s)
            end = math.floor(start + draw.uniform(0.1, 0.3) * duration_s)
            return Recipe(lambda s: Effect(kind, None, {"interval_s": [start, end]}), False)
        case "ripple":
            period, direction = draw.uniform(0.015, 0.08), draw.uniform(0.0, 180.0)
            return _one(kind, "depth", 0.0, 0.2, period_m=period, direction_deg=direction, phase=angle)
        case "vignetting":
            radius = draw.uniform(0.3, 0.5) * max(wide, high)
            return _one(kind, "depth", 0.0, 0.5, centre_m=near_middle(0.1), radius_m=radius)
        case "hair":
            direction, width = draw.uniform(20.0, 70.0) + (90.0 if sign > 0.0 else 0.0), draw.uniform(0.003, 0.008)
            place = {"through_m": near_middle(0.2), "direction_deg": direction, "width_m": width}
            return _one(kind, "depth", 0.0, 0.8, **place)
        case "slow_drift":
            return _one(kind, "depth", 0.0, 0.1, period_s=draw.uniform(0.5, 1.5) * duration_s, phase=angle)
        case "flicker":
            return _one(kind, "depth", 0.0, 0.1, frequency_Hz=draw.log_uniform(0.01, 0.4), phase=angle)
    raise MotionError(f"no recipe for {kind}")
