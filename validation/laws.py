"""Independent implementation of every kind of disturbance: its law, random examples, and its strength.

The laws are those of docs/physics.md with the keys of docs/disturbances.md. These documents are the only
common basis with the program. A law is evaluated for a batch of platforms: vectors are arrays (3, b), numbers
arrays (b,). `now` contains the inputs of a law (motion.Now): time_s, attitude, rate, charge_Ah, mass_kg,
offset_m, inertia, gravity, gravity_level, gravity_m_s2, field, up, command, to_body(lab vector).
"""

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from .vectors import body_from_lab, cross, dot, length, quaternion_of, times, turn_of

EARTH_RATE_RAD_S = 7.292115e-5
EARTH_RADIUS_M = 6.3710087714e6
CREEP_RAD_S = 1e-6  # creep rate of dry friction, the default of docs/disturbances.md


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of effect that can be injected."""

    name: str
    draw: Callable  # (Draw, Conditions) -> numbers of a size that is plausible in a laboratory
    torque: Callable | None = None  # (numbers, now) -> torque in body axes [N m]
    alter: Callable | None = None  # (numbers, platform): changes body, laboratory or instruments
    jumps_s: Callable | None = None  # (numbers, from_s, to_s) -> instants at which the torque jumps
    strength: str = ""  # key of the strength; empty: the effect has no numbers
    components: int = 1  # of the strength
    step: float = 0.0  # of the strength, for differences; 0: the effect is not proportional to the strength
    max_factor: float = 30.0  # limit, relative to the drawn size
    needs_commands: bool = False  # visible only with commanded torques
    needs_small_turns: bool = False  # the law jumps for large rotations
    pairs: bool = False  # can be combined with another effect
    needs: str = ""  # recorded channel that a diagnosis needs: "command", "charge"
    is_tone: bool = False  # acts at one frequency, for which a diagnosis has to scan
    of_gyro: bool = False
    contained_in: tuple = ()  # kinds of which this one is a special case
    depends_on: tuple = ()  # of a law outside the catalogue: variables, any of which a fitted function must depend on

    @property
    def is_outside(self):
        return bool(self.depends_on)

    @property
    def is_linear(self):
        """Whether readings are proportional to all its numbers, so that they can compete with others."""
        return not self.is_outside and not self.is_tone and (self.step > 0.0 or not self.strength)


@dataclasses.dataclass(frozen=True)
class Conditions:
    """Quantities on which the size of an example may depend."""

    duration_s: float
    moments_kg_m2: np.ndarray  # of inertia, about the body axes
    max_tone_Hz: float  # such that the slowest instrument has four readings per period


def fixed(key, size):
    return lambda draw, conditions: {key: size}


def either_sign(key, size):
    return lambda draw, conditions: {key: draw.sign() * size}


def any_direction(key, size):
    return lambda draw, conditions: {key: list(size * draw.direction())}


def nothing(draw, conditions):
    return {}


# Mass: T = m r × g, r the displacement of the centre of mass.


def weight_torque(now, displacement_m):
    return now.mass_kg * cross(displacement_m, now.gravity)


def shift_torque(p, now):
    return weight_torque(now, p["offset_m"]) if now.time_s >= p["time_s"].flat[0] else 0.0


def draw_shift(draw, conditions):
    return {"time_s": round(draw.uniform(0.25, 0.65) * conditions.duration_s, 1),
            "offset_m": list(2e-6 * draw.direction())}  # fmt: skip


def sag_torque(p, now):
    return weight_torque(now, p["compliance_s2"] * (now.gravity - now.gravity_level))


def draw_sag(draw, conditions):
    return {"compliance_s2": [draw.uniform(0.2e-7, 1e-7) for _ in range(3)]}


def gradient_torque(p, now):
    rate2 = now.gravity_m_s2 / EARTH_RADIUS_M
    return 3.0 * rate2 * cross(now.up, times(now.inertia, now.up))


def change_inertia(p, platform):
    xx, yy, zz, xy, xz, yz = p["delta_kg_m2"]
    platform.inertia += np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def draw_inertia(draw, conditions):
    moments = conditions.moments_kg_m2
    own = [0.01 * draw.uniform(-1, 1) * m for m in moments]
    return {"delta_kg_m2": own + [0.005 * draw.uniform(-1, 1) * float(np.mean(moments)) for _ in range(3)]}


def tilt_gravity(p, platform):
    x, y = p["tilt_rad"]
    lab_from_level = np.moveaxis(body_from_lab(quaternion_of(np.stack((x, y, np.zeros_like(x))))), 0, 1)
    platform.gravity_lab[:] = times(lab_from_level, platform.gravity_lab)


def draw_tilt(draw, conditions):
    return {"tilt_rad": [2e-3 * draw.normal(), 2e-3 * draw.normal()]}


def add_appendage(p, platform):
    platform.appendage_axis[:] = p["axis"] / length(p["axis"])
    platform.appendage_rad_s[:] = 2 * np.pi * p["frequency_Hz"]
    platform.appendage_damping[:] = p["damping"]
    platform.appendage_kg_m2[:] = p["inertia_kg_m2"]


def draw_appendage(draw, conditions):
    axis = draw.direction()
    whole = float(np.sum(axis * axis * conditions.moments_kg_m2))
    return {"axis": list(axis), "frequency_Hz": draw.log_uniform(0.15, 1.5), "damping": draw.log_uniform(0.005, 0.05),
            "inertia_kg_m2": 0.05 * whole}  # fmt: skip


# Bearing, contact and air: opposite to the rate.


def friction_torque(p, now):
    return -p["torque_N_m"] / np.sqrt(dot(now.rate, now.rate) + now.creep_rad_s**2) * now.rate


def tether_torque(p, now):
    return -p["stiffness_N_m_per_rad"] * turn_of(now.attitude)


# Machinery: tones T = T0 sin(2π f t + φ), the floor's acceleration a at the centre of mass: T = −m r × a.


def tone(p, now):
    return np.sin(2 * np.pi * p["frequency_Hz"] * now.time_s + p["phase"])


def tone_numbers(key, size):
    def draw_tone(draw, conditions):
        return {key: list(size * draw.direction()),
                "frequency_Hz": draw.log_uniform(0.15, min(3.0, conditions.max_tone_Hz)),
                "phase": draw.uniform(-3.1, 3.1)}  # fmt: skip

    return draw_tone


def floor_torque(p, now):
    return -now.mass_kg * tone(p, now) * cross(now.offset_m, now.to_body(p["acceleration_m_s2"]))


def turn_laboratory(p, platform):
    latitude = platform.latitude_rad
    platform.earth_lab[1] += EARTH_RATE_RAD_S * math.cos(latitude)
    platform.earth_lab[2] += EARTH_RATE_RAD_S * math.sin(latitude)


# Instruments.


def add_to(name, key):
    """Returns a function that adds the numbers of `key` to the platform's instrument error `name`."""

    def alter(p, platform):
        error = getattr(platform, name)
        error += p[key]

    return alter


