#!/usr/bin/env python3
"""Motion and light recorded together, made by plain formulas. tools/light_speed takes light and circuit from it.

make.py OUT [CASE ...]     CASE: light, draught, tilt, cell, nothing

A tabletop on an air bearing swings and turns under nine lamps; an array of 6 x 3 cells in series, without bypass
diodes, works at its maximum. (With them two maxima are equal at some attitudes, and noise decides between them.) Nothing here is the program's: the motion is Euler's equations by
Runge and Kutta's formula, a lamp 19 points of its aperture, a cell 3 x 3 points, the circuit Newton's steps on
the diode equation and the highest maximum the best of a fine grid, refined by finer ones. Needs NumPy.
"""
import gzip
import json
import base64
import math
import pathlib
import random
import struct
import sys

import numpy as np

boltzmann, charge, planck, light_speed, gravity = 1.380649e-23, 1.602176634e-19, 6.62607015e-34, 299792458.0, 9.80665

mass, inertia, offset_z, drag = 7.0, (0.11, 0.12, 0.19), -6e-5, 2e-5
columns, rows, side, height = 6, 3, 0.05, 0.2  # cells, their side, the plate above the centre of rotation [m]
lamp_height, lamp_pitch, lamp_power, lamp_radius, fwhm = 1.0, (0.12, 0.06), 4.0, 0.009, math.radians(9.0)
cell = dict(saturation=1.2e-11, ideality=1.05, series=0.01, shunt=180.0)
temperature, efficiency, wavelength = 298.15, 0.9, 730e-9
noise = dict(camera=20 / 206264.8, gyro=1e-4, voltage=4e-3, current=1e-3)


# Motion.
def quaternion_product(p, q):
    return (p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0])


def turned_by(vector):
    angle = math.sqrt(sum(x * x for x in vector))
    if angle == 0.0:
        return (1.0, 0.0, 0.0, 0.0)
    s = math.sin(angle / 2) / angle
    return (math.cos(angle / 2), *(s * x for x in vector))


def matrix(q):
    w, x, y, z = q
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))


def times(m, v):
    return tuple(sum(m[i][k] * v[k] for k in range(3)) for i in range(3))


def transposed(m):
    return tuple(tuple(m[k][i] for k in range(3)) for i in range(3))


def rates(state, torque_lab):
    q, w = state[:4], state[4:]
    to_body = transposed(matrix(q))
    g = times(to_body, (0.0, 0.0, -gravity))
    pushed = times(to_body, torque_lab)
    torque = (-mass * offset_z * g[1], mass * offset_z * g[0], 0.0)  # m (0, 0, z) x g
    turn = quaternion_product(q, (0.0, *w))
    h = [inertia[i] * w[i] for i in range(3)]
    gyroscopic = (w[1] * h[2] - w[2] * h[1], w[2] * h[0] - w[0] * h[2], w[0] * h[1] - w[1] * h[0])
    return [0.5 * x for x in turn] + [
        (torque[i] + pushed[i] - drag * w[i] - gyroscopic[i]) / inertia[i] for i in range(3)]


def stepped(state, torque_lab, dt):
    def moved(k, part):
        return [a + part * dt * b for a, b in zip(state, k)]
    a = rates(state, torque_lab)
    b = rates(moved(a, 0.5), torque_lab)
    c = rates(moved(b, 0.5), torque_lab)
    d = rates(moved(c, 1.0), torque_lab)
    new = [x + dt / 6 * (p + 2 * q + 2 * r + s) for x, p, q, r, s in zip(state, a, b, c, d)]
    size = math.sqrt(sum(x * x for x in new[:4]))
    return [x / size for x in new[:4]] + new[4:]


# Light.
def disc_points():
    points = [(0.0, 0.0)]
    for ring, count in ((1, 6), (2, 12)):  # equal areas: 19 parts of the disc
        low, high = (1, 7) if ring == 1 else (7, 19)
        r = math.sqrt((low + high) / 2 / 19)
        points += [(r * math.cos(2 * math.pi * (k + 0.5) / count), r * math.sin(2 * math.pi * (k + 0.5) / count))
                   for k in range(count)]
    return [(lamp_radius * x, lamp_radius * y) for x, y in points]


def per_steradian():
    n, top = 4000, 0.5 * math.pi
    total = 0.0
    for k in range(n):
        angle = (k + 0.5) * top / n
        total += math.exp(-4 * math.log(2) * (angle / fwhm) ** 2) * 2 * math.pi * math.sin(angle) * top / n
    return 1.0 / total


