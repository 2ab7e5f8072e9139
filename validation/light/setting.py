"""Random lamps, plates, arrays and recordings as in a laboratory."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from ..draw import Draw
from .circuit import Cell, Circuit, LitCircuit
from .illumination import Beam, Lamp, Plate, Room, Wall
from .readings import Noise, Rows, World, light_on_cells, quaternion_at

CIRCUIT_KINDS = {
    "soiling",
    "angular_response",
    "cell_degraded",
    "string_open",
    "bypass_shorted",
    "shunt",
    "series_resistance",
    "temperature_coefficient",
}
RUN_KINDS = {"led_droop", "tracker_trapped", "slow_drift", "flicker"}
SCAN_KINDS = {"detector_gain", "ripple", "vignetting", "hair", "interreflection"}
NO_RUN_KINDS = SCAN_KINDS | {"unmodelled_shadow", "string_open", "bypass_shorted"}
REFERENCE_AREA_M2 = 0.0025
REFERENCE_K = 298.15
EDGE_M = 0.005  # edge of the plate, which a scan omits


class RoundedDraw(Draw):
    """Random numbers with as many digits as in an experiment file."""

    def uniform(self, low, high, digits=15):
        return round(super().uniform(low, high), digits)

    def log_uniform(self, low, high, digits=15):
        return round(super().log_uniform(low, high), digits)


def _unit(vector):
    return tuple(np.asarray(vector, dtype=float) / np.linalg.norm(vector))


def _beam_keys(lamp):
    """Keys of [[source]] for a lamp's power, aperture and beam."""
    beam = lamp.beam
    keys = {"power_W": lamp.power_W, "aperture_diameter_m": round(2.0 * lamp.radius_m, 9), "profile": beam.profile}
    if beam.profile == "cosine_power":
        keys["exponent"] = beam.exponent
    else:
        keys["fwhm_deg"] = round(math.degrees(beam.fwhm_rad), 6)
    if beam.profile == "super_gaussian":
        keys["order"] = beam.order
    return keys | {"wavelength_nm": 730, "spectral_fwhm_nm": 20}


def _draw_panel(draw):
    """Keys of a panel's layout, and the positions of its lamps relative to its centre."""
    layout = draw.below(4)
    if layout == 0:
        columns, rows = 2 + draw.below(4), 2 + draw.below(3)
        pitch = [draw.uniform(0.045, 0.11, 4), draw.uniform(0.045, 0.08, 4)]
        at_m = [
            ((i - 0.5 * (columns - 1)) * pitch[0], (j - 0.5 * (rows - 1)) * pitch[1], 0.0)
            for j in range(rows)
            for i in range(columns)
        ]
        return {"layout": "grid", "count": [columns, rows], "pitch_m": pitch}, at_m
    if layout == 1:
        count, radius = 5 + draw.below(6), draw.uniform(0.045, 0.09, 4)
        angles = [2.0 * math.pi * k / count for k in range(count)]
        at_m = [(radius * math.cos(a), radius * math.sin(a), 0.0) for a in angles]
        return {"layout": "ring", "count": count, "ring_radius_m": radius}, at_m
    if layout == 2:
        pitch = draw.uniform(0.06, 0.09, 4)
        angles = [math.pi / 3.0 * k for k in range(6)]
        at_m = [(0.0, 0.0, 0.0), *((pitch * math.cos(a), pitch * math.sin(a), 0.0) for a in angles)]
        return {"layout": "hexagonal", "count": 7, "pitch_m": pitch}, at_m
    columns, rows = 2 + draw.below(2), 2 + draw.below(2)
    at_m = [
        (
            round((i - 0.5 * (columns - 1)) * 0.065 + draw.uniform(-0.01, 0.01), 4),
            round((j - 0.5 * (rows - 1)) * 0.06 + draw.uniform(-0.01, 0.01), 4),
            draw.uniform(-0.04, 0.04, 4),
        )
        for j in range(rows)
        for i in range(columns)
    ]
    return {"layout": "positions"}, at_m


