#!/usr/bin/env python3
"""Makes the laboratories of light of this folder; ../README.md says what they are. Needs NumPy and SciPy.

wall: nothing is missing, a wall stands beside the receiver. brighter: every lamp has 0.97 of its stated power."""

import pathlib
import sys

folder = pathlib.Path(__file__).parent
sys.path.insert(0, str(folder.parents[2]))

from validation.light import scenarios, setting  # noqa: E402
from validation.light.effects import Effect  # noqa: E402


def make(name, seed, kind, effects):
    draw = setting.RoundedDraw(seed, 1)
    world, sources, noise, recordings = setting.draw_setting(draw, [kind])
    verdict = "missing_physics" if effects else "consistent"
    scans = {key: rows for key, rows in recordings.items() if rows.kind == "scan"}
    case = scenarios.Case(name, "single", (seed,), verdict, world, sources, noise, scans, False, effects)
    scenarios.write_case(case, folder / name)
    for file in ("oracle.toml", "truth.json"):
        (folder / name / file).unlink()


make("wall", 16, "interreflection", [])
make("brighter", 1, "detector_gain", [Effect("source_power", None, {"factor": 0.97})])
