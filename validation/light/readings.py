"""Readings of instruments in a world: scans of a photodiode, current-voltage sweeps, runs with a tracker."""

import dataclasses

import numpy as np
from scipy.spatial.transform import Rotation

from .circuit import Circuit, LitCircuit
from .illumination import Cells, Points, Room

RUN_ORDER = 5  # of the Gauss rule over a cell in a run, which has many attitudes


@dataclasses.dataclass
class World:
    """All inputs of the readings."""

    room: Room
    circuit: Circuit
    detector_gain: float = 1.0
    droop_depth: float = 0.0
    droop_time_s: float = 1.0
    trapped_s: list = dataclasses.field(default_factory=list)  # intervals of the first run
    # Laws outside the catalogue: functions of (u_m, v_m, t_s) that multiply the readings of a scan or the light of a
    # run.
    laws: list = dataclasses.field(default_factory=list)

    def copy(self):
        return dataclasses.replace(
            self,
            room=self.room.copy(),
            circuit=self.circuit.copy(),
            trapped_s=list(self.trapped_s),
            laws=list(self.laws),
        )

    def law(self, u_m, v_m, t_s):
        """Product of the laws outside the catalogue."""
        factor = 1.0
        for law in self.laws:
            factor = factor * law(u_m, v_m, t_s)
        return factor


@dataclasses.dataclass(frozen=True)
class Noise:
    """Standard deviations stated by the experiment."""

    irradiance_W_m2: float = 4.0
    relative: float = 0.01
    voltage_V: float = 0.006
    current_A: float = 0.004


@dataclasses.dataclass
class Rows:
    """Attitude of the plate and settings, row by row. Columns that a kind does not have are empty."""

    kind: str  # "scan", "sweep" or "run"
    is_first: bool  # fitted; otherwise held out
    quaternions: np.ndarray  # (n, 4) lab from body, w first
    tilt_deg: np.ndarray = None
    heading_deg: np.ndarray = None
    u_m: np.ndarray = None
    v_m: np.ndarray = None
    voltage_V: np.ndarray = None
    time_s: np.ndarray = None
    temperature_K: np.ndarray = None
    sweep: np.ndarray = None

    def __len__(self):
        return len(self.quaternions)

    def take(self, rows):
        """Some of the rows."""
        columns = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        taken = {name: c[rows] for name, c in columns.items() if isinstance(c, np.ndarray)}
        return dataclasses.replace(self, **taken)

    def matrices(self):
        """Rotation matrices lab from body, (n, 3, 3)."""
        return Rotation.from_quat(self.quaternions[:, [1, 2, 3, 0]]).as_matrix()

    def blocks(self):
        """Slices of successive rows at one attitude and temperature."""
        keys = self.quaternions
        if self.temperature_K is not None:
            keys = np.column_stack([keys, self.temperature_K])
        edges = np.flatnonzero((np.diff(keys, axis=0) != 0.0).any(axis=1)) + 1
        return [slice(a, b) for a, b in zip([0, *edges], [*edges, len(keys)])]


def quaternion_at(tilt_deg, heading_deg):
    """Attitude (w, x, y, z) of a plate tilted towards the heading."""
    heading = np.radians(heading_deg)
    turn = np.radians(tilt_deg) * np.array([-np.sin(heading), np.cos(heading), 0.0])
    return np.roll(Rotation.from_rotvec(turn).as_quat(), 1)


def light_on_cells(world, attitude):
    """Mean irradiance [W/m²] on every cell at a rotation matrix lab from body."""
    places = Cells(world.room.plate, world.circuit.columns, world.circuit.rows)
    return world.room.irradiance(places, attitude)


def _cell_at(world, u_m, v_m):
    plate, circuit = world.room.plate, world.circuit
    column = (u_m - plate.u_low_m) / (plate.u_high_m - plate.u_low_m) * circuit.columns
    row = (v_m - plate.v_low_m) / (plate.v_high_m - plate.v_low_m) * circuit.rows
    inside = [np.clip(x.astype(int), 0, n - 1) for x, n in ((column, circuit.columns), (row, circuit.rows))]
    return inside[1] * circuit.columns + inside[0]


def _read_scan(world, rows):
    readings = np.empty(len(rows))
    matrices = rows.matrices()
    for block in rows.blocks():
        u, v = rows.u_m[block], rows.v_m[block]
        light = world.room.irradiance(Points(world.room.plate, u, v), matrices[block.start])
        shade = world.circuit.cell_light[_cell_at(world, u, v)]
        readings[block] = light * shade * world.detector_gain * world.law(u, v, 0.0)
    return readings


def _read_sweep(world, rows):
    readings = np.empty(len(rows))
    matrices = rows.matrices()
    for block in rows.blocks():
        light = light_on_cells(world, matrices[block.start])
        lit = LitCircuit(world.circuit, light, rows.temperature_K[block.start])
        readings[block] = lit.current_A(rows.voltage_V[block])[0]
    return readings


def _read_run(world, rows):
    """Voltage and current (n, 2) of the maximum that the tracker holds."""
    places = Cells(world.room.plate, world.circuit.columns, world.circuit.rows, RUN_ORDER)
    light = np.array([world.room.irradiance(places, matrix) for matrix in rows.matrices()])
    t = rows.time_s
    lamps = (1.0 - world.droop_depth * (1.0 - np.exp(-t / world.droop_time_s))) * world.law(0.0, 0.0, t)
    ambient = world.room.ambient_W_m2
    light = (light - ambient) * np.broadcast_to(lamps, len(rows))[:, None] + ambient
    readings = np.zeros((len(rows), 2))
    for k, maxima in enumerate(LitCircuit(world.circuit, light, rows.temperature_K).maxima()):
        trapped = rows.is_first and any(start <= t[k] <= end for start, end in world.trapped_s)
        if maxima:
            readings[k] = maxima[1 if trapped and len(maxima) > 1 else 0]
    return readings


def read(world, rows):
    """Readings without noise: irradiance of a scan (n), current of a sweep (n), voltage and current of a
    run (n, 2)."""
    return {"scan": _read_scan, "sweep": _read_sweep, "run": _read_run}[rows.kind](world, rows)


def errors(world, rows, noise, readings):
    """Standard deviation of every reading; for the current of a sweep it includes the error of the voltage."""
    if rows.kind == "scan":
        return np.hypot(noise.irradiance_W_m2, noise.relative * readings)
    if rows.kind == "run":
        return np.broadcast_to([noise.voltage_V, noise.current_A], readings.shape)
    step_V = 1e-3
    slope = (read(world, dataclasses.replace(rows, voltage_V=rows.voltage_V + step_V)) - readings) / step_V
    return np.hypot(noise.current_A, slope * noise.voltage_V)
