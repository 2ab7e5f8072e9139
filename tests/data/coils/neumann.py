#!/usr/bin/env python3
"""Mutual inductances of two circular filaments by Neumann's double integral, in 30 digits.

Writes mutual.csv beside it. Needs mpmath. No elliptic integral and no vector potential is used: both
circles are sampled evenly, which converges exponentially, until 14 digits have settled.
"""
import pathlib

from mpmath import cos, mp, mpf, nstr, pi, sin, sqrt

mp.dps = 30
MU0 = mpf("1.25663706212e-6")  # CODATA 2018
CASES = [  # radii, then centre and normal of the second; the first lies in z = 0 about the origin
    ("0.16", "0.10", ("0", "0.0433012702", "0.175"), ("0", "-0.86602540378443865", "0.5")),
    ("0.2", "0.25", ("0", "0", "0.1"), ("0", "0", "1")),
    ("0.16", "0.10", ("0", "0.05", "0.175"), ("0", "0.8", "0.6")),
    ("0.1", "0.08", ("0.03", "-0.02", "0.07"), ("0.3", "0.5", "0.9")),
    ("0.1", "0.1", ("0.15", "0", "0.05"), ("1", "0", "0.2")),
    ("0.06", "0.09", ("0.01", "0", "0.04"), ("0.5", "0", "0.8660254037844386")),
    ("0.1", "0.03", ("0", "0", "0.05"), ("0", "1", "1")),
    ("0.1", "0.02", ("0.3", "0.4", "-0.5"), ("1", "2", "3")),
    ("0.08", "0.08", ("0", "0", "0.04"), ("0.1", "0", "1")),
]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    size = sqrt(sum(x * x for x in a))
    return [x / size for x in a]


def neumann(a, b, centre, normal, count):
    n = unit([mpf(x) for x in normal])
    u = unit(cross([mpf(1), 0, 0] if abs(n[0]) < 0.9 else [0, mpf(1), 0], n))
    v = cross(n, u)
    c = [mpf(x) for x in centre]
    circle = [(cos(2 * pi * i / count), sin(2 * pi * i / count)) for i in range(count)]
    total = mpf(0)
    for cs, sn in circle:
        r = [c[k] + b * (u[k] * cs + v[k] * sn) for k in range(3)]
        dl = [b * (v[k] * cs - u[k] * sn) for k in range(3)]
        for pc, ps in circle:
            total += a * (pc * dl[1] - ps * dl[0]) / sqrt(
                (r[0] - a * pc) ** 2 + (r[1] - a * ps) ** 2 + r[2] ** 2)
    return MU0 * pi / count**2 * total


rows = ["radius_1_m,radius_2_m,centre_x_m,centre_y_m,centre_z_m,normal_x,normal_y,normal_z,mutual_H"]
for first, second, centre, normal in CASES:
    count, before = 96, mpf(0)
    while True:
        value = neumann(mpf(first), mpf(second), centre, normal, count)
        if abs(value - before) < mpf(10) ** -14 * abs(value):
            break
        before, count = value, count * 3 // 2
    rows.append(",".join([first, second, *centre, *normal, nstr(value, 17)]))
(pathlib.Path(__file__).parent / "mutual.csv").write_text("\n".join(rows) + "\n")
