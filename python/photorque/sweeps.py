"""One run over a grid of keys."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy

from photorque._photorque import Experiment, power


class Sweep:
    """Figures of the runs of a grid: arrays with one dimension per axis, in the order of `axes`."""

    def __init__(self, axes: dict[str, list[Any]], figures: dict[str, Any], standard_errors: dict[str, Any]):
        self.axes = axes
        self.figures = figures
        self.standard_errors = standard_errors

    def __repr__(self) -> str:
        axes = ", ".join(f"{key}: {len(values)}" for key, values in self.axes.items())
        return f"<sweep over {axes}; figures {', '.join(self.figures)}>"

    def best(self, figure: str, smallest: bool = False) -> dict[str, Any]:
        """Keys of the run with the largest (or smallest) figure."""
        values = self.figures[figure]
        at = numpy.unravel_index((numpy.nanargmin if smallest else numpy.nanargmax)(values), values.shape)
        return {key: values_of[int(i)] for (key, values_of), i in zip(self.axes.items(), at)}

    def to_xarray(self) -> Any:
        """An xarray.Dataset; standard errors are variables whose names end in _standard_error."""
        import xarray

        names = list(self.axes)
        variables = {name: (names, values) for name, values in self.figures.items()}
        variables |= {name + "_standard_error": (names, values) for name, values in self.standard_errors.items()}
        return xarray.Dataset(variables, coords=self.axes)


def sweep(
    experiment: Experiment,
    axes: Mapping[str, Sequence[Any]],
    run: Callable[[Experiment], Any] = power,
    figures: Sequence[str] | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Sweep:
    """Runs every combination of the keys in `axes`; the last axis varies fastest. `run` is any function of an
    experiment that returns figures (trace, power, torque_map, propagate, a lambda with other options).

    `figures` are names in its `figures` (default: all). The first error ends the sweep. Nothing is stored on disk:
    for many runs, random plans, means, constraints and searches use the commands `sweep` and `optimise`."""
    grid = {key: list(values) for key, values in axes.items()}
    shape = tuple(len(values) for values in grid.values())
    values: dict[str, Any] = {}
    errors: dict[str, Any] = {}
    count = 0
    for at, combination in zip(numpy.ndindex(*shape), itertools.product(*grid.values())):
        found = run(experiment.with_keys(dict(zip(grid, combination)))).figures
        for name in figures if figures is not None else found:
            for where, number in ((values, found[name].value), (errors, found[name].standard_error)):
                where.setdefault(name, numpy.full(shape, numpy.nan))[at] = number
        count += 1
        if progress is not None:
            progress("sweep", count / math.prod(shape))
    return Sweep(grid, values, errors)


