"""Two generators of platform, nominal model, instruments and motion.

The first draws laboratory platforms (tabletop, dumbbell, hollow ball) that swing slightly and rotate
slowly. The second draws cases that differ from these, so that a search is not tuned to one generator: free
bodies, fast spins, large tilts, platforms almost at rest, durations of a minute or an hour, other masses and
instruments.
"""

import math

import numpy as np

from .case import NOMINAL_DRAG, NOMINAL_GYRO_BIAS, NOMINAL_UNBALANCE, Case, Priors, Run, Sensors, as_written
from .motion import Command, Start, World
from .vectors import normalised, product, quaternion_of

STANDS = ("tabletop", "dumbbell", "hollow")


def _written(values):
    return np.array([as_written(v) for v in values])


def draw_commands(draw, duration_s, rate_Hz, torques, largest_N_m):
    """Random torque pulses, if `torques` is set, and an alternating battery current."""

    def on_row(t):
        return round(t * rate_Hz) / rate_Hz

    current_A = round(draw.uniform(2.4, 6.0), 2)
    half_period_s = on_row(draw.uniform(60.0, 140.0))
    pulses, t = {}, draw.uniform(5.0, 20.0)
    while torques and t < duration_s:
        begin, end = on_row(t), on_row(t + draw.uniform(2.0, 9.0))
        pulses[begin] = as_written(draw.uniform(largest_N_m / 6.0, largest_N_m)) * draw.direction()
        pulses[end] = np.zeros(3)
        t = end + draw.uniform(3.0, 60.0)
    changes = {on_row(k * half_period_s) for k in range(math.ceil(duration_s / half_period_s))}
    commands, torque = [], np.zeros(3)
    for t in sorted(changes | set(pulses)):
        torque = pulses.get(t, torque)
        full = math.floor(t / half_period_s + 1e-6) % 2 == 0
        commands.append(Command(t, torque, current_A if full else round(0.35 * current_A, 2)))
    return commands


def _draw_truth_within_priors(draw, case, kinds):
    """Draws the true numbers of the nominal model within its uncertainties. If an injected effect could be absorbed
    by an uncertain part of the nominal model, that part is made exact."""
    priors, names = case.priors, {kind.name for kind in kinds}
    if NOMINAL_UNBALANCE in names:
        priors.offset_sigma_m = np.zeros(3)
    if NOMINAL_DRAG in names:
        priors.drag_sigma_N_m_s = 0.0
    if NOMINAL_GYRO_BIAS in names:
        priors.gyro_bias_sigma_rad_s = 0.0
    case.world.offset_m = priors.offset_m + priors.offset_sigma_m * draw.normals(1.0)
    drag = priors.drag_N_m_s + priors.drag_sigma_N_m_s * draw.normal()
    case.world.drag_N_m_s = max(0.2 * priors.drag_N_m_s, drag)
    case.world.gyro_bias_rad_s = draw.normals(priors.gyro_bias_sigma_rad_s)


def _attitude(heading, lean):
    return normalised(product(quaternion_of([0.0, 0.0, heading]), quaternion_of([lean[0], lean[1], 0.0])))


def _laboratory_body(draw):
    topology = STANDS[draw.below(3)]
    if topology == "tabletop":
        mass, low, high = draw.uniform(6.5, 9.0), (0.10, 0.11, 0.17), (0.13, 0.13, 0.205)
    elif topology == "dumbbell":
        mass, low, high = draw.uniform(10.0, 15.5), (0.05, 0.47, 0.47), (0.08, 0.55, 0.52)
    else:
        mass, low, high = draw.uniform(4.5, 5.5), (0.050, 0.053, 0.052), (0.056, 0.058, 0.057)
    while True:
        moments = [draw.uniform(a, b) for a, b in zip(low, high, strict=True)]
        if 2 * max(moments) <= sum(moments):  # condition for the moments of a body
            return topology, mass, moments


