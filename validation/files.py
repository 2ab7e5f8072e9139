"""Cases as folders: experiment, recordings, and the truth of what was injected (truth.json).

A case has experiment.toml, run1.csv.gz and run2.csv.gz (or the files in the lists `recordings` and
`holdouts` of the truth), oracle.toml (the experiment with the injected effects and their true numbers),
truth1.toml and truth2.toml (all numbers true, with the initial state of each run) and truth.json. The
latter is written last: a folder that contains it is complete.
"""

import bisect
import dataclasses
import gzip
import json
import math
import os
import pathlib

import numpy as np

from .case import NOMINAL_DRAG, NOMINAL_UNBALANCE
from .draw import Draw
from .errors import InputError
from .instruments import attitude_cells, draw_rows, gyro_cells
from .laws import KINDS
from .motion import Command, Motion, read_one



@dataclasses.dataclass(frozen=True)
class CaseFiles:
    recordings: tuple = ("run1.csv.gz",)
    holdouts: tuple = ("run2.csv.gz",)
    of_light: bool = False


def is_case(folder):
    """Whether a folder contains a truth."""
    return (pathlib.Path(folder) / "truth.json").is_file()


def read_json(path):
    """The object in a JSON file. Raises InputError if there is none."""
    try:
        value = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, "", error.strerror, "a file that can be read") from None
    except (ValueError, UnicodeDecodeError):
        value = None
    if not isinstance(value, dict):
        raise InputError(path, "", "no JSON object", "one")
    return value


def files_of_case(folder):
    """CaseFiles of a case's folder: run1 and run2 for motion, the files listed in its truth for light."""
    truth = read_json(pathlib.Path(folder) / "truth.json")
    lists = {key: tuple(pathlib.PurePath(name).name for name in truth[key] if isinstance(name, str))
             for key in ("recordings", "holdouts") if isinstance(truth.get(key), list)}  # fmt: skip
    return CaseFiles(**lists, of_light=bool(lists))


def cases_in(folder):
    """The cases in a folder, sorted by name. Raises InputError if there is none, or if a file of a case is missing."""
    folder = pathlib.Path(folder)
    cases = sorted(f for f in folder.iterdir() if is_case(f)) if folder.is_dir() else []
    if not cases:
        raise InputError("", "--cases", f"no case in {folder}", "folders with experiment.toml, recordings and truth.json")
    for case in cases:
        files = files_of_case(case)
        for name in ("experiment.toml", *files.recordings, *files.holdouts):
            if not (case / name).is_file():
                raise InputError(case / name, "--cases", "no such file", "a complete case")
    return cases


def write_file(path, data):
    """Writes text or bytes completely or not at all, under a temporary name first. Creates the folder."""
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    part.write_bytes(data if isinstance(data, bytes) else data.encode())
    part.replace(path)


def write_gzip(path, text):
    """Writes a compressed text; equal texts give equal bytes."""
    write_file(path, gzip.compress(text.encode(), mtime=0))


# The experiment.


def _toml(value, digits=12):
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_toml(v, digits) for v in value) + "]"
    return f"{value:.{digits}g}"


def _with_sigma(value, sigma, exact):
    return value if exact else f"{{ value = {value}, sigma = {sigma} }}"


def _effects_text(effects):
    return "".join(f'\n[[disturbance]]\nkind = "{e.kind}"\n'
                   + "".join(f"{key} = {_toml(numbers)}\n" for key, numbers in e.numbers.items())
                   for e in effects)  # fmt: skip


def _platform_text(case):
    world = case.world
    x, y, z = world.moments_kg_m2
    return (f'[platform]\ntopology = "{case.topology}"\nmass_kg = {world.mass_kg:.6g}\n'
            f"inertia_kg_m2 = [[{x:.6g}, 0, 0], [0, {y:.6g}, 0], [0, 0, {z:.6g}]]\n"
            f"\n[environment]\ngravity_m_s2 = {world.gravity_m_s2:.7g}\n"
            f"magnetic_field_T = {_toml(world.magnetic_field_T, 6)}   # lab axes: east, north, up\n"
            f"latitude_deg = {math.degrees(world.latitude_rad):.6g}\n")  # fmt: skip


