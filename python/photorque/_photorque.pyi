from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Path = str | PathLike[str]
Progress = Callable[[str, float], object] | None
Torque = Callable[[Array, Array, Array], npt.ArrayLike]
Emit = Callable[[Array], tuple[npt.ArrayLike, npt.ArrayLike]]
Log = Callable[[str], object] | None

__version__: str
git_hash: str

class InputError(ValueError): ...
class NumericalError(ArithmeticError): ...

class Experiment:
    def __init__(
        self,
        source: Path | Mapping[str, Any],
        *,
        keys: Mapping[str, Any] = ...,
        folder: Path | None = None,
        name: str = "experiment",
    ) -> None: ...
    def with_keys(self, keys: Mapping[str, Any]) -> Experiment: ...
    def to_dict(self) -> dict[str, Any]: ...
    path: Final[str]
    text: Final[str]
    changes: Final[list[str]]

class Estimate:
    value: Final[float]
    standard_error: Final[float]
    def __float__(self) -> float: ...

class Table:
    name: Final[str]
    title: Final[str]
    def keys(self) -> list[str]: ...
    def to_dict(self) -> dict[str, Any]: ...
    def to_pandas(self) -> Any: ...
    def __getitem__(self, column: str) -> Any: ...
    def __contains__(self, column: str) -> bool: ...
    def __len__(self) -> int: ...

class Map:
    name: Final[str]
    title: Final[str]
    unit: Final[str]
    x_label: Final[str]
    y_label: Final[str]
    value: Final[Array]
    standard_error: Final[Array | None]
    extent: Final[tuple[float, float, float, float]]
    is_signed: Final[bool]
    has_equal_scale: Final[bool]
    def plot(self, axes: Any = None) -> Any: ...
    def to_xarray(self) -> Any: ...

class Curve:
    label: Final[str]
    style: Final[str]
    x: Final[Array]
    y: Final[Array]
    y_error: Final[Array | None]

class Panel:
    y_label: Final[str]
    y_log: Final[bool]
    curves: Final[list[Curve]]
    levels: Final[list[float]]

class Plot:
    name: Final[str]
    title: Final[str]
    x_label: Final[str]
    x_log: Final[bool]
    panels: Final[list[Panel]]
    def plot(self, axes: Any = None) -> Any: ...

class FluxMap:
    irradiance_W_m2: Final[Array]
    irradiance_standard_error_W_m2: Final[Array]
    absorbed_W_m2: Final[Array]
    absorbed_standard_error_W_m2: Final[Array]
    power_W: Final[Estimate]
    absorbed_power_W: Final[Estimate]
    area_m2: Final[Array]
    extent: Final[tuple[float, float, float, float]]

# Attributes of every run.
class _Result:
    figures: Final[dict[str, Estimate]]
    tables: Final[dict[str, Table]]
    maps: Final[dict[str, Map]]
    plots: Final[dict[str, Plot]]
    def plot(self, name: str | None = None, axes: Any = None) -> Any: ...
    warnings: Final[list[str]]
    provenance: Final[dict[str, Any]]
    summary_json: Final[str]
    def write(self, folder: Path, formats: Sequence[str] = ()) -> list[str]: ...

class Lamp:
    def __init__(
        self,
        emit: Emit,
        *,
        power_W: float,
        wavelength_nm: float,
        position_m: npt.ArrayLike,
        direction: npt.ArrayLike | None = None,
        aim_m: npt.ArrayLike | None = None,
        spectral_fwhm_nm: float = 0.0,
        name: str = "lamp",
    ) -> None: ...
    name: Final[str]
    power_W: Final[float]

class Render:
    pixels: Final[npt.NDArray[np.uint8]]
    title: Final[str]
    provenance: Final[dict[str, Any]]
    def write(self, folder: Path) -> str: ...

class Trace(_Result):
    flux_maps: Final[dict[str, FluxMap]]
    force_body_N: Final[Array]
    force_standard_error_N: Final[Array]
    torque_body_N_m: Final[Array]
    torque_standard_error_N_m: Final[Array]
    rays: Final[int]
    def write_page(self, path: Path) -> str: ...

class Power(Trace):
    curve: Final[Table]
    maxima: Final[Table]
    power_W: Final[Estimate]
    voltage_V: Final[Estimate]
    current_A: Final[Estimate]
    cell_light_W: Final[Array]
    cell_voltage_V: Final[Array]