def _draw_side_lamps(draw, radius_m):
    """Three to five single lamps that light the plate from the sides."""
    lamps, sources = [], []
    count = 3 + draw.below(3)
    for k in range(count):
        angle, out = 2.0 * math.pi * (k + draw.uniform(-0.2, 0.2)) / count, draw.uniform(0.18, 0.32)
        at_m = (round(out * math.cos(angle), 4), round(out * math.sin(angle), 4), draw.uniform(0.75, 1.0, 4))
        direction = (
            round(draw.uniform(-0.05, 0.05) - at_m[0], 4),
            round(draw.uniform(-0.05, 0.05) - at_m[1], 4),
            round(0.04 - at_m[2], 4),
        )
        beam = Beam(
            ["gaussian", "super_gaussian", "cosine_power"][draw.below(3)],
            math.radians(draw.uniform(18.0, 32.0, 1)),
            4.0,
            draw.uniform(10.0, 30.0, 1),
        )
        lamp = Lamp(at_m, _unit(direction), draw.uniform(25.0, 45.0, 2), radius_m, beam)
        lamps.append(lamp)
        place = {"position_m": list(at_m), "direction": list(direction)}
        sources.append({"kind": "led", "name": f"lamp_{k}"} | place | _beam_keys(lamp))
    return lamps, sources


def _draw_lamps(draw):
    """Lamps and their tables [[source]]: a panel above the plate, or single lamps beside it."""
    radius_m = round(0.0005 * round(draw.uniform(0.005, 0.014) / 0.0005), 4)
    if draw.chance(0.15):
        return _draw_side_lamps(draw, radius_m)
    centre = (draw.uniform(-0.02, 0.02, 4), draw.uniform(-0.02, 0.02, 4), draw.uniform(0.8, 1.15, 4))
    power_W, fwhm_rad = draw.uniform(2.0, 8.0, 2), math.radians(draw.uniform(4.5, 9.0, 2))
    profile, order = ("super_gaussian", 4.0) if draw.chance(0.2) else ("gaussian", 2.0)
    layout, offsets = _draw_panel(draw)
    at_m = [tuple(round(c + o, 12) for c, o in zip(centre, offset)) for offset in offsets]
    if layout["layout"] == "positions":
        place, aim = {"positions_m": [list(p) for p in at_m]}, None
    else:
        place = {"position_m": list(centre)}
        aim = (0.0, 0.0, -draw.uniform(0.3, 1.2, 4)) if draw.chance(0.2) else None
    axes = [_unit(np.subtract(aim, p)) if aim else (0.0, 0.0, -1.0) for p in at_m]
    beam = Beam(profile, fwhm_rad, order)
    lamps = [Lamp(p, axis, power_W, radius_m, beam) for p, axis in zip(at_m, axes)]
    source = {"kind": "led_array", "name": "lamps"} | layout | place | _beam_keys(lamps[0])
    source["direction"] = [0, 0, -1]
    if aim:
        source |= {"aim": "converging", "aim_m": list(aim)}
    return lamps, [source]


