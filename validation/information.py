"""Information in the readings of a case's first run, to first order.

Differences of simulated readings, in units of their noise, are the columns of a linear model. The initial
state and the uncertain parameters (with their priors) are free and absorb a part of an effect's difference.
The remaining part is visible.
"""

import dataclasses
import math

import numpy as np

from .case import NOMINAL_DRAG, NOMINAL_GYRO_BIAS, NOMINAL_UNBALANCE
from .draw import Draw
from .laws import CATALOGUE, CREEP_RAD_S, KINDS
from .motion import Effect, Motion, Start
from .vectors import conjugate, length, product, quaternion_of, turn_of

ARCSECOND_RAD = math.pi / 180.0 / 3600.0
LINEAR = tuple(kind.name for kind in CATALOGUE if kind.is_linear)


def creep_rad_s(world):
    """Rate below which dry friction creeps, chosen so that friction stops no platform in less than a fifth of a
    second."""
    stop = max((e.numbers["torque_N_m"] for e in world.effects if e.kind == "dry_friction"), default=0.0)
    return max(CREEP_RAD_S, 0.2 * stop / min(world.moments_kg_m2))


def independent_share(noise, interval_s):
    """Effective number of independent readings per reading for slow changes, for correlated errors."""
    if noise.time_s == 0.0:
        return 1.0
    alike = math.exp(-interval_s / noise.time_s)
    return (1.0 - alike) / (1.0 + alike)


