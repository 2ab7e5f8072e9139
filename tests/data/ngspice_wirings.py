#!/usr/bin/env python3
"""Makes tests/data/electrical/ngspice_wirings.csv: currents of eight wirings under three maps.

    tests/data/ngspice_wirings.py [NGSPICE]

Writes a netlist for each wiring and map, runs ngspice on it and keeps the currents at sixteen
voltages. The cells are the 100 of `electrical/MAP.csv`, taken down one column of the map and up the
next; a wiring is a list of levels, the outermost first, as the key `array.circuit` has it.
"""
import math
import pathlib
import subprocess
import sys
import tempfile

FOLDER = pathlib.Path(__file__).parent / "electrical"
MAPS = ("gauss_edge", "tilt30", "shadow2")
WIRINGS = {
    "series": ["series 100"],
    "half_cut": ["series 5 bypass", "parallel 2", "series 10"],
    "shingled": ["series 2 bypass", "parallel 5", "series 10"],
    "cross_tied": ["series 10", "parallel 10"],
    "bypass_per_cell": ["series 100 bypass"],
    "strings": ["parallel 5", "series 4 bypass", "series 5"],
    "tied_modules": ["series 5", "parallel 4 bypass", "series 5"],
    "nested": ["parallel 2", "series 5 bypass", "parallel 2", "series 5 bypass"],
}
# The cell of PVMismatch, as in tests/photovoltaics/reference.h.
I1, I2, R_S, R_SH = 2.286188161253440e-11, 1.117455042372326e-6, 4.267236774264931e-3, 10.01226369025448
A, V_BR, M = 1.036748445065697e-4, -5.527260068445654, 3.284628553041425
V_T = 298.15 * 1.38064852e-23 / 1.6021766208e-19  # of ngspice 39
POINTS, FINE = 16, 16


def photocurrent(suns):
    isc = 6.3056 * suns
    vd = isc * R_S
    return isc + I1 * math.expm1(vd / V_T) + I2 * math.expm1(vd / (2 * V_T)) + vd / R_SH


def serpentine(size=10):
    return [(i if line % 2 == 0 else size - 1 - i) * size + line for line in range(size) for i in range(size)]


class Netlist:
    def __init__(self, suns):
        self.suns, self.lines, self.nodes = suns, [], 0

    def node(self):
        self.nodes += 1
        return f"n{self.nodes}"

    def cell(self, index, high, low):
        inside, name = self.node(), f"{index}"
        self.lines += [
            f"I{name} {low} {inside} DC {photocurrent(self.suns[index])!r}",
            f"DA{name} {inside} {low} D1",
            f"DB{name} {inside} {low} D2",
            f"B{name} {inside} {low} I=V({inside},{low})/{R_SH!r}*(1+{A!r}*max(1+V({inside},{low})/{-V_BR!r},1e-4)^(-{M!r}))",
            f"R{name} {inside} {high} {R_S!r}",
        ]

    def join(self, cells, levels, high, low):
        if not levels:
            self.cell(cells[0], high, low)
            return
        words = levels[0].split()
        count = int(words[1])
        size = len(cells) // count
        for k in range(count):
            if words[0] == "parallel":
                top, bottom = high, low
            else:
                top = high if k == 0 else bottom
                bottom = low if k == count - 1 else self.node()
            self.join(cells[k * size : (k + 1) * size], levels[1:], top, bottom)
            if "bypass" in words:
                self.lines.append(f"DY{self.nodes}x{len(self.lines)} {bottom} {top} BYPASS")


def cells_in_series(levels):
    return math.prod(int(level.split()[1]) for level in levels if level.startswith("series"))


def currents(program, levels, suns, voltages):
    net = Netlist(suns)
    net.join(serpentine(), levels, "top", "0")
    step = voltages[1]
    deck = [
        "wirings",
        *net.lines,
        f".model D1 D(IS={I1!r} N=1)",
        f".model D2 D(IS={I2!r} N=2)",
        ".model BYPASS D(IS=1e-6 N=1.05 RS=5e-3)",
        "V1 top 0 DC 0",
        ".options temp=25 tnom=25 reltol=1e-10 abstol=1e-14 vntol=1e-11 gmin=1e-20 itl1=2000 itl2=2000",
        ".control",
        "set numdgt=15",
        # Downwards in small steps, so that no cell jumps beyond its breakdown.
        f"dc V1 {voltages[-1]!r} {-0.01 * step!r} {-step / FINE!r}",
        "print v(top) i(v1)",
        ".endc",
        ".end",
    ]
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "deck.cir"
        path.write_text("\n".join(deck) + "\n")
        done = subprocess.run([program, "-b", str(path)], capture_output=True, text=True, check=False)
    rows = [line.split() for line in done.stdout.splitlines() if line[:1].isdigit()]
    found = [(float(row[2]), float(row[3])) for row in rows if len(row) == 4]
    found = found[::FINE][::-1]
    falls = all(b[1] < a[1] for a, b in zip(found, found[1:]))
    if len(found) != len(voltages) or not falls:
        raise SystemExit(f"{levels}: {len(found)} points\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return found


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else "ngspice"
    lines = ["# wiring,map,voltage_V,current_A (ngspice 39; tests/data/ngspice_wirings.py)"]
    for name, levels in WIRINGS.items():
        most = 0.68 * cells_in_series(levels)
        voltages = [most * k / POINTS for k in range(POINTS)]
        for light in MAPS:
            text = (FOLDER / f"{light}.csv").read_text()
            suns = [float(x) for line in text.splitlines() if not line.startswith("#") for x in line.split(",") if x]
            for voltage, current in currents(program, levels, suns, voltages):
                if current > 0:
                    lines.append(f"{name},{light},{voltage:.12g},{current:.12g}")
    (FOLDER / "ngspice_wirings.csv").write_text("\n".join(lines) + "\n")


main()