lamps = [((i - 1) * lamp_pitch[0], (j - 1) * lamp_pitch[1]) for j in range(3) for i in range(3)]
aperture = np.array([(x + dx, y + dy) for x, y in lamps for dx, dy in disc_points()])
peak = per_steradian() * lamp_power / 19


def cell_points():
    """Gauss's points of every cell on the plate, and their weights: arrays (cells, points, 2) and (points,)."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    x = (np.arange(columns)[:, None] + 0.5 + 0.5 * nodes - columns / 2) * side
    y = (np.arange(rows)[:, None] + 0.5 + 0.5 * nodes - rows / 2) * side
    x, y = np.broadcast_arrays(x[None, :, :, None], y[:, None, None, :])
    return np.stack((x, y), axis=-1).reshape(rows * columns, 9, 2), 0.25 * np.outer(weights, weights).ravel()


points_m, point_weights = cell_points()


def cells_light(q):
    """Mean irradiance of each cell [W/m2], lamps at full power."""
    m = np.array(matrix(q))
    places = points_m @ m[:, :2].T + height * m[:, 2]
    x, y = (places[..., k, None] - aperture[:, k] for k in range(2))
    below = lamp_height - places[..., 2, None]
    across2 = x * x + y * y
    r2 = across2 + below * below
    angle = np.arctan(np.sqrt(across2) / below)
    arrives = (below * m[2, 2] - x * m[0, 2] - y * m[1, 2]) / np.sqrt(r2)
    light = peak * np.sum(np.exp(-4 * math.log(2) / fwhm**2 * angle * angle) * arrives / r2, axis=-1)
    return (light @ point_weights).tolist()


# The circuit.
thermal = cell["ideality"] * boltzmann * temperature / charge


def diode_V(dark):
    """The voltages at which diode and shunt take the currents `dark`, by Newton's steps."""
    v = thermal * np.log1p(np.maximum(dark, 0.0) / cell["saturation"])
    for _ in range(80):
        grown = cell["saturation"] * np.exp(v / thermal)
        step = (grown - cell["saturation"] + v / cell["shunt"] - dark) / (grown / thermal + 1 / cell["shunt"])
        v = v - step
        if np.max(np.abs(step)) < 1e-13:
            break
    return v


def serpentine():
    order = []
    for column in range(columns):
        down = range(rows) if column % 2 == 0 else reversed(range(rows))
        order += [row * columns + column for row in down]
    return order


order = serpentine()


def voltage(photocurrents, current):
    """Of the string at each of the currents."""
    current = np.asarray(current, dtype=float)
    each = diode_V(np.asarray(photocurrents)[order][:, None] - current) - current * cell["series"]
    return each.sum(axis=0)


def maximum(photocurrents):
    """Voltage and current at the highest maximum: the best of a fine grid, refined by grids about it."""
    top, steps = max(photocurrents), 60
    if top <= 0.0:
        return 0.0, 0.0
    low, high = 0.0, top
    while high - low > 1e-9:
        grid = np.linspace(low, high, steps + 1)
        best = int(np.argmax(grid * voltage(photocurrents, grid)))
        low, high = grid[max(best - 1, 0)], grid[min(best + 1, steps)]
    current = 0.5 * (low + high)
    return float(voltage(photocurrents, [current])[0]), float(current)


