"""Light, torque and attitude of free-floating platforms.

An Experiment is a TOML file or a dict with the same keys; functions named as the program's commands
run it and give NumPy arrays that look at the library's own numbers. Units stand in names, standard
errors beside values. Wrong input raises InputError with one line; a computation that fails raises
NumericalError.
"""

from photorque._photorque import (
    Balance,
    Budget,
    BudgetEntry,
    CellFit,
    Diagnosis,
    Effect,
    Estimate,
    Experiment,
    FluxMap,
    InputError,
    Map,
    Motion,
    NumericalError,
    Power,
    Table,
    TorqueMap,
    Trace,
    __version__,
    balance,
    budget,
    diagnose,
    fit_cell,
    git_hash,
    power,
    propagate,
    torque_map,
    trace,
)

__all__ = [
    "Balance",
    "Budget",
    "BudgetEntry",
    "CellFit",
    "Diagnosis",
    "Effect",
    "Estimate",
    "Experiment",
    "FluxMap",
    "InputError",
    "Map",
    "Motion",
    "NumericalError",
    "Power",
    "Table",
    "TorqueMap",
    "Trace",
    "__version__",
    "balance",
    "budget",
    "diagnose",
    "fit_cell",
    "git_hash",
    "power",
    "propagate",
    "torque_map",
    "trace",
]
