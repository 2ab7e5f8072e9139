"""Diagnosis of one case by the installed program, in a folder that contains only the files of a user."""

import dataclasses
import gzip
import json
import math
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import threading

import numpy as np

from .errors import InputError
from .files import files_of_case, read_json, write_file
from .information import ARCSECOND_RAD
from .vectors import conjugate, normalised, product, quaternion_of, turn_of

MEDIAN_OF_SQUARED_NORMAL = 0.454936


@dataclasses.dataclass(frozen=True)
class BlindRun:
    program: pathlib.Path
    program_hash: str  # hash of the program; cases diagnosed by this program are not repeated
    replay: bool = True  # also propagate the improved experiment
    longest_s: float = 900.0  # limit of CPU time: for the diagnosis, and for the propagation
    threads: int = 1  # of the diagnosis


@dataclasses.dataclass(frozen=True)
class Result:
    status: int  # exit status; −1: killed or stopped
    processor_s: float  # user and system, of all threads
    errors: str  # text on standard error, at most 4 kB


def run_child(program, arguments, folder, longest_s):
    """Runs a program in a folder without its standard output. The program is stopped after longest_s of CPU time, or
    after thirty times as long by the clock. Raises KeyboardInterrupt if a signal from outside ended it."""
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen([str(program), *arguments], cwd=folder, stdout=subprocess.DEVNULL, stderr=errors)
        whole_s = math.ceil(longest_s)
        try:
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (whole_s, whole_s + 1))
        except ProcessLookupError:
            pass  # it has ended
        timer = threading.Timer(30.0 * longest_s, process.kill)
        timer.start()
        _, wait_status, used = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(wait_status)
        errors.seek(0)
        text = errors.read(4096).decode(errors="replace")
    if process.returncode in (-signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGINT, 128 + signal.SIGTERM):
        raise KeyboardInterrupt  # the benchmark was interrupted: the result does not count
    processor_s = used.ru_utime + used.ru_stime
    if process.returncode < 0:
        is_over = -process.returncode == signal.SIGXCPU or processor_s >= longest_s
        reason = f"stopped after {longest_s:g} s" if is_over else f"signal {-process.returncode}"
        text = f"{reason}\n{text}"
    return Result(max(process.returncode, -1), processor_s, text)


def _attitudes(path):
    """(times, quaternions (4, n)) of the rows of a recording that contain an attitude."""
    data = path.read_bytes()
    text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode()
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    names = lines[0].split(",")
    wanted = ["t_s", "q_w", "q_x", "q_y", "q_z"]
    if not set(wanted) <= set(names):
        return np.zeros(0), np.zeros((4, 0))
    columns = [names.index(name) for name in wanted]
    rows = []
    for line in lines[1:]:
        cells = line.split(",")
        rows.append([float(cells[c]) if cells[c] else math.nan for c in columns])
    numbers = np.array(rows).T
    numbers = numbers[:, np.all(np.isfinite(numbers), axis=0)]
    return numbers[0], normalised(numbers[1:])


def replayed_chi2(recorded, propagated, noise_arcsec):
    """Squared deviation of the attitudes of a propagated motion from the recorded ones, per number, in units of the
    noise. It is the median divided by that of a normal distribution, so that outliers have no influence. NaN
    without attitudes."""
    times_s, read = _attitudes(recorded)
    replay_s, replay = _attitudes(propagated)
    within = times_s <= (replay_s[-1] if replay_s.size else -math.inf)
    times_s, read = times_s[within], read[:, within]
    if times_s.size == 0:
        return math.nan
    after = np.clip(np.searchsorted(replay_s, times_s), 1, replay_s.size - 1)
    before = after - 1
    # The rate is assumed constant between two rows.
    part = np.clip((times_s - replay_s[before]) / (replay_s[after] - replay_s[before]), 0.0, 1.0)
    turn = turn_of(product(replay[:, after], conjugate(replay[:, before])))
    there = product(quaternion_of(part * turn), replay[:, before])
    off = turn_of(product(read, conjugate(there))) / (ARCSECOND_RAD * np.asarray(noise_arcsec))[:, np.newaxis]
    return float(np.mean(np.median(off**2, axis=1)) / MEDIAN_OF_SQUARED_NORMAL)