def draw_first(draw, plan, kinds):
    """A case of the first generator in which `kinds` can act."""
    topology, mass, moments = _laboratory_body(draw)
    field = (draw.uniform(-2e-6, 2e-6), draw.uniform(1.9e-5, 2.5e-5), draw.uniform(-4.3e-5, -3.5e-5))
    world = World(as_written(mass), _written(moments), magnetic_field_T=_written(field),
                  latitude_rad=math.radians(45.5))  # fmt: skip
    drag = as_written(draw.log_uniform(6e-6, 3e-5))
    offset = _written([draw.uniform(-3e-6, 3e-6), draw.uniform(-3e-6, 3e-6), draw.uniform(-6e-5, -2e-5)])
    priors = Priors(offset, np.array([5e-7, 5e-7, 3e-6]), drag, as_written(draw.uniform(0.15, 0.3) * drag), 1e-3)
    sensors = Sensors(rate_Hz=plan.rates_Hz[draw.below(len(plan.rates_Hz))],
                      camera_every=2 if draw.chance(0.3) else 1, dirty=draw.chance(plan.dirty_share))  # fmt: skip
    case = Case(maker="first", topology=topology, world=world, priors=priors, sensors=sensors)
    _draw_truth_within_priors(draw, case, kinds)
    torques = any(kind.needs_commands for kind in kinds) or draw.chance(0.2)
    still = any(kind.needs_small_turns for kind in kinds)
    for duration_s in (plan.duration_s, plan.holdout_s):
        lean = draw.uniform(0.05, 0.2) * draw.direction()
        attitude = _attitude(draw.uniform(-0.5, 0.5) if still else draw.uniform(-3, 3), lean)
        spin = draw.sign() * (draw.uniform(0.001, 0.004) if still else draw.uniform(0.06, 0.2))
        start = Start(attitude, np.array([draw.uniform(-0.02, 0.02), draw.uniform(-0.02, 0.02), spin]))
        commands = draw_commands(draw, duration_s, sensors.rate_Hz, torques, 6e-4)
        case.runs.append(Run(start, commands, duration_s))
    return case


def _any_body(draw):
    """Mass and moments of any body: the moments are pairwise sums of three positive numbers."""
    mass = as_written(draw.log_uniform(1.0, 60.0))
    radius_m = 0.1 * math.cbrt(mass / 7.0) * draw.uniform(0.7, 1.5)
    spread = np.array([draw.log_uniform(0.2, 1.0) for _ in range(3)])
    return mass, _written(mass * radius_m**2 * (spread.sum() - spread))


def _second_priors(draw, world, motion, swing_rad_s):
    mean_kg_m2 = float(np.mean(world.moments_kg_m2))
    priors = Priors()
    if world.gravity_m_s2 > 0.0:
        level_kg_m2 = 0.5 * (world.moments_kg_m2[0] + world.moments_kg_m2[1])
        below_m = swing_rad_s**2 * level_kg_m2 / (world.mass_kg * world.gravity_m_s2)
        aside_m = (0.005 if motion == "rest" else 0.05) * below_m
        priors.offset_m = _written([aside_m * draw.uniform(-1, 1), aside_m * draw.uniform(-1, 1), -below_m])
        sigma = as_written(draw.uniform(0.01, 0.03) * below_m)
        priors.offset_sigma_m = np.array([sigma, sigma, as_written(draw.uniform(0.03, 0.1) * below_m)])
    priors.drag_N_m_s = as_written(mean_kg_m2 / draw.log_uniform(3e3, 3e4))
    priors.drag_sigma_N_m_s = as_written(draw.uniform(0.15, 0.5) * priors.drag_N_m_s)
    priors.gyro_bias_sigma_rad_s = as_written(draw.log_uniform(1e-4, 3e-3))
    return priors


