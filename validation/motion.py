"""The true motion of the platform in a case.

Euler's equations of a body with its instruments (docs/physics.md), for one platform or for a batch of slightly
different platforms. They are integrated by SciPy's DOP853 with tight tolerances, in intervals between the jumps
of laws and commands. A batch has common steps, so that differences between its members are smooth.
"""

import dataclasses
import math

import numpy as np
from scipy.integrate import solve_ivp

from .errors import MotionError
from .laws import CREEP_RAD_S, KINDS
from .vectors import (
    body_from_lab, cross, dot, inverse, length, normalised, product, quaternion_of, quaternion_rate, times,
)  # fmt: skip


@dataclasses.dataclass
class Effect:
    """An injected effect with its numbers in SI units, keys as in an experiment file."""

    kind: str
    numbers: dict

    def scaled(self, factor):
        """The effect with its strength multiplied by `factor`; times and frequencies are unchanged."""
        key = KINDS[self.kind].strength
        if key not in self.numbers:
            return self
        return Effect(self.kind, self.numbers | {key: (factor * np.asarray(self.numbers[key])).tolist()})


@dataclasses.dataclass
class World:
    """All properties of a platform and its surroundings."""

    mass_kg: float = 1.0
    moments_kg_m2: np.ndarray = dataclasses.field(default_factory=lambda: np.ones(3))  # of inertia, principal axes
    gravity_m_s2: float = 9.80665
    magnetic_field_T: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))  # lab: east, north, up
    latitude_rad: float = 0.0
    offset_m: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))  # of the centre of mass
    drag_N_m_s: float = 0.0
    gyro_bias_rad_s: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    effects: list = dataclasses.field(default_factory=list)

    def but(self, **changes):
        return dataclasses.replace(self, **changes)


@dataclasses.dataclass
class Start:
    attitude: np.ndarray  # quaternion w, x, y, z: lab from body
    rate_rad_s: np.ndarray  # body axes


@dataclasses.dataclass
class Command:
    """The command from its time until the next command."""

    time_s: float
    torque_N_m: np.ndarray
    battery_current_A: float


@dataclasses.dataclass
class Readings:
    """Noiseless readings: arrays (components, members, times)."""

    attitude: np.ndarray  # true
    camera: np.ndarray  # with misalignment and latency
    rate_rad_s: np.ndarray
    gyro_rad_s: np.ndarray


class _Platforms:
    """Bodies, laboratories and instruments of a batch, as changed by the effects."""

    def __init__(self, worlds):
        first = worlds[0]
        size = len(worlds)
        self.latitude_rad = first.latitude_rad
        self.inertia = np.zeros((3, 3, size))
        self.inertia[range(3), range(3)] = first.moments_kg_m2[:, np.newaxis]
        self.gravity_lab = np.tile([[0.0], [0.0], [-first.gravity_m_s2]], size)
        self.earth_lab = np.zeros((3, size))
        self.gyro_bias = np.stack([w.gyro_bias_rad_s for w in worlds], axis=1).astype(float)
        self.gyro_scale, self.gyro_turn, self.camera_turn = (np.zeros((3, size)) for _ in range(3))
        self.latency_s = np.zeros(size)
        self.appendage_axis = np.tile([[0.0], [0.0], [1.0]], size)
        self.appendage_rad_s, self.appendage_damping, self.appendage_kg_m2 = (np.zeros(size) for _ in range(3))

    def part(self, members):
        """Views of some members: changes in place affect the whole."""
        part = object.__new__(_Platforms)
        for name, value in vars(self).items():
            setattr(part, name, value[..., members] if isinstance(value, np.ndarray) else value)
        return part


class Now:
    """Inputs of a law: members `members` of a batch at one instant. Vectors in body axes."""

    def __init__(self, motion, time_s, attitude, rate, charge_Ah, command):
        self.time_s, self.attitude, self.rate, self.charge_Ah = time_s, attitude, rate, charge_Ah
        self.rotation = body_from_lab(attitude)
        self.motion, self.members = motion, slice(None)
        self.command = command[:, np.newaxis]
        self.mass_kg, self.gravity_m_s2 = motion.mass_kg, motion.gravity_m_s2
        self.creep_rad_s = motion.creep_rad_s

    def part(self, members):
        part = object.__new__(Now)
        vars(part).update(vars(self))
        part.members = members
        part.attitude, part.rate = self.attitude[:, members], self.rate[:, members]
        part.rotation, part.charge_Ah = self.rotation[..., members], self.charge_Ah[members]
        return part

    def to_body(self, lab):
        return times(self.rotation, lab)

    @property
    def gravity_level(self):
        return self.motion.platforms.gravity_lab[:, self.members]

    @property
    def gravity(self):
        return self.to_body(self.gravity_level)

    @property
    def up(self):
        return self.rotation[:, 2]

    @property
    def field(self):
        return self.to_body(self.motion.field_lab_T)

    @property
    def inertia(self):
        return self.motion.platforms.inertia[..., self.members]

    @property
    def offset_m(self):
        return self.motion.offset_m[:, self.members]

    @property
    def inertial_rate(self):
        if not self.motion.turns:
            return self.rate
        return self.rate + self.to_body(self.motion.platforms.earth_lab[:, self.members])


