"""Files of a case of light: experiment.toml, oracle.toml, scene.gltf, recordings and truth.json."""

import base64
import json

import numpy as np

from ..draw import Draw
from ..files import write_file, write_gzip
from . import readings
from .setting import REFERENCE_AREA_M2, REFERENCE_K

LOST_SHARE, WILD_SHARE = 0.03, 0.002  # of the rows of a dirty recording


def _toml(value):
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(v) for v in value) + "]"
    return repr(int(value)) if isinstance(value, (int, np.integer)) else f"{value:.12g}"


def _table(header, keys):
    return f"{header}\n" + "".join(f"{key} = {_toml(value)}\n" for key, value in keys.items()) + "\n"


def _wall_name(world, wall):
    return "wall" if len(world.room.walls) == 1 else f"wall_{wall}"


def _gltf(rectangles):
    """A glTF 2.0 scene of named rectangles. Corners are counter-clockwise as seen from the front, in body axes; y is
    up in glTF."""
    data, views, accessors = b"", [], []
    for corners in rectangles.values():
        vertices = np.array([(x, z, -y) for x, y, z in corners], dtype="<f4")
        indices = np.array([0, 1, 2, 0, 2, 3], dtype="<u2")
        bounds = {"min": vertices.min(axis=0).tolist(), "max": vertices.max(axis=0).tolist()}
        for array, accessor in (
            (vertices, {"componentType": 5126, "count": 4, "type": "VEC3", **bounds}),
            (indices, {"componentType": 5123, "count": 6, "type": "SCALAR"}),
        ):
            accessors.append({"bufferView": len(views), **accessor})
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
            data += array.tobytes()
    black = {"photorque": {"absorptance": 1}}
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(rectangles)))}],
        "nodes": [{"name": name, "mesh": k} for k, name in enumerate(rectangles)],
        "meshes": [
            {
                "name": name,
                "primitives": [{"attributes": {"POSITION": 2 * k}, "indices": 2 * k + 1, "material": k}],
            }
            for k, name in enumerate(rectangles)
        ],
        "materials": [{"name": f"{name}_surface", "doubleSided": True, "extras": black} for name in rectangles],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }
    return json.dumps(scene) + "\n"


def _scene(world):
    plate = world.room.plate
    u, v = (plate.u_low_m, plate.u_high_m), (plate.v_low_m, plate.v_high_m)
    rectangles = {"array": [(u[i], v[j], plate.z_m) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]}
    for k, wall in enumerate(world.room.walls):
        corners = []
        for along, up in (
            (wall.from_m, wall.bottom_m),
            (wall.to_m, wall.bottom_m),
            (wall.to_m, wall.top_m),
            (wall.from_m, wall.top_m),
        ):
            corner = [0.0, 0.0, up]
            corner[wall.axis], corner[1 - wall.axis] = wall.at_m, along
            corners.append(corner)
        rectangles[_wall_name(world, k)] = corners
    return _gltf(rectangles)


def experiment_text(case):
    """Nominal model of the light, the array and the instruments."""
    circuit, noise = case.believed.circuit, case.noise
    cell, size = circuit.cell, circuit.cell_area_m2 / REFERENCE_AREA_M2
    efficiency = {"wavelength_nm": [600, 860], "efficiency": [circuit.efficiency] * 2}
    tables = [("[scene]", {"file": "scene.gltf"})]
    tables += [("[[source]]", source) for source in case.sources]
    tables += [
        (
            "[[receiver]]",
            {
                "kind": "flux_map",
                "node": "array",
                "bins": [20 * circuit.columns, 20 * circuit.rows],
                "facing": [0, 0, 1],
            },
        ),
        (
            "[array]",
            {
                "receiver": "array",
                "cells": [circuit.columns, circuit.rows],
                "gap_m": 0,
                "margin_m": 0,
                "series": "columns" if circuit.along_columns else "rows",
                "strings": circuit.strings,
                "bypass_every": circuit.bypass_every,
                "bypass": "ideal",
                "blocking": "ideal" if circuit.blocking else "none",
                "temperature_K": REFERENCE_K,
            },
        ),
        ("[array.bypass_diode]", {"drop_V": circuit.drop_V}),
        ("[array.quantum_efficiency]", efficiency),
        (
            "[array.cell_parameters]",
            {
                "reference_area_m2": REFERENCE_AREA_M2,
                "reference_temperature_K": cell.reference_K,
                "saturation_1_A": cell.saturation_A / size,
                "saturation_2_A": 0,
                "ideality_1": cell.ideality,
                "series_ohm": cell.series_ohm * size,
                "shunt_ohm": cell.shunt_ohm * size,
                "breakdown_fraction": 0,
                "gap_eV": cell.gap_eV,
                "gap_slope_per_K": cell.gap_slope_per_K,
                "photocurrent_slope_per_K": cell.photocurrent_slope_per_K,
            },
        ),
        ("[attitude]", {"tilt_deg": 0, "heading_deg": 0}),
        ("[sensors.irradiance]", {"noise_W_m2": noise.irradiance_W_m2, "relative_noise": noise.relative}),
        ("[sensors.array]", {"voltage_noise_V": noise.voltage_V, "current_noise_A": noise.current_A}),
    ]
    return "".join(_table(header, keys) for header, keys in tables)