def experiment_text(case, with_truth):
    """Text of the experiment file. `with_truth` adds the injected effects with their true numbers; the diagnosis is
    compared with the program's result for this experiment (the oracle)."""
    priors, sensors = case.priors, case.sensors
    offset = _with_sigma(_toml(priors.offset_m, 6), _toml(priors.offset_sigma_m, 6), priors.offset_sigma_m[0] == 0.0)
    drag = _with_sigma(f"{priors.drag_N_m_s:.6g}", f"{priors.drag_sigma_N_m_s:.3g}", priors.drag_sigma_N_m_s == 0.0)
    text = ("# The nominal model of this platform and its laboratory.\n" + _platform_text(case)
            + f'\n[[disturbance]]\nkind = "{NOMINAL_UNBALANCE}"\noffset_m = {offset}\n'
            + f'\n[[disturbance]]\nkind = "{NOMINAL_DRAG}"\ncoefficient_N_m_s = {drag}\n')  # fmt: skip
    if with_truth:
        text += _effects_text(case.world.effects)
    text += (f"\n[sensors.camera]\nnoise_arcsec = {_toml(sensors.camera_noise_arcsec, 6)}"
             "   # about lab x, y (out of plane) and z (in plane)\n")  # fmt: skip
    if sensors.has_gyro:
        sigma = priors.gyro_bias_sigma_rad_s
        bias = _with_sigma("[0, 0, 0]", _toml([sigma] * 3, 6), sigma == 0.0)
        text += f"\n[sensors.gyro]\nnoise_rad_s = {sensors.gyro_noise_rad_s:g}\nbias_rad_s = {bias}\n"
    return text


def truth_text(case, index):
    """The experiment with all numbers true and the initial state of run `index`, with which `photorque propagate`
    reproduces that run. None if a law outside the catalogue acts."""
    world, run = case.world, case.runs[index]
    if any(KINDS[e.kind].is_outside for e in world.effects):
        return None
    # The state at time zero: the simulated motion itself starts earlier.
    begin = read_one(world.but(effects=[e for e in world.effects if e.kind != "attitude_latency"]),
                     run.start, [], [0.0])  # fmt: skip
    text = ("# What acted, and how it began.\n" + _platform_text(case)
            + f'\n[[disturbance]]\nkind = "{NOMINAL_UNBALANCE}"\noffset_m = {_toml(world.offset_m, 15)}\n'
            + f'\n[[disturbance]]\nkind = "{NOMINAL_DRAG}"\ncoefficient_N_m_s = {world.drag_N_m_s:.15g}\n'
            + _effects_text(world.effects) + "\n[sensors.camera]\nnoise_arcsec = [0, 0, 0]\n"
            + f"\n[propagate]\nduration_s = {run.duration_s:.9g}\noutput_rate_Hz = {case.sensors.rate_Hz:.9g}\n"
            + f"initial_attitude = {_toml(begin.attitude[:, 0], 15)}\n"
            + f"initial_rate_rad_s = {_toml(begin.rate_rad_s[:, 0], 15)}\n")  # fmt: skip
    return text + (f"commands = 'run{index + 1}.csv.gz'\n" if case.sensors.has_commands else "")


# The recordings.


def _on_rows(commands, times_s, lost):
    """Moves each command to the time of a row that is not lost, so that the log agrees with the applied commands."""
    moved = []
    for command in commands:
        row = bisect.bisect_left(times_s, command.time_s - 1e-9)
        if row < len(times_s):
            lost[row] = False
            command = Command(float(times_s[row]), command.torque_N_m, command.battery_current_A)
        moved.append(command)
    return moved


