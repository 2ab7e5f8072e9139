"""Results as plots (matplotlib) and as xarray, and a progress bar for long runs."""

import sys
from collections.abc import Callable
from typing import Any

import numpy

_WIDTH_IN, _HEIGHT_IN = 6.4, 3.6


def draw_map(field: Any, axes: Any = None) -> Any:
    """Draws a Map as an image with a colour bar; returns the matplotlib Axes."""
    from matplotlib import pyplot  # type: ignore[import]

    if axes is None:
        axes = pyplot.subplots(layout="constrained")[1]
    style: dict[str, Any] = {"cmap": "viridis"}
    if field.is_signed:
        largest = float(numpy.nanmax(numpy.abs(field.value)))
        style = {"cmap": "RdBu_r", "vmin": -largest, "vmax": largest}
    image = axes.imshow(field.value, origin="lower", extent=field.extent,
                        aspect="equal" if field.has_equal_scale else "auto", **style)
    axes.figure.colorbar(image, ax=axes, label=field.unit)
    axes.set(title=field.title, xlabel=field.x_label, ylabel=field.y_label)
    return axes


def _hangs(curve: Any) -> bool:
    """Whether the curve is one bar between two values: a stage of a waterfall."""
    return curve.style == "bars" and len(curve.x) == 2 and curve.x[0] == curve.x[1]


def _draw_waterfall(stages: list[Any], axes: Any) -> None:
    for stage in stages:
        begin, end = stage.y
        axes.bar(stage.x[0], end - begin, bottom=begin, width=0.8, color="C0" if begin == 0 else "C3")
    axes.set_xticks([stage.x[0] for stage in stages], [stage.label for stage in stages],
                    rotation=30, ha="right", rotation_mode="anchor")


def _draw_curve(curve: Any, axes: Any) -> None:
    label = curve.label or None
    if curve.style == "bars":
        axes.bar(curve.x, curve.y, width=_spacing(curve.x), label=label)
    elif curve.style in ("points", "dots"):
        marker = "o" if curve.style == "points" else ","
        axes.errorbar(curve.x, curve.y, curve.y_error, fmt=marker, capsize=2, label=label)
    else:
        line = "--" if curve.style == "dashed" else "-"
        drawn, = axes.plot(curve.x, curve.y, line, label=label)
        if curve.y_error is not None:
            low, high = curve.y - curve.y_error, curve.y + curve.y_error
            axes.fill_between(curve.x, low, high, alpha=0.3, color=drawn.get_color())


def _spacing(x: Any) -> float:
    return float(numpy.min(numpy.diff(x))) if len(x) > 1 else 1.0


def draw_plot(plot: Any, axes: Any = None) -> Any:
    """Draws a Plot with its panels below each other; returns the matplotlib Axes, an array for several panels."""
    from matplotlib import pyplot

    count = len(plot.panels)
    if axes is None:
        axes = pyplot.subplots(count, sharex=True, layout="constrained",
                               figsize=(_WIDTH_IN, _HEIGHT_IN * (1 + 0.5 * (count - 1))))[1]
    panels = numpy.atleast_1d(axes)
    for panel, where in zip(plot.panels, panels, strict=True):
        stages = [curve for curve in panel.curves if _hangs(curve)]
        curves = [curve for curve in panel.curves if not _hangs(curve)]
        for curve in curves:
            _draw_curve(curve, where)
        for level in panel.levels:
            where.axhline(level, linestyle=":", color="grey", linewidth=1)
        where.set(ylabel=panel.y_label, xscale="log" if plot.x_log else "linear",
                  yscale="log" if panel.y_log else "linear")
        if stages:
            _draw_waterfall(stages, where)
        labels = sum(bool(curve.label) for curve in curves)
        if labels > 4:
            where.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.0, 1.0))
        elif labels > 0:
            where.legend(fontsize="small")
    panels[0].set_title(plot.title)
    panels[-1].set_xlabel(plot.x_label)
    return axes


def draw_result(result: Any, name: str | None = None, axes: Any = None) -> Any:
    """Draws the map or plot `name` of a result and returns its matplotlib Axes. Without a name, draws all and returns
    a list."""
    drawers = {key: draw_map for key in result.maps} | {key: draw_plot for key in result.plots}
    if name is None:
        return [draw_result(result, each) for each in drawers]
    if name not in drawers:
        raise KeyError(f"no map or plot {name!r}, expected one of {', '.join(drawers) or 'none'}")
    return drawers[name]({**result.maps, **result.plots}[name], axes)


def map_to_xarray(field: Any) -> Any:
    """A Map as an xarray.Dataset over the centres of its bins."""
    import xarray

    rows, columns = field.value.shape
    left, right, bottom, top = field.extent
    middles = {
        "y": bottom + (numpy.arange(rows) + 0.5) * (top - bottom) / rows,
        "x": left + (numpy.arange(columns) + 0.5) * (right - left) / columns,
    }
    values = {"value": field.value}
    if field.standard_error is not None:
        values["standard_error"] = field.standard_error
    found = xarray.Dataset({key: (("y", "x"), numbers) for key, numbers in values.items()}, coords=middles)
    return found.assign_attrs(title=field.title, unit=field.unit, x_label=field.x_label, y_label=field.y_label)


def progress_bar(width: int = 40) -> Callable[[str, float], None]:
    """A bar for `progress=` of long runs, in terminals and notebooks: power(experiment, progress=progress_bar())."""

    def show(task: str, fraction: float) -> None:
        done = round(width * fraction)
        end = "\n" if fraction >= 1.0 else ""
        sys.stdout.write(f"\r[{'#' * done}{'.' * (width - done)}] {100 * fraction:3.0f} % {task}{end}")
        sys.stdout.flush()

    return show
