"""Light, torque and attitude of free-floating platforms.

An Experiment is a TOML file or a dict with the same keys. Functions named like the program's commands run
it and return NumPy arrays that are views of the library's numbers. Names contain units; values have standard
errors. Wrong input raises InputError with one line; a computation that fails raises NumericalError.
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