# Laws outside the catalogue.


def cogging_torque(p, now):
    w, x, y, z = now.attitude
    heading = np.arctan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z))
    return p["torque_N_m"] * np.sin(p["periods"] * heading + p["phase"]) * now.up


def draw_cogging(draw, conditions):
    return {"torque_N_m": 5e-6, "periods": 2 + draw.below(4), "phase": draw.uniform(-3.1, 3.1)}


def lean(now):
    """Axis from the vertical to body z, and the angle between them."""
    across = np.stack((now.up[1], -now.up[0], np.zeros_like(now.up[0])))
    sine = length(across)
    return across / np.maximum(sine, 1e-300), np.arctan2(sine, now.up[2])


def tilt_cubed_torque(p, now):
    axis, angle = lean(now)
    return -p["coefficient_N_m"] * angle**3 * axis


def edge_drag_torque(p, now):
    return -p["coefficient_N_m_s"] * (lean(now)[1] / 0.1) ** 2 * now.rate


def rough_pad_torque(p, now):
    w, x, y, z = now.attitude
    heading = np.arctan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z))
    near = np.exp((np.cos(heading - p["heading_rad"]) - 1.0) / p["width_rad"] ** 2)
    return -p["coefficient_N_m_s"] * near * dot(now.rate, now.up) * now.up


def draw_pad(draw, conditions):
    return {"coefficient_N_m_s": 2e-5, "heading_rad": draw.uniform(-3.1, 3.1), "width_rad": draw.uniform(0.3, 0.8)}