def oracle_text(case):
    """The experiment with every acting effect and its true numbers."""
    text = experiment_text(case)
    for effect in case.effects:
        keys = {"kind": effect.kind}
        if effect.kind == "interreflection":
            keys["node"] = _wall_name(case.believed, effect.index)
        elif effect.index is not None:
            keys["index"] = effect.index
        if effect.kind == "unmodelled_shadow":
            low, high = np.array(effect.numbers["low_m"]), np.array(effect.numbers["high_m"])
            keys |= {"axes": "body" if effect.numbers["on_body"] else "lab", "opacity": 1}
            keys |= {"centre_m": list(0.5 * (low + high)), "size_m": list((high - low)[:2])}
        else:
            keys |= effect.numbers
        if effect.kind == "tracker_trapped":
            keys["recording"] = 0
        text += _table("[[effect]]", keys)
    return text


def _recording_text(case, name):
    """A recording with noise; a dirty one also has comments, lost rows and outliers."""
    rows = case.recordings[name]
    draw = Draw(*case.seed, 2, *name.encode()).generator
    values, count = readings.read(case.truth(), rows), len(rows)
    wild = np.where(draw.random(count) < WILD_SHARE * case.is_dirty, draw.uniform(2.0, 4.0, count), 1.0)
    kept = draw.random(count) >= LOST_SHARE * case.is_dirty
    noise = draw.normal(size=(count, 2))
    sensors = case.noise
    if rows.kind == "scan":
        sigma = readings.errors(case.believed, rows, sensors, values)
        columns = [("u_m", "%.5f", rows.u_m), ("v_m", "%.5f", rows.v_m)]
        columns += [("irradiance_W_m2", "%.2f", (values + sigma * noise[:, 0]) * wild)]
        if np.any(rows.tilt_deg != 0.0):
            columns += [("tilt_deg", "%g", rows.tilt_deg), ("heading_deg", "%g", rows.heading_deg)]
    elif rows.kind == "sweep":
        columns = [
            ("voltage_V", "%.4f", rows.voltage_V + sensors.voltage_V * noise[:, 0]),
            ("current_A", "%.5f", (values + sensors.current_A * noise[:, 1]) * wild),
            ("sweep", "%d", rows.sweep),
            ("tilt_deg", "%g", rows.tilt_deg),
            ("heading_deg", "%g", rows.heading_deg),
            ("cell_temperature_K", "%.2f", rows.temperature_K),
        ]
    else:
        voltage = values[:, 0] + sensors.voltage_V * noise[:, 0]
        current = (values[:, 1] + sensors.current_A * noise[:, 1]) * wild
        attitude = [(f"q_{axis}", "%.7f", rows.quaternions[:, k]) for k, axis in enumerate("wxyz")]
        columns = [
            ("t_s", "%g", rows.time_s),
            *attitude,
            ("array_voltage_V", "%.4f", voltage),
            ("array_current_A", "%.5f", current),
            ("array_power_W", "%.5f", voltage * current),
            ("cell_temperature_K", "%.2f", rows.temperature_K),
            ("led_current_A", "%.3f", np.full(count, 0.7)),
        ]
    head = "# as it came from the instrument\n# operator: -\n" if case.is_dirty else ""
    head += ",".join(name for name, _, _ in columns) + "\n"
    line = ",".join(form for _, form, _ in columns) + "\n"
    table = zip(*(column[kept] for _, _, column in columns))
    return head + "".join(line % row for row in table)


def _truth_text(case):
    effects = []
    for effect in case.effects:
        one = {"kind": effect.kind}
        if effect.kind == "interreflection":
            one["node"] = _wall_name(case.believed, effect.index)
        elif effect.index is not None:
            one["index"] = effect.index
        numbers = dict(effect.numbers)
        if "on_body" in numbers:
            one["axes"] = "body" if numbers.pop("on_body") else "lab"
        effects.append(one | numbers)
    truth = {
        "verdict": case.verdict,
        "effects": effects,
        "accept": case.accept,
        "accept_index": case.accept_index,
        "below_detection": case.family == "below",
        "depends_on": case.depends_on,
        "name": case.name,
        "family": case.family,
        "chi2_gain": case.chi2_gain,
        "dirty": case.is_dirty,
        "recordings": [f"{name}.csv.gz" for name, rows in case.recordings.items() if rows.is_first],
        "holdouts": [f"{name}.csv.gz" for name, rows in case.recordings.items() if not rows.is_first],
    }
    return json.dumps(truth, indent=1) + "\n"


def write_case(case, folder):
    """Writes a case; truth.json last."""
    write_file(folder / "experiment.toml", experiment_text(case))
    if case.verdict != "unexplained":
        write_file(folder / "oracle.toml", oracle_text(case))
    write_file(folder / "scene.gltf", _scene(case.believed))
    for name in case.recordings:
        write_gzip(folder / f"{name}.csv.gz", _recording_text(case, name))
    write_file(folder / "truth.json", _truth_text(case))