def shine(t, pattern):
    """Lamps over their brightest."""
    return pattern[int(t // 50) % len(pattern)]


def recording(path, what, spin, tilt, seconds, pattern, rng):
    pushed = (2.5e-5, -1.5e-5, 1.0e-5) if what in ("light", "draught") else (0.0, 0.0, 0.0)
    bias = (math.radians(1.2), math.radians(-0.8), 0.0) if what == "tilt" else (0.0, 0.0, 0.0)
    state = [*turned_by((tilt[0], tilt[1], 0.0)), 0.0, 0.0, spin]
    responsivity = efficiency * charge * wavelength / (planck * light_speed)
    dt, per_row = 0.02, 25
    lines = ["t_s,q_w,q_x,q_y,q_z,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,array_voltage_V,array_current_A,"
             "cell_temperature_K,led_current_A"]
    for row in range(int(seconds / (dt * per_row)) + 1):
        t = row * per_row * dt
        brightness = shine(t, pattern)
        light = [responsivity * side * side * brightness * e for e in cells_light(state[:4])]
        if what == "cell":
            light[9] *= 0.8
        v, i = maximum(light)
        # The camera's level is wrong: its lab is the true one turned back by the bias.
        seen = quaternion_product(turned_by([-b for b in bias]), state[:4])
        seen = quaternion_product(turned_by([rng.gauss(0, noise["camera"]) for _ in range(3)]), seen)
        gyro = [w + rng.gauss(0, noise["gyro"]) for w in state[4:]]
        lines.append(f"{t:.1f}," + ",".join(f"{x:.8f}" for x in seen) + "," + ",".join(f"{x:.6f}" for x in gyro) +
                     f",{v + rng.gauss(0, noise['voltage']):.4f},{i + rng.gauss(0, noise['current']):.5f},"
                     f"{temperature},{0.7 * brightness:.3f}")
        for _ in range(per_row):
            torque = [x * (brightness if what == "light" else 1.0) for x in pushed]
            state = stepped(state, torque, dt)
    path.write_bytes(gzip.compress(("\n".join(lines) + "\n").encode(), mtime=0))


def scene(path):
    w, d = 0.5 * columns * side, 0.5 * rows * side
    # glTF's y is up, its z is lab -y.
    corners = [(x, height, -y) for x, y in ((-w, -d), (w, -d), (w, d), (-w, d))]
    data = b"".join(struct.pack("<3f", *c) for c in corners) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    low, high = ([f(c[k] for c in corners) for k in range(3)] for f in (min, max))
    low, high = ([struct.unpack("<f", struct.pack("<f", x))[0] for x in one] for one in (low, high))
    path.write_text(json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "array", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "black", "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0}}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": low, "max": high},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}]}, indent=1) + "\n")


def experiment(path):
    path.write_text(f"""# The nominal model of a tabletop under nine lamps, its array and its instruments.
[scene]
file = "scene.gltf"

[[source]]
kind = "led_array"
layout = "grid"
count = [3, 3]
pitch_m = [{lamp_pitch[0]}, {lamp_pitch[1]}]
position_m = [0, 0, {lamp_height}]
direction = [0, 0, -1]
power_W = {lamp_power}
aperture_diameter_m = {2 * lamp_radius}
profile = "gaussian"
fwhm_deg = {math.degrees(fwhm):.6g}
wavelength_nm = 730
spectral_fwhm_nm = 20

[[receiver]]
kind = "flux_map"
node = "array"
bins = [120, 60]

[array]
receiver = "array"
cells = [{columns}, {rows}]
series = "columns"
temperature_K = {temperature}

[array.quantum_efficiency]
wavelength_nm = [600, 860]
efficiency = [{efficiency}, {efficiency}]

[array.cell_parameters]
reference_area_m2 = {side * side:.6g}
reference_temperature_K = {temperature}
saturation_1_A = {cell["saturation"]}
saturation_2_A = 0
ideality_1 = {cell["ideality"]}
series_ohm = {cell["series"]}
shunt_ohm = {cell["shunt"]}
breakdown_fraction = 0
photocurrent_slope_per_K = 0

[platform]
topology = "tabletop"
mass_kg = {mass}
inertia_kg_m2 = [[{inertia[0]}, 0, 0], [0, {inertia[1]}, 0], [0, 0, {inertia[2]}]]

[[disturbance]]
kind = "static_unbalance"
offset_m = [0, 0, {offset_z}]

[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = {drag}

[sensors.camera]
noise_arcsec = [20, 20, 20]

[sensors.gyro]
noise_rad_s = {noise["gyro"]}

[sensors.array]
voltage_noise_V = {noise["voltage"]}
current_noise_A = {noise["current"]}
""")


def main(out, cases):
    for number, what in enumerate(("light", "draught", "tilt", "cell", "nothing")):
        if cases and what not in cases:
            continue
        folder = pathlib.Path(out) / what
        folder.mkdir(parents=True, exist_ok=True)
        rng = random.Random(1600 + number)
        scene(folder / "scene.gltf")
        experiment(folder / "experiment.toml")
        changes = what in ("light", "draught")
        recording(folder / "run1.csv.gz", what, 0.05, (0.03, -0.02), 300.0,
                  (1.0, 0.2, 0.7, 0.0, 1.0, 0.4) if changes else (1.0,), rng)
        recording(folder / "run2.csv.gz", what, -0.03, (-0.02, -0.03), 200.0,
                  (0.3, 1.0, 0.0, 0.8) if changes else (1.0,), rng)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