class Information:
    """Linear model about the true motion. `kinds`: kinds whose numbers compete with the effects."""

    def __init__(self, case, kinds):
        self.case = case
        run, sensors = case.runs[0], case.sensors
        # One reading about every 0.7 s, at uneven times, represents the readings around it.
        count = int(min(max(run.duration_s / 0.7, 200), 800))
        uneven = Draw(*case.seed, 5).generator.random(count)
        times_s = run.duration_s * (np.arange(count) + uneven) / count
        each, interval_s = run.duration_s * sensors.rate_Hz / count, 1.0 / sensors.rate_Hz
        camera = math.sqrt(each * independent_share(sensors.camera, interval_s * sensors.camera_every)
                           / sensors.camera_every)  # fmt: skip
        gyro = math.sqrt(each * independent_share(sensors.gyro, interval_s)) if sensors.has_gyro else 0.0
        self._camera_weight = camera / (ARCSECOND_RAD * np.array(sensors.camera_noise_arcsec))
        self._gyro_weight = gyro / sensors.gyro_noise_rad_s
        self._members, self._groups = [(case.world, run.start, 0.0)], {}
        prior_sigmas = self._add_nuisances()
        self._add_changes()
        for kind in kinds:
            self._add_columns(kind)
        self._solve(run, times_s, prior_sigmas)

    def _add(self, group, world, start, by):
        self._groups.setdefault(group, []).append(len(self._members))
        self._members.append((world, start, by))

    def _add_nuisances(self):
        world, start, priors = self.case.world, self.case.runs[0].start, self.case.priors
        sigmas = []
        for k in range(3):
            unit = np.eye(3)[k]
            turned = Start(product(quaternion_of(1e-6 * unit), start.attitude), start.rate_rad_s)
            faster = Start(start.attitude, start.rate_rad_s + 1e-7 * unit)
            options = [(world, turned, 1e-6, 0.0), (world, faster, 1e-7, 0.0)]
            if priors.offset_sigma_m[k] > 0.0:
                options.append((world.but(offset_m=world.offset_m + 1e-8 * unit), start, 1e-8, priors.offset_sigma_m[k]))
            if priors.gyro_bias_sigma_rad_s > 0.0 and self.case.sensors.has_gyro:
                biased = world.but(gyro_bias_rad_s=world.gyro_bias_rad_s + 1e-6 * unit)
                options.append((biased, start, 1e-6, priors.gyro_bias_sigma_rad_s))
            for option in options:
                self._add("nuisance", *option[:3])
                sigmas.append(option[3])
        if priors.drag_sigma_N_m_s > 0.0:
            self._add("nuisance", world.but(drag_N_m_s=world.drag_N_m_s + 1e-8), start, 1e-8)
            sigmas.append(priors.drag_sigma_N_m_s)
        return np.array(sigmas)

    def _add_changes(self):
        """Adds the change of the readings when an effect is reduced by a small fraction. The effect is removed
        completely if the readings are not proportional to its strength: an appendage's inertia also shifts its
        resonance."""
        world, start = self.case.world, self.case.runs[0].start
        for index, effect in enumerate(world.effects):
            kind, others = KINDS[effect.kind], world.effects[:index] + world.effects[index + 1 :]
            if not kind.strength or effect.kind == "flexible_mode":
                self._add(("change", index), world.but(effects=others), start, -1.0)
            else:
                changed = world.effects[:index] + [effect.scaled(1.0 - 1e-3)] + world.effects[index + 1 :]
                self._add(("change", index), world.but(effects=changed), start, -1e-3)

    def _add_columns(self, name):
        world, start, kind = self.case.world, self.case.runs[0].start, KINDS[name]

        def add(numbers, by):
            self._add(name, world.but(effects=[*world.effects, Effect(name, numbers)]), start, by)

        if kind.is_linear and not kind.strength:
            add({}, 1.0)
        elif kind.is_linear:
            for k in range(kind.components):
                add({kind.strength: kind.step if kind.components == 1 else (kind.step * np.eye(kind.components)[k])},
                    kind.step)  # fmt: skip
        elif kind.is_tone:  # at the frequency of the acting tone
            for acting in world.effects:
                if acting.kind == name or not KINDS[acting.kind].is_tone:
                    continue
                for phase in (0.0, 0.5 * math.pi):
                    for k in range(3):
                        add({kind.strength: kind.step * np.eye(3)[k], "frequency_Hz": acting.numbers["frequency_Hz"],
                             "phase": phase}, kind.step)  # fmt: skip

    def _solve(self, run, times_s, prior_sigmas):
        worlds, starts = [m[0] for m in self._members], [m[1] for m in self._members]
        frequencies = [e.numbers["frequency_Hz"] for e in self.case.world.effects if "frequency_Hz" in e.numbers]
        motion = Motion(worlds, creep_rad_s(self.case.world))
        readings = motion.read(starts, run.commands, times_s, 1e-7, 0.3 / max(frequencies, default=1e-9))
        turns = turn_of(product(readings.camera, conjugate(readings.camera[:, :1])))
        faster = readings.gyro_rad_s - readings.gyro_rad_s[:, :1]
        rows = np.concatenate((self._camera_weight[:, np.newaxis, np.newaxis] * turns, self._gyro_weight * faster))
        columns = np.moveaxis(rows, 1, -1).reshape(-1, len(worlds))[:, 1:] / np.array([m[2] for m in self._members[1:]])
        # The triangular factor of a QR decomposition preserves lengths and angles in a few rows.
        columns = np.linalg.qr(columns, mode="r")
        self._columns = {group: columns[:, np.array(at) - 1] for group, at in self._groups.items()}
        priors = np.diag(np.where(prior_sigmas > 0.0, 1.0 / np.where(prior_sigmas > 0.0, prior_sigmas, 1.0), 0.0))
        self._nuisance = np.vstack((self._columns["nuisance"], priors))
        self.changes = [self._columns[("change", i)][:, 0] for i in range(len(self.case.world.effects))]
        self._turns_far = bool(np.any(length(turn_of(readings.camera[:, 0])) > 3.0))

    def columns_of(self, kind):
        """Columns of a kind's numbers; empty if the readings are not linear in them."""
        return self._columns.get(kind, np.zeros((self._nuisance.shape[0] - self._nuisance.shape[1], 0)))

    def gain(self, change, others=()):
        """Squared part of `change` that neither the initial state, the uncertain priors nor the columns of `others`
        can absorb: the gain in chi² when the effect is known."""
        free = np.hstack([o for o in others]) if len(others) else np.zeros((change.size, 0))
        extra = self._nuisance.shape[1]
        all_columns = np.hstack((self._nuisance, np.vstack((free, np.zeros((extra, free.shape[1]))))))
        sizes = np.linalg.norm(all_columns, axis=0)  # the underlying numbers have different units
        all_columns = all_columns[:, sizes > 0.0] / sizes[sizes > 0.0]
        wanted = np.append(change, np.zeros(extra))
        fit = np.linalg.lstsq(all_columns, wanted, rcond=1e-12)[0]
        return float(np.sum((wanted - all_columns @ fit) ** 2))

    def competitors(self):
        """Kinds of the catalogue with a linear strength that could act in this case."""
        return [kind for kind in competing_kinds(self.case) if not (KINDS[kind].needs_small_turns and self._turns_far)]


def competing_kinds(case):
    """Effects that compete in a case, before its motion is known."""
    commanded = any(np.any(c.torque_N_m) for c in case.runs[0].commands)
    priors = case.priors
    nuisances = {NOMINAL_UNBALANCE: priors.offset_sigma_m[0] > 0.0, NOMINAL_DRAG: priors.drag_sigma_N_m_s > 0.0,
                 NOMINAL_GYRO_BIAS: priors.gyro_bias_sigma_rad_s > 0.0}  # fmt: skip
    kinds = [k for k in LINEAR if not nuisances.get(k, False) and (commanded or KINDS[k].needs != "command")]
    for acting in case.world.effects:
        if KINDS[acting.kind].is_tone:
            kinds += [k.name for k in CATALOGUE if k.is_tone and k.name != acting.kind]
    return kinds


def with_effects(case, effects):
    return dataclasses.replace(case, world=case.world.but(effects=effects))