def slack_cable_torque(p, now):
    axis, angle = lean(now)
    return -p["stiffness_N_m_per_rad"] * np.maximum(0.0, angle - p["free_rad"]) * axis


def random_torque(p, now):
    """Forty tones with random phases and the power spectrum of a Gauss–Markov process. The sum is smooth, so that any
    integrator can follow it."""
    x = 0.04 + 0.24 * np.arange(40)  # angular frequencies times the correlation time
    power = 1.0 / (1.0 + x * x)
    phases = 2 * np.pi * np.random.Generator(np.random.PCG64(int(p["seed"].flat[0]))).random((3, 40))
    waves = np.sin(x * (now.time_s / p["time_s"].flat[0]) + phases) * np.sqrt(power / (0.5 * power.sum()))
    return now.to_body(p["torque_N_m"] * waves.sum(axis=1)[:, np.newaxis])


def draw_random(draw, conditions):
    return {"torque_N_m": [3e-6 * draw.uniform(0, 1), 3e-6 * draw.uniform(0, 1), 3e-6],
            "time_s": draw.log_uniform(15.0, 50.0), "seed": draw.below(10**6)}  # fmt: skip


def decay_torque(p, now):
    return p["torque_N_m"] * np.exp(-now.time_s / p["time_s"])


def draw_decay(draw, conditions):
    return {"torque_N_m": list(5e-6 * draw.direction()), "time_s": draw.log_uniform(20.0, 120.0)}


def pulsed_torque(p, now):
    phase = now.time_s / p["period_s"].flat[0] % 1.0
    return p["torque_N_m"] if phase < 1.0 / 3.0 else 0.0


def pulse_edges_s(p, from_s, to_s):
    period = p["period_s"]
    starts = period * np.arange(math.floor(from_s / period), math.ceil(to_s / period) + 1)
    return np.concatenate((starts, starts + period / 3.0))


def draw_pulses(draw, conditions):
    return {"torque_N_m": list(5e-6 * draw.direction()), "period_s": draw.uniform(25.0, 90.0)}


def draw_cable(draw, conditions):
    return {"stiffness_N_m_per_rad": 1e-4, "free_rad": draw.uniform(0.03, 0.12)}