def _second_sensors(draw, plan, motion, kinds):
    sensors = Sensors(rate_Hz=(5.0, 10.0, 20.0)[draw.below(3)])
    # A camera must observe a fast spin more often than a slow swing.
    sensors.camera_every = 1 if motion == "spin" else (1, 2, 4)[draw.below(3)]
    level = float(round(draw.log_uniform(6.0, 100.0)))
    sensors.camera_noise_arcsec = (level, level, float(round(level * draw.uniform(0.3, 1.5))))
    sensors.gyro_noise_rad_s = as_written(draw.log_uniform(3e-5, 1e-3))
    sensors.has_gyro = any(kind.of_gyro for kind in kinds) or draw.chance(0.75)
    commanded = any(kind.needs_commands or kind.needs in ("command", "charge") for kind in kinds)
    sensors.has_commands = commanded or draw.chance(0.6)
    sensors.dirty = draw.chance(plan.dirty_share)
    # Without a gyro, the rotations of a fast spin cannot be counted across a gap of seconds.
    if motion == "spin" and not sensors.has_gyro:
        sensors.dirty = False
    return sensors


def _second_start(draw, motion, topology, still):
    heading = draw.uniform(-0.5, 0.5) if still else draw.uniform(-3.0, 3.0)
    towards = draw.uniform(-math.pi, math.pi)
    if motion == "spin":
        tilt, rate = draw.uniform(0.01, 0.1), draw.uniform(0.0, 0.02) * draw.direction()
        rate[2] += draw.sign() * draw.log_uniform(0.5, 2.0)
    elif motion == "tumble":
        tilt, rate = draw.uniform(0.0, 1.0), draw.log_uniform(0.03, 0.3) * draw.direction()
    elif motion == "swing":
        tilt = draw.uniform(0.13, 0.26) if topology == "hollow" else draw.uniform(0.17, 0.70)
        rate = draw.uniform(0.0, 0.02) * draw.direction()
        rate[2] = draw.uniform(-0.003, 0.003) if still else draw.uniform(-0.05, 0.05)
    else:
        tilt, rate = draw.log_uniform(0.002, 0.02), draw.log_uniform(2e-4, 3e-3) * draw.direction()
    return Start(_attitude(heading, (tilt * math.cos(towards), tilt * math.sin(towards))), rate)


def draw_second(draw, plan, kinds):
    """A case of the second generator in which `kinds` can act."""
    still = any(kind.needs_small_turns for kind in kinds)  # restoring torques to zero attitude jump at half a turn
    motion = ("spin", "tumble", "swing", "rest")[2 + draw.below(2) if still else draw.below(4)]
    has_gravity = draw.chance(0.5) if motion == "spin" else motion != "tumble"
    topology = STANDS[draw.below(3)] if has_gravity else "free"
    swing_rad_s = draw.log_uniform(0.05, 0.5)  # of the pendulum about its level axes
    mass, moments = _any_body(draw)
    world = World(mass, moments, magnetic_field_T=_written(draw.uniform(2e-5, 6e-5) * draw.direction()),
                  latitude_rad=math.radians(round(draw.uniform(-60.0, 60.0))))  # fmt: skip
    if not has_gravity:
        world.gravity_m_s2 = 0.0
    case = Case(maker=f"second: {motion}", topology=topology, world=world,
                priors=_second_priors(draw, world, motion, swing_rad_s))  # fmt: skip
    _draw_truth_within_priors(draw, case, kinds)
    case.sensors = _second_sensors(draw, plan, motion, kinds)
    durations_s, length = (plan.duration_s, plan.holdout_s), draw.uniform(0.0, 1.0)
    if length < 0.25:
        durations_s = (60.0, 60.0)
        case.maker += ", a minute"
    elif length > 0.95 and motion != "spin":
        durations_s = (3600.0, 1800.0)
        case.sensors.rate_Hz = 5.0
        case.maker += ", an hour"
    wants = any(kind.needs_commands for kind in kinds) or draw.chance(0.4)
    torques = case.sensors.has_commands and wants and not still
    # A pulse of some seconds changes the rate by a few hundredths of a radian per second.
    gentle = 0.2 if motion == "rest" else 1.0
    largest_N_m = gentle * float(np.mean(moments)) * draw.log_uniform(0.002, 0.008)
    for duration_s in durations_s:
        start = _second_start(draw, motion, topology, still)
        commands = []
        if case.sensors.has_commands:
            commands = draw_commands(draw, duration_s, case.sensors.rate_Hz, torques, largest_N_m)
        case.runs.append(Run(start, commands, duration_s))
    return case