def _members(indices, size):
    """A slice if the indices are consecutive, which is faster."""
    if indices == list(range(indices[0], indices[-1] + 1)):
        return slice(None) if len(indices) == size else slice(indices[0], indices[-1] + 1)
    return np.array(indices)


class Motion:
    """Equations of a batch of worlds that share mass, inertia, gravity and field, apart from their effects."""

    def __init__(self, worlds, creep_rad_s=CREEP_RAD_S):
        self.worlds, self.size = worlds, len(worlds)
        first = worlds[0]
        self.mass_kg, self.gravity_m_s2, self.creep_rad_s = first.mass_kg, first.gravity_m_s2, creep_rad_s
        self.field_lab_T = np.asarray(first.magnetic_field_T, dtype=float)[:, np.newaxis]
        self.offset_m = np.stack([w.offset_m for w in worlds], axis=1).astype(float)
        self.drag_N_m_s = np.array([w.drag_N_m_s for w in worlds])
        self.platforms = _Platforms(worlds)
        self.has_appendage, self.torques, self.jumping = False, [], []
        for kind, members, numbers in self._acting():
            if kind.alter is not None:
                kind.alter(numbers, self.platforms.part(members) if isinstance(members, slice) else self.platforms)
            if kind.torque is not None:
                self.torques.append((kind.torque, members, numbers))
            self.has_appendage = self.has_appendage or kind.name == "flexible_mode"
        p = self.platforms
        self.turns = bool(np.any(p.earth_lab != 0.0))
        self.method = "Radau" if self._friction_1_s() > 100.0 else "DOP853"
        self.body_inertia = p.inertia
        if self.has_appendage:
            self.body_inertia = p.inertia - p.appendage_kg_m2 * p.appendage_axis[:, np.newaxis] * p.appendage_axis
        self.inverse_inertia = inverse(self.body_inertia)

    def _acting(self):
        """(kind, members, numbers) of all effects; the i-th effect of a kind is combined over all worlds."""
        groups = {}
        for member, world in enumerate(self.worlds):
            seen = {}
            for effect in world.effects:
                seen[effect.kind] = seen.get(effect.kind, 0) + 1
                groups.setdefault((effect.kind, seen[effect.kind]), []).append((member, effect.numbers))
        for (kind, _), acting in groups.items():
            indices = [member for member, _ in acting]
            # A change in place needs views, hence intervals of consecutive members.
            start = 0
            for i in range(1, len(indices) + 1):
                if i < len(indices) and indices[i] == indices[i - 1] + 1:
                    continue
                numbers = {key: np.moveaxis(np.array([n[key] for _, n in acting[start:i]], dtype=float), 0, -1)
                           for key in acting[0][1]}  # fmt: skip
                yield KINDS[kind], _members(indices[start:i], self.size), numbers
                start = i

    def _friction_1_s(self):
        """Rate [1/s] at which dry friction stops a creeping platform; an explicit method must resolve it."""
        stop_N_m = max((e.numbers["torque_N_m"] for e in self.worlds[0].effects if e.kind == "dry_friction"), default=0)
        return stop_N_m / (self.creep_rad_s * min(self.worlds[0].moments_kg_m2))

    @property
    def start_s(self):
        """The motion starts before time zero because of a camera's latency. With an appendage it starts at zero, when
        a model assumes the appendage to be at rest."""
        return 0.0 if self.has_appendage else -0.5

    def rates(self, time_s, flat, command, current_A):
        y = flat.reshape(-1, self.size)
        p = self.platforms
        attitude, rate = normalised(y[:4]), y[4:7]
        now = Now(self, time_s, attitude, rate, y[7], command)
        torque = command[:, np.newaxis] - self.drag_N_m_s * rate
        torque += self.mass_kg * cross(self.offset_m, now.gravity)
        for law, members, numbers in self.torques:
            if members == slice(None):
                torque += law(numbers, now)
            else:
                torque[:, members] += law(numbers, now.part(members))
        d = np.empty_like(y)
        d[:4] = quaternion_rate(attitude, rate)
        d[7] = current_A / 3600.0
        inertial = now.inertial_rate
        momentum = times(self.body_inertia, inertial)
        if self.has_appendage:
            frequency, axis = p.appendage_rad_s, p.appendage_axis
            d[8] = y[9] - dot(axis, rate)
            pull = frequency * (frequency * y[8] + 2.0 * p.appendage_damping * d[8])
            d[9] = -pull
            torque += p.appendage_kg_m2 * pull * axis
            momentum = momentum + p.appendage_kg_m2 * y[9] * axis
        d[4:7] = times(self.inverse_inertia, torque - cross(inertial, momentum))
        if self.turns:  # the Earth's rate rotates in body axes
            d[4:7] += cross(rate, inertial - rate)
        return d.ravel()

    def _jumps(self, from_s, to_s):
        jumps = set()
        for world in self.worlds:
            for effect in world.effects:
                if KINDS[effect.kind].jumps_s is not None:
                    jumps.update(float(t) for t in KINDS[effect.kind].jumps_s(effect.numbers, from_s, to_s))
        return jumps

    def states(self, starts, commands, times_s, tolerance=1e-9, max_step_s=math.inf, fastest_rad_s=math.inf):
        """States (components, members, times) at rising times, not before start_s. Raises MotionError if the motion
        diverges or exceeds fastest_rad_s."""
        y = np.zeros((10 if self.has_appendage else 8, self.size))
        y[:4] = np.stack([s.attitude for s in starts], axis=1)
        y[4:7] = np.stack([s.rate_rad_s for s in starts], axis=1)
        if self.has_appendage:
            y[9] = dot(self.platforms.appendage_axis, y[4:7])
        times_s = np.asarray(times_s, dtype=float)
        end_s = max(times_s[-1], self.start_s)
        stops = self._jumps(self.start_s, end_s) | {c.time_s for c in commands}
        edges = [self.start_s, *sorted(t for t in stops if self.start_s < t < end_s), end_s]
        result = np.empty(y.shape + times_s.shape)
        result[..., times_s <= self.start_s] = y[..., np.newaxis]
        command, current_A, next_command = np.zeros(3), 0.0, 0

        def room_rad_s(_, flat):
            return fastest_rad_s - length(flat.reshape(-1, self.size)[4:7]).max()

        room_rad_s.terminal = True
        for from_s, to_s in zip(edges[:-1], edges[1:], strict=True):
            while next_command < len(commands) and commands[next_command].time_s <= from_s + 1e-12:
                command, current_A = commands[next_command].torque_N_m, commands[next_command].battery_current_A
                next_command += 1
            if to_s <= from_s:
                continue
            inside = 1e-9 * (to_s - from_s)  # laws that jump at an end are evaluated slightly inside
            wanted = (times_s > from_s) & (times_s <= to_s)
            at_s = times_s[wanted]
            if at_s.size == 0 or at_s[-1] < to_s:
                at_s = np.append(at_s, to_s)
            solution = solve_ivp(
                lambda t, flat: self.rates(min(max(t, from_s + inside), to_s - inside), flat, command, current_A),
                (from_s, to_s), y.ravel(), method=self.method, t_eval=at_s, rtol=tolerance, atol=0.01 * tolerance,
                max_step=max_step_s, events=room_rad_s if math.isfinite(fastest_rad_s) else None,
            )  # fmt: skip
            if solution.status == 1:
                raise MotionError(f"the platform turns faster than {fastest_rad_s:g} rad/s")
            if not solution.success or not np.all(np.isfinite(solution.y[:, -1])):
                raise MotionError("the motion under the injected effects diverges")
            reached = solution.y.reshape(y.shape + (-1,))
            result[..., wanted] = reached[..., : int(wanted.sum())]
            y = reached[..., -1].copy()
        return result

    def read(self, starts, commands, times_s, tolerance=1e-9, max_step_s=math.inf, fastest_rad_s=math.inf):
        """Readings of noiseless instruments at rising times."""
        times_s = np.asarray(times_s, dtype=float)
        p = self.platforms
        delays_s = np.unique(p.latency_s)
        seen_s = np.maximum(times_s[:, np.newaxis] - delays_s, self.start_s)
        all_s, back = np.unique(np.append(times_s, seen_s.ravel()), return_inverse=True)
        states = self.states(starts, commands, all_s, tolerance, max_step_s, fastest_rad_s)
        here, back = back[: times_s.size], back[times_s.size :].reshape(seen_s.shape)
        attitude = normalised(states[:4][..., here])
        camera = np.empty_like(attitude)
        for i, delay_s in enumerate(delays_s):
            of = p.latency_s == delay_s
            camera[:, of] = normalised(states[:4, of][..., back[:, i]])
        camera = product(camera, quaternion_of(p.camera_turn)[..., np.newaxis])
        rate = states[4:7][..., here]
        sensed = rate + times(body_from_lab(attitude), p.earth_lab[..., np.newaxis]) if self.turns else rate
        gyro = sensed + p.gyro_scale[..., np.newaxis] * sensed + cross(p.gyro_turn[..., np.newaxis], sensed)
        return Readings(attitude, camera, rate, gyro + p.gyro_bias[..., np.newaxis])


def read_one(world, start, commands, times_s, tolerance=1e-9, max_step_s=math.inf):
    """Readings of one platform, without the axis of members."""
    readings = Motion([world]).read([start], commands, times_s, tolerance, max_step_s)
    return Readings(*(getattr(readings, f.name)[:, 0] for f in dataclasses.fields(Readings)))