def _catalogue():
    return [
        Kind("static_unbalance", any_direction("offset_m", 1e-6), lambda p, now: weight_torque(now, p["offset_m"]),
             strength="offset_m", components=3, step=1e-8),
        Kind("mass_shift", draw_shift, shift_torque, jumps_s=lambda p, from_s, to_s: [p["time_s"]],
             strength="offset_m", components=3, pairs=True),
        Kind("battery_discharge", any_direction("shift_m_per_Ah", 2e-6),
             lambda p, now: weight_torque(now, now.charge_Ah * p["shift_m_per_Ah"]),
             strength="shift_m_per_Ah", components=3, step=1e-8, pairs=True, needs="charge"),
        Kind("elastic_sag", draw_sag, sag_torque, strength="compliance_s2", components=3, step=1e-9, pairs=True),
        Kind("inertia_error", draw_inertia, alter=change_inertia, strength="delta_kg_m2", components=6, step=1e-6,
             max_factor=5.0, pairs=True),
        Kind("gravity_gradient", nothing, gradient_torque),
        Kind("gravity_tilt", draw_tilt, alter=tilt_gravity, strength="tilt_rad", components=2, step=1e-6),
        Kind("flexible_mode", draw_appendage, alter=add_appendage, strength="inertia_kg_m2", max_factor=6.0,
             needs_commands=True),
        Kind("bearing_drag", fixed("coefficient_N_m_s", 1e-5), lambda p, now: -p["coefficient_N_m_s"] * now.rate,
             strength="coefficient_N_m_s", step=1e-8),
        Kind("turbine_torque", either_sign("torque_N_m", 3e-6), lambda p, now: p["torque_N_m"] * now.up,
             strength="torque_N_m", step=1e-9, pairs=True, contained_in=("room_draft",)),
        Kind("dry_friction", fixed("torque_N_m", 3e-6), friction_torque, strength="torque_N_m", step=1e-9, pairs=True),
        Kind("tether", fixed("stiffness_N_m_per_rad", 3e-5), tether_torque, strength="stiffness_N_m_per_rad",
             step=1e-8, needs_small_turns=True, pairs=True),
        Kind("air_friction", fixed("coefficient", 3e-5),
             lambda p, now: -p["coefficient"] * np.sqrt(length(now.rate)) * now.rate,
             strength="coefficient", step=1e-8, pairs=True),
        Kind("air_pressure_drag", fixed("coefficient_N_m_s2", 5e-4),
             lambda p, now: -p["coefficient_N_m_s2"] * length(now.rate) * now.rate,
             strength="coefficient_N_m_s2", step=1e-7, pairs=True),
        Kind("room_draft", any_direction("torque_lab_N_m", 5e-6), lambda p, now: now.to_body(p["torque_lab_N_m"]),
             strength="torque_lab_N_m", components=3, step=1e-9, pairs=True),
        Kind("magnetic_dipole", any_direction("dipole_A_m2", 0.03), lambda p, now: cross(p["dipole_A_m2"], now.field),
             strength="dipole_A_m2", components=3, step=1e-5, pairs=True),
        Kind("eddy_damping", fixed("coefficient_N_m_s_per_T2", 5e3),
             lambda p, now: p["coefficient_N_m_s_per_T2"] * cross(cross(now.rate, now.field), now.field),
             strength="coefficient_N_m_s_per_T2", step=1.0, pairs=True),
        Kind("earth_rotation", nothing, alter=turn_laboratory),
        Kind("rotor_momentum", any_direction("momentum_N_m_s", 2e-3),
             lambda p, now: cross(p["momentum_N_m_s"], now.inertial_rate),
             strength="momentum_N_m_s", components=3, step=1e-7, pairs=True),
        Kind("floor_vibration", tone_numbers("acceleration_m_s2", 0.05), floor_torque, strength="acceleration_m_s2",
             components=3, step=1e-4, is_tone=True),
        Kind("periodic_torque", tone_numbers("torque_N_m", 5e-5), lambda p, now: tone(p, now) * p["torque_N_m"],
             strength="torque_N_m", components=3, step=1e-8, pairs=True, is_tone=True),
        Kind("actuator_gain", either_sign("gain_error", 0.1), lambda p, now: p["gain_error"] * now.command,
             strength="gain_error", step=1e-4, max_factor=4.0, needs_commands=True, pairs=True, needs="command"),
        Kind("attitude_latency", fixed("latency_s", 0.05), alter=add_to("latency_s", "latency_s"),
             strength="latency_s", step=1e-4, max_factor=6.0, pairs=True),
        Kind("gyro_bias", any_direction("bias_rad_s", 1e-3), alter=add_to("gyro_bias", "bias_rad_s"),
             strength="bias_rad_s", components=3, step=1e-6, of_gyro=True),
        Kind("gyro_scale", any_direction("scale", 0.01), alter=add_to("gyro_scale", "scale"), strength="scale",
             components=3, step=1e-5, max_factor=20.0, pairs=True, of_gyro=True),
        Kind("gyro_misalignment", any_direction("misalignment_rad", 0.01), alter=add_to("gyro_turn", "misalignment_rad"),
             strength="misalignment_rad", components=3, step=1e-5, max_factor=3.0, pairs=True, of_gyro=True),
        Kind("camera_misalignment", any_direction("misalignment_rad", 0.01),
             alter=add_to("camera_turn", "misalignment_rad"), strength="misalignment_rad", components=3, step=1e-6,
             max_factor=3.0),
    ]  # fmt: skip


def _outside():
    """Laws outside the catalogue; `diagnose` must report that the cause is unknown."""
    return [
        Kind("heading_cogging", draw_cogging, cogging_torque, strength="torque_N_m", depends_on=("heading",)),
        Kind("tilt_cubed", fixed("coefficient_N_m", 0.01), tilt_cubed_torque, strength="coefficient_N_m",
             max_factor=100.0, depends_on=("tilt",)),
        Kind("slow_random_torque", draw_random, random_torque, strength="torque_N_m", depends_on=("time",)),
        Kind("exponential_decay", draw_decay, decay_torque, strength="torque_N_m", depends_on=("time",)),
        Kind("pulsed_torque", draw_pulses, pulsed_torque, jumps_s=pulse_edges_s, strength="torque_N_m",
             depends_on=("time",)),
        Kind("edge_drag", fixed("coefficient_N_m_s", 1e-5), edge_drag_torque, strength="coefficient_N_m_s",
             max_factor=100.0, depends_on=("tilt", "rate")),
        Kind("rough_pad", draw_pad, rough_pad_torque, strength="coefficient_N_m_s", max_factor=100.0,
             depends_on=("heading", "rate")),
        Kind("slack_cable", draw_cable, slack_cable_torque, strength="stiffness_N_m_per_rad", max_factor=100.0,
             depends_on=("tilt",)),
    ]  # fmt: skip