class TorqueMap(_Result):
    angles: Final[str]
    polar_rad: Final[Array]
    around_rad: Final[Array]
    force_body_N: Final[Array]
    force_standard_error_N: Final[Array]
    torque_body_N_m: Final[Array]
    torque_standard_error_N_m: Final[Array]
    def at(self, polar_rad: float, around_rad: float) -> tuple[Array, Array]: ...
    def write_page(self, path: Path) -> str: ...

class Motion(_Result):
    history: Final[Table]
    recording: Final[dict[str, Array]]
    events: Final[list[tuple[str, float]]]
    time_s: Final[Array]
    attitude_wxyz: Final[Array]
    rate_body_rad_s: Final[Array]
    charge_drawn_C: Final[Array]
    def write_page(self, path: Path) -> str: ...

class BudgetEntry:
    kind: Final[str]
    name: Final[str]
    torque_body_N_m: Final[Array]
    angle_after_minute_rad: Final[float]
    angle_after_hour_rad: Final[float]
    angle_after_day_rad: Final[float]

class Budget(_Result):
    entries: Final[list[BudgetEntry]]

class Balance(_Result):
    offset_body_m: Final[Array]
    standard_error_m: Final[Array]

class CellFit(_Result): ...

class Camera(_Result):
    images_per_s: Final[float]

class AttitudeEstimate(_Result):
    def smoothed(self, recording: int = 0) -> dict[str, Array]: ...
    def filtered(self, recording: int = 0) -> dict[str, Array]: ...
    unseen: Final[list[str]]

class CheckReport:
    commands: Final[dict[str, str]]
    mistakes: Final[list[str]]
    notes: Final[list[str]]

class Effect:
    kind: Final[str]
    probability: Final[float]
    explanation: Final[str]
    indistinguishable_from: Final[list[str]]
    parameters: Final[dict[str, dict[str, Array]]]

class Diagnosis:
    verdict: Final[str]
    confidence: Final[float]
    sentence: Final[str]
    effects: Final[list[Effect]]
    warnings: Final[list[str]]
    chi2_per_sample_before: Final[float]
    chi2_per_sample_after: Final[float]
    provenance: Final[dict[str, Any]]
    json: Final[str]
    def improved(self, folder: Path = ".") -> str: ...
    report_html: Final[str]
    def write_page(self, path: Path) -> str: ...
    def write(self, folder: Path) -> None: ...

def trace(
    experiment: Experiment,
    *,
    threads: int = 0,
    seed: int | None = None,
    target_error: float | None = None,
    max_time_s: float | None = None,
    lamps: Iterable[Lamp] = ...,
    progress: Progress = None,
    log: Log = None,
) -> Trace: ...
def power(
    experiment: Experiment,
    *,
    threads: int = 0,
    seed: int | None = None,
    target_error: float | None = None,
    max_time_s: float | None = None,
    lamps: Iterable[Lamp] = ...,
    progress: Progress = None,
    log: Log = None,
) -> Power: ...
def render(
    experiment: Experiment,
    *,
    threads: int = 0,
    seed: int | None = None,
    target_error: float | None = None,
    max_time_s: float | None = None,
    lamps: Iterable[Lamp] = ...,
    progress: Progress = None,
    log: Log = None,
) -> Render: ...
def torque_map(
    experiment: Experiment,
    *,
    threads: int = 0,
    seed: int | None = None,
    lamps: Iterable[Lamp] = ...,
    page: bool = False,
    progress: Progress = None,
    log: Log = None,
) -> TorqueMap: ...
def propagate(
    experiment: Experiment,
    *,
    threads: int = 0,
    seed: int | None = None,
    torques: Mapping[str, Torque] = ...,
    progress: Progress = None,
    log: Log = None,
) -> Motion: ...
def budget(experiment: Experiment) -> Budget: ...
def balance(experiment: Experiment, recording: Path) -> Balance: ...
def diagnose(
    experiment: Experiment,
    recordings: Sequence[Path],
    *,
    holdouts: Sequence[Path] = ...,
    threads: int = 0,
    log: Log = None,
) -> Diagnosis: ...
def check(experiment: Experiment) -> CheckReport: ...
def fit_cell(experiment: Experiment, *, log: Log = None) -> CellFit: ...
def camera(
    experiment: Experiment, *, threads: int = 0, progress: Progress = None, log: Log = None
) -> Camera: ...
def estimate(
    experiment: Experiment,
    recordings: Sequence[Path] = ...,
    *,
    truth: Path | None = None,
    threads: int = 0,
    seed: int | None = None,
    progress: Progress = None,
    log: Log = None,
) -> AttitudeEstimate: ...