def recording_text(case, index):
    """Recording of a run as CSV, with noise of the instruments and, for a dirty case, faults."""
    draw, run, sensors = Draw(*case.seed, 100 + index), case.runs[index], case.sensors
    times_s, lost = draw_rows(draw, sensors, run.duration_s)
    commands = _on_rows(run.commands, times_s, lost)
    readings = read_one(case.world, run.start, commands, times_s)
    attitudes, rates = attitude_cells(draw, sensors, readings.camera), gyro_cells(draw, sensors, readings.gyro_rad_s)
    twice = draw.generator.random(times_s.size) < (0.001 if sensors.dirty else 0.0)
    header = "t_s,q_w,q_x,q_y,q_z"
    if sensors.has_gyro:
        header += ",gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s"
    if sensors.has_commands:
        header += ",command_x_N_m,command_y_N_m,command_z_N_m,battery_current_A"
    lines = ["# exported log, tracker and gyro on one clock"] if sensors.dirty else []
    lines.append(header)
    # As many digits as the times need: an error of 50 µs in a pulse is visible after minutes.
    few = not sensors.dirty and math.remainder(1e5 / sensors.rate_Hz, 10.0) == 0.0
    digits, held = 4 if few else 6, 0
    for i, t in enumerate(times_s.tolist()):
        if lost[i]:
            continue
        line = f"{t:.{digits}f},{attitudes[i]}{rates[i]}"
        if sensors.has_commands:
            while held + 1 < len(commands) and commands[held + 1].time_s <= t + 1e-9:
                held += 1
            x, y, z = commands[held].torque_N_m
            line += f",{x:.8e},{y:.8e},{z:.8e},{commands[held].battery_current_A:.4f}"
        lines += [line, line] if twice[i] else [line]
    return "\n".join(lines) + "\n"


# The truth.


def _plain(value):
    return np.asarray(value).tolist() if isinstance(value, (np.ndarray, np.generic, list, tuple)) else value


def truth_json(case):
    world, sensors = case.world, case.sensors
    noise = {name: {"scale": n.scale, "correlation_time_s": n.time_s, "student_degrees": n.student_degrees,
                    "outlier_share": n.outlier_share, "step_sigma": n.step_sigma}
             for name, n in (("camera", sensors.camera), ("gyro", sensors.gyro)) if not n.is_as_stated}  # fmt: skip
    start_s = Motion([world]).start_s
    truth = {
        "verdict": case.verdict,
        "effects": [{"kind": e.kind} | {key: _plain(v) for key, v in e.numbers.items()} for e in world.effects],
        "accept": case.accept, "depends_on": case.depends_on, "name": case.name, "family": case.family,
        "maker": case.maker, "chi2_gain": case.chi2_gain, "dirty": sensors.dirty, "rate_Hz": sensors.rate_Hz,
        "camera_noise_arcsec": list(sensors.camera_noise_arcsec),
        **({"noise": noise} if noise else {}),
        "platform": {"mass": world.mass_kg, "inertia": np.diag(world.moments_kg_m2).tolist(),
                     "offset": _plain(world.offset_m), "drag": world.drag_N_m_s,
                     "gyro_bias": _plain(world.gyro_bias_rad_s)},
        "runs": [{"t0": start_s, "q0": _plain(run.start.attitude), "w0": _plain(run.start.rate_rad_s)}
                 for run in case.runs],
    }  # fmt: skip
    return json.dumps(truth, indent=1) + "\n"


def write_case(case, folder):
    """Writes a drawn case."""
    folder = pathlib.Path(folder)
    write_file(folder / "experiment.toml", experiment_text(case, False))
    write_file(folder / "oracle.toml", experiment_text(case, True))
    for index in range(2):
        write_gzip(folder / f"run{index + 1}.csv.gz", recording_text(case, index))
        truth = truth_text(case, index)
        if truth is not None:
            write_file(folder / f"truth{index + 1}.toml", truth)
    write_file(folder / "truth.json", truth_json(case))


