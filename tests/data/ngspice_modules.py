#!/usr/bin/env python3
"""Makes tests/data/electrical/ngspice_modules.csv: curves of a module, healthy and with faults.

    tests/data/ngspice_modules.py [NGSPICE]

The module has 60 cells and three bypass diodes with series resistance. Its cells have two diodes, reverse
breakdown (Bishop) and a spread of photocurrent (0.6 %), series resistance (5 %) and shunt (40 %). ngspice
computes each curve; noise and the steps of a 12-bit converter are added.
"""
import math
import pathlib
import random
import subprocess
import sys
import tempfile

FILE = pathlib.Path(__file__).parent / "electrical/ngspice_modules.csv"
CELLS, EVERY, POINTS, FINE, TOP_V = 60, 20, 60, 12, 40.0
A, V_BR, M = 2e-3, 15.0, 3.4
CURRENT_NOISE_A, VOLTAGE_NOISE_V, STEP_A, STEP_V = 3e-3, 1e-3, 12 / 4096, 50 / 4096


def spread_cells():
    draw = random.Random(7)
    return [
        {
            "light_A": 9.2 * (1 + draw.gauss(0, 0.006)),
            "series_ohm": 5e-3 * math.exp(draw.gauss(0, 0.05)),
            "shunt_ohm": 12 * math.exp(draw.gauss(0, 0.4)),
        }
        for _ in range(CELLS)
    ]


def netlist(cells, change):
    lines, node = [], "top"
    for group in range(CELLS // EVERY):
        head = node
        for i in range(group * EVERY, (group + 1) * EVERY):
            c, inside, low = cells[i], f"x{i}", f"n{i}" if i + 1 < CELLS else "end"
            light_A = c["light_A"] * change["light"] * change["shade"].get(i, 1.0)
            lines += [
                f"I{i} {low} {inside} DC {light_A!r}",
                f"DA{i} {inside} {low} D1",
                f"DB{i} {inside} {low} D2",
                f"B{i} {inside} {low} I=V({inside},{low})/{c['shunt_ohm']!r}"
                f"*(1+{A}*max(1+V({inside},{low})/{V_BR},1e-3)^(-{M}))",
                f"R{i} {inside} {node} {c['series_ohm']!r}",
            ]
            node = low
        lines.append(f"RY{group} {head} {node} 5e-3" if group in change["shorted"] else f"DY{group} {node} {head} BYPASS")
    return [*lines, f"RE end 0 {change['contact_ohm']!r}"]


def curve(program, cells, change):
    deck = [
        "module",
        *netlist(cells, change),
        ".model D1 D(IS=3e-10 N=1 EG=1.121 XTI=3)",
        ".model D2 D(IS=1e-6 N=2 EG=1.121 XTI=3)",
        ".model BYPASS D(IS=1e-6 N=1.05 RS=4e-3)",
        "V1 top 0 DC 0",
        f".options temp={change['celsius']} tnom=25 reltol=1e-7 abstol=1e-11 vntol=1e-8 gmin=1e-15 itl1=3000 itl2=3000",
        ".control",
        "set numdgt=12",
        f"dc V1 {TOP_V} -0.001 {-TOP_V / POINTS / FINE!r}",
        "print v(top) i(v1)",
        ".endc",
        ".end",
    ]
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "deck.cir"
        path.write_text("\n".join(deck) + "\n")
        done = subprocess.run([program, "-b", str(path)], capture_output=True, text=True, check=False)
    rows = [line.split() for line in done.stdout.splitlines() if line[:1].isdigit()]
    found = [(float(row[2]), float(row[3])) for row in rows if len(row) == 4][::FINE][::-1]
    if len(found) < POINTS:
        raise SystemExit(f"{len(found)} points\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return [(volts, amperes) for volts, amperes in found if amperes > 0]


HEALTHY = {"light": 1.0, "celsius": 45, "shade": {}, "shorted": (), "contact_ohm": 1e-6}
CHANGES = {
    "reference": {},
    "healthy": {"light": 0.8, "celsius": 40},
    "contact": {"light": 0.93, "celsius": 44, "contact_ohm": 0.12},
    "hot": {"light": 0.95, "celsius": 61},
    "half_shaded": {"light": 0.95, "shade": dict.fromkeys(range(10), 0.5)},
    "shorted_and_contact": {"light": 0.95, "shorted": (0,), "contact_ohm": 0.4},
    "shorted_and_shaded": {"light": 0.95, "shorted": (0,), "shade": {33: 0.5}},
}


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "ngspice"
    lines = ["# curve,voltage_V,current_A (ngspice 39; tests/data/ngspice_modules.py)"]
    draw, cells = random.Random(11), spread_cells()
    for name, change in CHANGES.items():
        for volts, amperes in curve(program, cells, HEALTHY | change):
            read_V = round((volts + draw.gauss(0, VOLTAGE_NOISE_V)) / STEP_V) * STEP_V
            read_A = round((amperes + draw.gauss(0, CURRENT_NOISE_A)) / STEP_A) * STEP_A
            lines.append(f"{name},{read_V:.4f},{read_A:.4f}")
    FILE.write_text("\n".join(lines) + "\n")


main()
