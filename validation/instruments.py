"""Recordings by the instruments of a case: noise, faults and lost rows."""

import math

import numpy as np
from scipy.signal import lfilter

from .information import ARCSECOND_RAD
from .vectors import product, quaternion_of


def draw_rows(draw, sensors, duration_s):
    """(times, lost): times of the rows, and which rows are lost."""
    count = round(duration_s * sensors.rate_Hz)
    rows = np.arange(count, dtype=float)
    if not sensors.dirty:
        return np.round(rows / sensors.rate_Hz, 6), np.zeros(count, dtype=bool)
    jitter = np.clip(0.05 * draw.generator.standard_normal(count), -0.3, 0.3)
    jitter[0] = 0.0
    times_s = np.round((rows + jitter) / sensors.rate_Hz, 6)
    lost = draw.generator.random(count) < 0.003
    for _ in range(2):
        from_s = draw.uniform(0.1, 0.9) * duration_s
        length_s = draw.uniform(1.0, min(8.0, 0.05 * duration_s))
        lost |= (times_s >= from_s) & (times_s < from_s + length_s)
    lost[0] = False
    return times_s, lost


def errors(draw, noise, count, interval_s):
    """`count` errors of three channels, in units of their stated level."""
    random = draw.generator
    fresh = random.standard_normal((3, count))
    if noise.student_degrees > 0:  # Student's t, whose variance is ν/(ν − 2)
        fresh *= np.sqrt((noise.student_degrees - 2) / random.chisquare(noise.student_degrees, (3, count)))
    if noise.time_s > 0.0:
        alike = math.exp(-interval_s / noise.time_s)
        driven = math.sqrt(1.0 - alike * alike) * fresh
        driven[:, 0] = fresh[:, 0]
        fresh = lfilter([1.0], [1.0, -alike], driven, axis=1)
    fresh = noise.scale * fresh
    if noise.outlier_share > 0.0:
        fresh[:, random.random(count) < noise.outlier_share] *= 5.0
    return fresh


def _quantised(values, step):
    return np.round(values / step) * step if step > 0.0 else values


def _any_directions(draw, count):
    v = draw.generator.standard_normal((3, count))
    return v / np.linalg.norm(v, axis=0)


def _blown(draw, count, low, high):
    """Vectors of random direction with log-uniform lengths."""
    sizes = np.exp(draw.generator.uniform(math.log(low), math.log(high), count))
    return sizes * _any_directions(draw, count)


def attitude_cells(draw, sensors, seen):
    """The cells q_w … q_z of every row for the true attitudes `seen` (4, rows)."""
    count, every = seen.shape[1], sensors.camera_every
    due = np.arange(0, count, every)
    level = np.array(sensors.camera_noise_arcsec)
    turns = ARCSECOND_RAD * level[:, np.newaxis] * errors(draw, sensors.camera, due.size, every / sensors.rate_Hz)
    random = draw.generator
    if sensors.dirty:
        wild = random.random(due.size) < 0.002
        turns[:, wild] = _blown(draw, int(wild.sum()), 0.01, 0.3)
    q = product(quaternion_of(turns), seen[:, due])
    if sensors.dirty:  # some trackers flip the sign of a quaternion occasionally
        side = np.cumprod(np.where(random.random(due.size) < 0.01, -1.0, 1.0))
        empty = random.random(due.size) < 0.01
    else:  # most trackers report w ≥ 0
        side, empty = np.where(q[0] < 0.0, -1.0, 1.0), np.zeros(due.size, dtype=bool)
    # A small rotation changes the components by half its angle.
    q = _quantised(side * q, sensors.camera.step_sigma * 0.5 * ARCSECOND_RAD * min(level))
    cells = [",,,"] * count
    for row, is_empty, components in zip(due.tolist(), empty.tolist(), q.T.tolist(), strict=True):
        if not is_empty:
            cells[row] = "{:.9f},{:.9f},{:.9f},{:.9f}".format(*components)
    return cells


def gyro_cells(draw, sensors, rate_rad_s):
    """The cells of the gyro's three axes in every row, each after its comma."""
    count = rate_rad_s.shape[1]
    if not sensors.has_gyro:
        return [""] * count
    level = sensors.gyro_noise_rad_s
    read = rate_rad_s + level * errors(draw, sensors.gyro, count, 1.0 / sensors.rate_Hz)
    empty = np.zeros(count, dtype=bool)
    if sensors.dirty:
        wild = draw.generator.random(count) < 0.001
        read[:, wild] += _blown(draw, int(wild.sum()), 0.02, 1.0)
        empty = draw.generator.random(count) < 0.003
    read = _quantised(read, sensors.gyro.step_sigma * level)
    return [",,," if is_empty else ",{:.7e},{:.7e},{:.7e}".format(*axes)
            for is_empty, axes in zip(empty.tolist(), read.T.tolist(), strict=True)]  # fmt: skip