def _draw_circuit(draw, kinds):
    """The array, and the edge length of its square cells."""
    columns, rows, strings = 3 + draw.below(4), 2 + draw.below(3), 1
    along_columns = draw.chance(0.7)
    if "string_open" in kinds or draw.chance(0.15):
        strings = 2 if columns % 2 == 0 or rows % 2 == 0 else 3 if columns % 3 == 0 else 1
        if strings == 1:
            rows, strings = 2, 2
    in_string = columns * rows // strings
    line = rows if along_columns else columns
    bypass_every = in_string
    if kinds & {"bypass_shorted", "tracker_trapped"} or draw.chance(0.8):
        bypass_every = line if line < in_string else max(1, in_string // 2)
    edge_m = draw.uniform(0.04, 0.058, 3)
    # Numbers are stated for 25 cm²; a larger cell corresponds to several of these in parallel.
    size = edge_m**2 / REFERENCE_AREA_M2
    cell = Cell(
        saturation_A=size * draw.uniform(0.8, 1.8, 2) * 1e-11,
        ideality=draw.uniform(1.0, 1.15, 3),
        series_ohm=draw.uniform(0.005, 0.015, 4) / size,
        shunt_ohm=draw.uniform(60.0, 300.0, 1) / size,
    )
    circuit = Circuit(
        columns,
        rows,
        strings,
        bypass_every,
        along_columns,
        blocking=strings > 1 and draw.chance(0.5),
        drop_V=draw.uniform(0.35, 0.6, 2),
        efficiency=draw.uniform(0.84, 0.95, 3),
        cell_area_m2=edge_m**2,
        cell=cell,
    )
    return circuit, edge_m


def _draw_wall(draw, plate):
    """A black wall along one edge of the plate."""
    axis, facing = draw.below(2), draw.sign()
    gap = draw.uniform(0.006, 0.03, 4)
    low, high = (plate.u_low_m, plate.v_low_m), (plate.u_high_m, plate.v_high_m)
    bottom = plate.z_m - 0.005
    return Wall(
        axis,
        low[axis] - gap if facing > 0.0 else high[axis] + gap,
        low[1 - axis] - 0.02,
        high[1 - axis] + 0.02,
        bottom,
        bottom + draw.uniform(0.15, 0.25, 3),
        facing,
    )


def _scan(world, attitudes, side, is_first):
    """A scan of a photodiode over the plate with side × side points at each (tilt, heading)."""
    plate = world.room.plate
    u = np.linspace(plate.u_low_m + EDGE_M, plate.u_high_m - EDGE_M, side).round(5)
    v = np.linspace(plate.v_low_m + EDGE_M, plate.v_high_m - EDGE_M, side).round(5)
    u, v = (x.ravel() for x in np.meshgrid(u, v))
    times, count = len(attitudes), len(u)
    tilt, heading = np.repeat(np.array(attitudes, dtype=float), count, axis=0).T
    quaternions = np.repeat([quaternion_at(*a) for a in attitudes], count, axis=0)
    return Rows("scan", is_first, quaternions, tilt, heading, np.tile(u, times), np.tile(v, times))


def _sweep(world, conditions, points, is_first):
    """Curves at each (tilt, heading, temperature) from 0 V to slightly above the open-circuit voltage."""
    voltages = []
    for tilt, heading, kelvin in conditions:
        attitude = Rotation.from_quat(np.roll(quaternion_at(tilt, heading), -1)).as_matrix()
        lit = LitCircuit(world.circuit, light_on_cells(world, attitude), kelvin)
        voltages.append(1.003 * lit.open_voltage_V()[0] * np.arange(points) / (points - 1))
    tilt, heading, kelvin = np.repeat(np.array(conditions, dtype=float), points, axis=0).T
    quaternions = np.repeat([quaternion_at(t, h) for t, h, _ in conditions], points, axis=0)
    return Rows(
        "sweep",
        is_first,
        quaternions,
        tilt,
        heading,
        voltage_V=np.concatenate(voltages),
        temperature_K=kelvin,
        sweep=np.repeat(np.arange(len(conditions)), points),
    )


def _run(draw, duration_s, is_first):
    """A platform that swings, rotates slowly and warms up, with a reading every second."""
    wide, yaw = draw.uniform(0.04, 0.14), draw.uniform(0.1, 0.6)
    base_K, warm_K = draw.uniform(293.0, 303.0), draw.uniform(0.0, 8.0)
    rates = [2.0 * math.pi / draw.uniform(30.0, 140.0) for _ in range(6)]
    phases = [draw.uniform(0.0, 2.0 * math.pi) for _ in range(5)]
    t = np.arange(0.0, duration_s)
    wave = [np.sin(rates[k] * t + phases[k]) for k in range(4)]
    swing = np.column_stack([wide * (wave[0] + 0.5 * wave[1]), wide * (wave[2] + 0.5 * wave[3]), 0.0 * t])
    turn = np.column_stack([0.0 * t, 0.0 * t, yaw * np.sin(0.5 * rates[4] * t + phases[4])])
    attitude = Rotation.from_rotvec(swing) * Rotation.from_rotvec(turn)
    quaternions = np.roll(attitude.as_quat(), 1, axis=1).round(7)
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    kelvin = base_K + warm_K * (1.0 - np.exp(-t / 200.0)) + np.sin(rates[5] * t)
    return Rows("run", is_first, quaternions, time_s=t, temperature_K=kelvin.round(2))


def _draw_recordings(draw, world, kinds):
    """Recordings in which all kinds can be visible, and an equal number of held-out ones: {"scan1": Rows, "scan2":
    Rows, …}."""
    no_run = kinds & NO_RUN_KINDS or world.room.walls
    if kinds & RUN_KINDS or (not no_run and draw.chance(0.18)):
        duration_s = 300.0 + 100.0 * draw.below(5)
        return {"run1": _run(draw, duration_s, True), "run2": _run(draw, 300.0, False)}
    needs_scan, needs_circuit = bool(kinds & SCAN_KINDS), bool(kinds & CIRCUIT_KINDS)
    has_scan = needs_scan or draw.chance(0.4 if needs_circuit else 0.85)
    has_sweep = needs_circuit or not has_scan or draw.chance(0.35)
    attitudes = [(0.0, 0.0)]
    if "interreflection" in kinds or draw.chance(0.4):
        attitudes.append((draw.uniform(6.0, 20.0, 0), draw.uniform(0.0, 360.0, 0)))
    if "angular_response" in kinds or draw.chance(0.15):  # glass has an effect only at oblique incidence
        attitudes.append((25.0, draw.uniform(0.0, 360.0, 0)))
    recordings = {}
    if has_scan:
        recordings["scan1"] = _scan(world, attitudes, 24 + draw.below(24), True)
        recordings["scan2"] = _scan(world, [(12.0, 60.0)], 31, False)
    if has_sweep:
        conditions, held = [(*a, REFERENCE_K) for a in attitudes], [(12.0, 60.0, REFERENCE_K)]
        if "temperature_coefficient" in kinds or draw.chance(0.4):
            conditions.append((0.0, 0.0, draw.uniform(308.0, 328.0, 2)))
            held.append((0.0, 0.0, draw.uniform(303.0, 318.0, 2)))
        recordings["iv1"] = _sweep(world, conditions, 150 + 50 * draw.below(6), True)
        recordings["iv2"] = _sweep(world, held, 300, False)
    return recordings


def draw_setting(draw, kinds):
    """A nominal world, its tables [[source]], its noise and its recordings, in which effects of these kinds can act."""
    kinds = set(kinds)
    circuit, edge_m = _draw_circuit(draw, kinds)
    u_low = round(-0.5 * edge_m * circuit.columns + draw.uniform(-0.015, 0.015), 4)
    v_low = round(-0.5 * edge_m * circuit.rows + draw.uniform(-0.015, 0.015), 4)
    plate = Plate(
        u_low,
        round(u_low + edge_m * circuit.columns, 4),
        v_low,
        round(v_low + edge_m * circuit.rows, 4),
        draw.uniform(0.02, 0.05, 4),
    )
    room = Room(plate)
    if "interreflection" in kinds or draw.chance(0.1):
        room.walls.append(_draw_wall(draw, plate))
    room.lamps, sources = _draw_lamps(draw)
    noise = Noise(
        draw.log_uniform(1.5, 8.0, 1),
        0.0 if draw.chance(0.2) else draw.log_uniform(0.003, 0.02, 4),
        draw.log_uniform(0.003, 0.012, 4),
        draw.log_uniform(0.002, 0.008, 4),
    )
    world = World(room, circuit)
    return world, sources, noise, _draw_recordings(draw, world, kinds)
