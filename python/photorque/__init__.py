"""Irradiance, solar-array power, radiation torque and attitude of free-floating platforms.

An Experiment is a TOML file or a dict with the same keys. Each function runs the command of the same name and
returns NumPy arrays, which are read-only views of the results. Figures have standard errors, and names end with
the unit. Wrong input raises InputError with a message of one line; a failed computation raises NumericalError.
"""

from photorque._photorque import *  # noqa: F403
from photorque._photorque import __version__
from photorque.plots import progress_bar
from photorque.sweeps import Sweep, sweep

__all__ = [
    "AttitudeEstimate",
    "Balance",
    "Budget",
    "BudgetEntry",
    "Camera",
    "CellFit",
    "CheckReport",
    "Curve",
    "Diagnosis",
    "Effect",
    "Estimate",
    "Experiment",
    "FluxMap",
    "InputError",
    "Lamp",
    "Map",
    "Motion",
    "NumericalError",
    "Panel",
    "Plot",
    "Power",
    "Render",
    "Sweep",
    "Table",
    "TorqueMap",
    "Trace",
    "__version__",
    "balance",
    "budget",
    "camera",
    "check",
    "diagnose",
    "estimate",
    "fit_cell",
    "git_hash",
    "power",
    "progress_bar",
    "propagate",
    "render",
    "sweep",
    "torque_map",
    "trace",
]
