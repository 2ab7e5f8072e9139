"""The array: one-diode cells in strings, with ideal bypass and blocking diodes.

A cell obeys  I = L - I0 (exp(x / a) - 1) - G x,  V = x - I Rs,  a = n k T / q  (docs/photovoltaic.md). Its
junction voltage x at a current I is an explicit function, with Wright's omega function omega + ln omega = z:

    x = (L - I + I0) / G - a omega(z),   z = (L - I + I0) / (a G) + ln(I0 / (a G))

(after A. Jain and A. Kapoor, Sol. Energy Mater. Sol. Cells 81 (2004) 269). The voltage of the cells between
two bypass diodes is at least -drop_V. Strings are in parallel.
"""

import dataclasses
import functools

import numpy as np
from scipy import constants, special

FAR_A = 1000.0  # reverse current beyond all currents in an array
GRID = 400
GOLDEN = 0.5 * (5.0**0.5 - 1.0)


@dataclasses.dataclass(frozen=True)
class Cell:
    """Parameters of one cell at its reference temperature."""

    saturation_A: float = 1e-11
    ideality: float = 1.0
    series_ohm: float = 0.01
    shunt_ohm: float = 100.0
    gap_eV: float = 1.121
    gap_slope_per_K: float = -0.0002677
    photocurrent_slope_per_K: float = 0.0004
    reference_K: float = 298.15