CATALOGUE = tuple(_catalogue())
OUTSIDE = tuple(_outside())
KINDS = {kind.name: kind for kind in CATALOGUE + OUTSIDE}

# Other kinds of the catalogue, and the reasons why they are not injected.
NOT_INJECTED = {
    "stepper_quantization": "found as static_unbalance, which has the same effect",
    "helmholtz_cage": "diagnose does not screen it",
    "orbit": "diagnose does not screen it",
    "power_balance": "diagnose does not screen it",
    "wheel_control": "diagnose does not screen it",
    "lamp_pressure": "needs lamps beside the motion",
    "planet_light": "needs a traced table",
    "aerodynamic_drag": "diagnose does not screen it",
    "wheel_imbalance": "diagnose does not screen it",
    "actuator_latency": "diagnose does not screen it",
    "radiation_pressure": "the laboratories of the benchmark see no Sun",
    "marker_positions": "the makers' cameras have no markers",
    "wheel_momentum": "the benchmark records no speed of a wheel",
    "table_slope": "the laboratories have no table to slide on",
    "sliding_friction": "the laboratories have no table to slide on",
    "sliding_drag": "the laboratories have no table to slide on",
    "sliding_air_drag": "the laboratories have no table to slide on",
    "sliding_spring": "the laboratories have no table to slide on",
    "body_force": "the laboratories have no table to slide on",
    "thrust_saturation": "the laboratories have no table to slide on",
    "mass_error": "diagnose does not screen it",
    "empirical_torque": "a function without a law; the benchmark has other unknown laws",
}

# Physical bounds of every number of a key; other keys have no bounds.
BOUNDS = {
    ("elastic_sag", "compliance_s2"): (0.0, math.inf),
    ("mass_shift", "time_s"): (0.0, math.inf),
    ("flexible_mode", "frequency_Hz"): (1e-3, 100.0),
    ("flexible_mode", "damping"): (0.0, 2.0),
    ("flexible_mode", "inertia_kg_m2"): (0.0, math.inf),
    ("dry_friction", "torque_N_m"): (0.0, math.inf),
    ("tether", "stiffness_N_m_per_rad"): (0.0, math.inf),
    ("air_friction", "coefficient"): (0.0, math.inf),
    ("air_pressure_drag", "coefficient_N_m_s2"): (0.0, math.inf),
    ("eddy_damping", "coefficient_N_m_s_per_T2"): (0.0, math.inf),
    ("floor_vibration", "frequency_Hz"): (0.0, 100.0),
    ("periodic_torque", "frequency_Hz"): (0.0, 100.0),
    ("attitude_latency", "latency_s"): (0.0, math.inf),
    ("wheel_momentum", "inertia_kg_m2"): (0.0, math.inf),
    ("sliding_friction", "coefficient"): (0.0, math.inf),
    ("sliding_drag", "coefficient_kg_s"): (0.0, math.inf),
    ("sliding_air_drag", "coefficient_kg_m"): (0.0, math.inf),
    ("sliding_spring", "stiffness_N_per_m"): (0.0, math.inf),
}

# Bounds of kinds that correct a nominal value, for nominal models without this kind.
BOUNDS_ALONE = {("bearing_drag", "coefficient_N_m_s"): (-1e-6, math.inf)}


def is_possible(kind, key, values, is_nominal):
    """Whether all fitted numbers of a key lie within the bounds of physics."""
    bounds = BOUNDS.get((kind, key), (-math.inf, math.inf))
    if not is_nominal:
        bounds = BOUNDS_ALONE.get((kind, key), bounds)
    return all(bounds[0] <= v <= bounds[1] for v in values)