def found_noise_arcsec(diagnosis, stated):
    """Noise of the camera about lab x, y, z: from the diagnosis if it found one, otherwise as stated."""
    noise = list(stated)
    names = ["attitude_x_arcsec", "attitude_y_arcsec", "attitude_z_arcsec"]
    for finding in diagnosis.get("instruments", []):
        is_level = finding.get("what") == "noise_level" and isinstance(finding.get("value"), (int, float))
        if is_level and finding.get("channel") in names:
            noise[names.index(finding["channel"])] = finding["value"]
    return noise


def recorded_case(case):
    """(camera noise about lab x, y, z [arcsec], rows per second), as stored with the truth. Cases from other sources
    use typical values."""
    path = pathlib.Path(case) / "truth.json"
    truth = read_json(path)
    noise, rate_Hz = truth.get("camera_noise_arcsec", [37.0, 37.0, 12.0]), truth.get("rate_Hz", 20.0)
    if not (isinstance(noise, list) and len(noise) == 3 and all(isinstance(x, (int, float)) for x in noise)):
        raise InputError(path, "camera_noise_arcsec", "something else", "three numbers")
    if not isinstance(rate_Hz, (int, float)):
        raise InputError(path, "rate_Hz", "something else", "a number")
    return noise, rate_Hz


def _replay(case, blind, how):
    """Propagates the improved experiment and compares it with the recording."""
    if not (blind / "diagnosis" / "improved.toml").exists():
        return {}
    noise, rate_Hz = recorded_case(case)
    # Camera noise is off, because the recording already contains it. The output rate is so high that the angular rate
    # is nearly constant between two rows.
    words = ["propagate", "diagnosis/improved.toml", "--out", "replay", "--quiet", "--threads", "1"]
    words += ["--set", "sensors.camera.noise_arcsec=[0, 0, 0]"]
    words += ["--set", f"propagate.output_rate_Hz={10.0 * rate_Hz:.6f}"]
    result = run_child(how.program, words, blind, how.longest_s)
    replay = {"replay_status": result.status}
    if result.status == 0:
        found = found_noise_arcsec(read_json(blind / "diagnosis" / "diagnosis.json"), noise)
        replay["replay_chi2"] = replayed_chi2(blind / "run1.csv.gz", blind / "replay" / "recording.csv", found)
    else:
        write_file(blind / "diagnosis" / "replay_error.txt", result.errors)
    shutil.rmtree(blind / "replay", ignore_errors=True)
    return replay


def diagnose_blind(case, experiment, blind, how):
    """Diagnoses `experiment` (a file of the folder `case`) in the folder `blind`. It writes there the answer
    (diagnosis/), times and exit status (diagnosis/runs.json, error.txt), and how well the improved experiment
    reproduces the recording."""
    case, blind = pathlib.Path(case), pathlib.Path(blind)
    out, stamp = blind / "diagnosis", blind / "done.txt"
    if stamp.exists() and stamp.read_text() == how.program_hash:
        return
    shutil.rmtree(blind, ignore_errors=True)
    out.mkdir(parents=True)
    shutil.copyfile(case / experiment, blind / "experiment.toml")
    files = files_of_case(case)
    words, names = ["diagnose", "experiment.toml"], [*files.recordings, *files.holdouts]
    for option, group in (("--recording", files.recordings), ("--holdout", files.holdouts)):
        for name in group:
            words += [option, name]
    names += ["scene.gltf"] if (case / "scene.gltf").exists() else []
    for name in names:
        shutil.copyfile(case / name, blind / name)
    words += ["--out", "diagnosis", "--quiet", "--threads", str(how.threads)]
    result = run_child(how.program, words, blind, how.longest_s)
    out.mkdir(exist_ok=True)
    runs = {"processor_s": result.processor_s, "exit_status": result.status}
    if how.replay and result.status == 0 and not files.of_light:
        runs |= _replay(case, blind, how)
    write_file(out / "runs.json", json.dumps(runs, indent=1).replace("NaN", "null") + "\n")
    if result.status != 0 or result.errors:
        write_file(out / "error.txt", f"exit {result.status}: {result.errors}")
    for name in names:
        (blind / name).unlink()
    write_file(stamp, how.program_hash)