@dataclasses.dataclass
class Circuit:
    """The array and its changes by effects. Cell numbers are row * columns + column."""

    columns: int = 1
    rows: int = 1
    strings: int = 1
    bypass_every: int = 1
    along_columns: bool = True  # direction of the serpentine
    blocking: bool = False
    drop_V: float = 0.5
    efficiency: float = 0.9  # electrons per photon
    wavelength_m: float = 730e-9
    cell_area_m2: float = 0.0025
    cell: Cell = Cell()
    cell_current: np.ndarray = None  # fraction of a cell's light that is converted to current
    cell_light: np.ndarray = None  # fraction of the light that reaches a cell
    string_open: np.ndarray = None
    bypass_shorted: np.ndarray = None
    soiling: float = 1.0
    series_ohm: float = 0.0
    shunt_S: float = 0.0
    photocurrent_per_K: float = 0.0
    voltage_V_per_K: float = 0.0

    def __post_init__(self):
        for name, count, value in (
            ("cell_current", self.cells, 1.0),
            ("cell_light", self.cells, 1.0),
            ("string_open", self.strings, False),
            ("bypass_shorted", self.bypasses, False),
        ):
            if getattr(self, name) is None:
                setattr(self, name, np.full(count, value))

    @property
    def cells(self):
        return self.columns * self.rows

    @property
    def bypasses(self):
        """Number of bypass diodes of all strings."""
        return self.strings * -(-(self.cells // self.strings) // self.bypass_every)

    def copy(self):
        arrays = ("cell_current", "cell_light", "string_open", "bypass_shorted")
        return dataclasses.replace(self, **{name: getattr(self, name).copy() for name in arrays})

    def serpentine(self):
        """Numbers of the cells in the order of the current; every other line runs backwards."""
        numbers = np.arange(self.cells).reshape(self.rows, self.columns)
        lines = numbers.T.copy() if self.along_columns else numbers
        lines[1::2] = lines[1::2, ::-1].copy()
        return lines.ravel()


def _crossing(low, high, function):
    """Zeros of falling functions of arrays, computed together by the method of C. J. F. Ridders (1979), which
    straightens exponentials and keeps the bracket. If a function is not positive at `low`, or not negative at
    `high`, the result is that end."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    f_low, f_high = function(low), function(high)
    x = np.where(f_low <= 0.0, low, high)
    done = (f_low <= 0.0) | (f_high >= 0.0)
    tolerance = 1e-12 * (high - low)
    for _ in range(100):
        middle = 0.5 * (low + high)
        f_middle = function(middle)
        root = np.sqrt(np.maximum(f_middle**2 - f_low * f_high, 1e-300))
        next_x = np.where(done, x, np.clip(middle + (middle - low) * f_middle / root, low, high))
        f_next = function(next_x)
        settled = (np.abs(next_x - x) <= tolerance) | (f_next == 0.0) | (high - low <= tolerance)
        x, done = next_x, done | settled
        if done.all():
            break
        # The tightest bracket that the two new points allow.
        for point, value in ((middle, f_middle), (next_x, f_next)):
            raises, lowers = (value > 0.0) & (point > low), (value <= 0.0) & (point < high)
            low, f_low = np.where(raises, point, low), np.where(raises, value, f_low)
            high, f_high = np.where(lowers, point, high), np.where(lowers, value, f_high)
    return x


class LitCircuit:
    """An array with light on its cells, for several conditions: the first axis of every array."""

    def __init__(self, circuit, light_W_m2, temperature_K):
        """`light_W_m2` (conditions, cells); `temperature_K` (conditions)."""
        cell = circuit.cell
        light = np.atleast_2d(light_W_m2)
        warm_K = np.broadcast_to(np.asarray(temperature_K, dtype=float), len(light)) - cell.reference_K
        kelvin = cell.reference_K + warm_K
        per_volt = constants.e / constants.k
        gap_eV = cell.gap_eV * (1.0 + cell.gap_slope_per_K * warm_K)
        self.circuit = circuit
        self.slope_V = cell.ideality * kelvin / per_volt
        self.saturation_A = (
            cell.saturation_A
            * (kelvin / cell.reference_K) ** 3
            * np.exp(per_volt * (cell.gap_eV / cell.reference_K - gap_eV / kelvin))
        )
        self.conductance_S = 1.0 / cell.shunt_ohm + circuit.shunt_S
        self.extra_V = circuit.voltage_V_per_K * warm_K
        per_watt = circuit.efficiency * circuit.wavelength_m * constants.e / (constants.h * constants.c)
        warmth = 1.0 + (cell.photocurrent_slope_per_K + circuit.photocurrent_per_K) * warm_K
        factors = circuit.cell_light * circuit.cell_current * circuit.soiling * circuit.cell_area_m2 * per_watt
        chain = (light * factors * warmth[:, None])[:, circuit.serpentine()]
        self.largest_A = chain.max(axis=1)
        self.strings = []
        diode = 0
        for string in np.split(chain, circuit.strings, axis=1):
            groups = []
            for first in range(0, string.shape[1], circuit.bypass_every):
                if not circuit.bypass_shorted[diode]:
                    groups.append(string[:, first : first + circuit.bypass_every])
                diode += 1
            self.strings.append(groups)
        self.carrying = [s for s in range(circuit.strings) if not circuit.string_open[s]]

    def _cell_voltage(self, photocurrent_A, current_A):
        """Voltage of cells: `photocurrent_A` (conditions, cells), `current_A` (conditions, n)."""
        a, i0 = self.slope_V[:, None, None], self.saturation_A[:, None, None]
        g = self.conductance_S
        left = photocurrent_A[:, :, None] - current_A[:, None, :] + i0
        x = left / g - a * special.wrightomega(left / (a * g) + np.log(i0 / (a * g)))
        diode = i0 * np.exp(x / a)
        x = x + (left - diode - g * x) / (diode / a + g)  # removes the rounding error of the difference
        return x - current_A[:, None, :] * self.circuit.cell.series_ohm + self.extra_V[:, None, None]

    def _string_voltage(self, string, current_A):
        """Voltage of a string at currents (conditions, n)."""
        voltage = np.zeros_like(current_A)
        for group in self.strings[string]:
            voltage += np.maximum(self._cell_voltage(group, current_A).sum(axis=1), -self.circuit.drop_V)
        return voltage

    def _solve_current(self, voltage_V, voltage_at):
        """Currents (conditions, n) at which a falling `voltage_at` equals `voltage_V`."""
        high = np.broadcast_to(1.5 * self.largest_A[:, None] + 1.0, voltage_V.shape)
        if self.circuit.blocking:
            low = np.zeros_like(high)
        else:
            low = np.where(voltage_at(-0.3 * high) > voltage_V, -0.3 * high, -FAR_A)
        return _crossing(low, high, lambda current: voltage_at(current) - voltage_V)

    def _parallel(self, voltage_V):
        """Total current of all strings at a common voltage."""
        return sum(self._solve_current(voltage_V, functools.partial(self._string_voltage, s)) for s in self.carrying)

    def _at(self, parameter):
        """Voltage and current at the terminals. The parameter is the current for a single string, the voltage for
        several strings."""
        if len(self.carrying) == 1:
            voltage, current = self._string_voltage(self.carrying[0], parameter), parameter
        else:
            voltage, current = parameter, self._parallel(parameter)
        return voltage - current * self.circuit.series_ohm, current

    def open_voltage_V(self):
        """Open-circuit voltage of every condition."""
        none = np.zeros((len(self.largest_A), 1))
        if not self.carrying:
            return none[:, 0]
        most = np.max([self._string_voltage(s, none) for s in self.carrying], axis=0)
        if len(self.carrying) > 1:
            most = _crossing(none, np.maximum(most, 1e-9), self._parallel)
        return np.maximum(most[:, 0], 0.0)

    def current_A(self, voltage_V):
        """Current at terminal voltages (conditions, n)."""
        voltage = np.atleast_2d(np.asarray(voltage_V, dtype=float))
        if not self.carrying:
            return np.zeros_like(voltage)
        if len(self.carrying) == 1:
            return self._solve_current(voltage, lambda current: self._at(current)[0])
        if self.circuit.series_ohm == 0.0:
            return self._parallel(voltage)
        ends = np.full(voltage.shape, -60.0), np.full(voltage.shape, 120.0)
        return self._parallel(_crossing(*ends, lambda inner: voltage - self._at(inner)[0]))

    def _coarse(self):
        """Parameters of `_at` on a grid (conditions, GRID + 1) and the power there, for the search for maxima."""
        share = np.linspace(0.0, 1.0, GRID + 1)
        if len(self.carrying) == 1:
            grid = 1.001 * self.largest_A[:, None] * share
            voltage, current = self._at(grid)
            return grid, voltage * current
        grid = self.open_voltage_V()[:, None] * share
        low = 0.0 if self.circuit.blocking else -len(self.carrying)
        trial = self.largest_A[:, None] * np.linspace(low, 1.001, 2 * GRID)
        total = np.zeros_like(grid)
        for s in self.carrying:
            voltage = self._string_voltage(s, trial)
            for k in range(len(grid)):
                total[k] += np.interp(grid[k], voltage[k, ::-1], trial[k, ::-1])
        return grid, (grid - total * self.circuit.series_ohm) * total

    def maxima(self):
        """For every condition a list of (voltage, current) at the local maxima of the power, highest first."""
        found = [[] for _ in self.largest_A]
        if not self.carrying:
            return found
        grid, power = self._coarse()
        inner = power[:, 1:-1]
        rows, columns = np.nonzero((inner > 0.0) & (inner >= power[:, :-2]) & (inner >= power[:, 2:]))
        part = self._some(rows)

        def power_at(x):
            voltage, current = part._at(x[:, None])
            return (voltage * current)[:, 0]

        # A grid of interpolated powers may miss the highest point by some steps.
        wide = 0 if len(self.carrying) == 1 else 2
        a, b = grid[rows, np.maximum(columns - wide, 0)], grid[rows, np.minimum(columns + 2 + wide, GRID)]
        c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
        at_c, at_d = power_at(c), power_at(d)
        for _ in range(40):
            left = at_c > at_d
            a, b = np.where(left, a, c), np.where(left, d, b)
            x = np.where(left, b - GOLDEN * (b - a), a + GOLDEN * (b - a))
            at_x = power_at(x)
            c, at_c, d, at_d = (
                np.where(left, x, d),
                np.where(left, at_x, at_d),
                np.where(left, c, x),
                np.where(left, at_c, at_x),
            )
        voltage, current = part._at((0.5 * (a + b))[:, None])
        for row, v, i in zip(rows, voltage[:, 0], current[:, 0]):
            found[row].append((v, i))
        for points in found:
            points.sort(key=lambda p: -p[0] * p[1])
        return found

    def _some(self, conditions):
        """The circuit for some of its conditions, by their numbers in order; numbers may repeat."""
        part = LitCircuit.__new__(LitCircuit)
        part.__dict__.update(self.__dict__)
        for name in ("slope_V", "saturation_A", "extra_V", "largest_A"):
            setattr(part, name, getattr(self, name)[conditions])
        part.strings = [[group[conditions] for group in groups] for groups in self.strings]
        return part
