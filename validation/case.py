"""A case: a platform, two runs, the injected effects, and the expected answer."""

import dataclasses
import math

import numpy as np

from .motion import World

# Kinds in the nominal model of every case; their numbers are in World and Priors.
NOMINAL_UNBALANCE, NOMINAL_DRAG, NOMINAL_GYRO_BIAS = "static_unbalance", "bearing_drag", "gyro_bias"


@dataclasses.dataclass
class Noise:
    """Deviation of an instrument's errors from independent normal errors of the stated level."""

    scale: float = 1.0  # level, relative to the stated one
    time_s: float = 0.0  # correlation time in exp(−t/time); 0: uncorrelated
    student_degrees: int = 0  # degrees of freedom of Student's t, scaled to the level: 3, 4, …; 0: normal
    outlier_share: float = 0.0  # fraction of readings that are outliers of five times the level
    step_sigma: float = 0.0  # quantisation step, in units of the stated level; 0: none

    @property
    def is_as_stated(self):
        return self == Noise()


@dataclasses.dataclass
class Sensors:
    rate_Hz: float = 10.0  # of rows and gyro
    camera_every: int = 1  # rows between two attitudes
    camera_noise_arcsec: tuple = (37.0, 37.0, 12.0)
    gyro_noise_rad_s: float = 2e-4
    camera: Noise = dataclasses.field(default_factory=Noise)
    gyro: Noise = dataclasses.field(default_factory=Noise)
    has_gyro: bool = True
    has_commands: bool = True
    dirty: bool = False  # drop-outs, gaps, outliers, jittered times, sign flips, a preamble


@dataclasses.dataclass
class Priors:
    """Statements of the experiment file; sigma 0 means exact."""

    offset_m: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    offset_sigma_m: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    drag_N_m_s: float = 0.0
    drag_sigma_N_m_s: float = 0.0
    gyro_bias_sigma_rad_s: float = 0.0


@dataclasses.dataclass
class Run:
    start: object  # motion.Start
    commands: list
    duration_s: float


@dataclasses.dataclass
class Case:
    name: str = ""  # "magnetic_dipole_02"
    family: str = ""  # none | single | pair | outside | triple | known_unknown | noise_none | noise_effect
    maker: str = ""  # of platform and motion: "first", or "second: …" with its kind of motion
    topology: str = ""
    seed: tuple = ()  # of sampling times and instruments
    world: World = dataclasses.field(default_factory=World)
    priors: Priors = dataclasses.field(default_factory=Priors)
    sensors: Sensors = dataclasses.field(default_factory=Sensors)
    runs: list = dataclasses.field(default_factory=list)  # recording and hold-out
    # The truth, for scoring.
    verdict: str = ""
    accept: list = dataclasses.field(default_factory=list)  # sets of names that count as correct
    depends_on: list = dataclasses.field(default_factory=list)
    # Increase of chi² of the first run due to the effects, beyond the part that the uncertain priors and the unknown
    # initial state can absorb. For several effects that of the weakest.
    chi2_gain: float = 0.0


def as_written(value):
    """The value with six significant digits, as in the experiment file."""
    return float(f"{value:.6g}") if math.isfinite(value) else value
