"""The plan of a benchmark: table [prove] of its settings file; docs/proof.toml explains the keys."""

import dataclasses
import math
import pathlib
import tomllib

from .errors import InputError

MAX_CASES = 100000


@dataclasses.dataclass
class Plan:
    """Number of cases in each family, their properties, and options of the diagnosis."""

    of: str = "motion"
    seed: int = 1
    per_kind: int = 4
    none: int = 30
    pairs: int = 12
    outside: int = 3
    triples: int = 0
    known_unknown: int = 0
    noise_none: int = 0
    noise_effect: int = 0
    below: int = 0
    strong_share: float = 0.0
    second_maker_share: float = 0.0
    duration_s: float = 400.0
    holdout_s: float = 300.0
    rates_Hz: tuple = (10.0, 20.0)
    dirty_share: float = 0.3
    oracle: bool = True
    replay: bool = True
    at_once: int = 1
    longest_s: float = 900.0
    most_cases: int = MAX_CASES
    section: str = "prove"
    document: pathlib.Path | None = None


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _check(where, key, value, is_good, expected):
    if not is_good(value):
        raise InputError(where, f"prove.{key}", repr(value), expected)
    return value


def _whole(lowest, highest):
    return (lambda v: isinstance(v, int) and not isinstance(v, bool) and lowest <= v <= highest,
            f"a whole number from {lowest} to {highest}")


def _number(lowest, highest, is_open=False):
    def is_good(v):
        return _is_number(v) and lowest <= v <= highest and not (is_open and v == lowest)

    return is_good, f"a number {'above' if is_open else 'of at least'} {lowest:g} and at most {highest:g}"


_COUNT = _whole(0, MAX_CASES)
_SHARE = _number(0.0, 1.0)
_SECONDS = _number(20.0, 1e5)
_FLAG = (lambda v: isinstance(v, bool), "true or false")
_TEXT = (lambda v: isinstance(v, str) and v != "", "a text")
_RULES = {
    "of": (lambda v: v in ("motion", "light"), '"motion" or "light"'),
    "seed": _whole(0, 2**63 - 1),
    "below": _COUNT, "per_kind": _COUNT, "none": _COUNT, "pairs": _COUNT, "outside": _COUNT, "triples": _COUNT,
    "known_unknown": _COUNT, "noise_none": _COUNT, "noise_effect": _COUNT,
    "strong_share": _SHARE, "second_maker_share": _SHARE, "dirty_share": _SHARE,
    "duration_s": _SECONDS, "holdout_s": _SECONDS,
    "rates_Hz": (lambda v: isinstance(v, list) and len(v) > 0 and all(_is_number(x) and 1.0 <= x <= 1000.0 for x in v),
                 "an array of rates from 1 to 1000"),
    "oracle": _FLAG, "replay": _FLAG,
    "at_once": _whole(1, 1024),
    "longest_s": _number(0.0, 1e9, is_open=True),
    "most_cases": _whole(1, MAX_CASES),
    "section": _TEXT, "document": _TEXT,
}  # fmt: skip


def _override(tables, change):
    """Applies `--set prove.seed=2`: the value is TOML, or a bare word."""
    name, equals, text = change.partition("=")
    if not equals or not name.strip():
        raise InputError("", "--set", change, "KEY=VALUE")
    try:
        value = tomllib.loads(f"x = {text}")["x"]
    except tomllib.TOMLDecodeError:
        value = text
    *path, key = name.strip().split(".")
    table = tables
    for word in path:
        table = table.setdefault(word, {})
        if not isinstance(table, dict):
            raise InputError("", "--set", change, "a key within a table")
    table[key] = value


def read_plan(path, overrides=(), seed=None):
    """The plan in the settings file `path`. Raises InputError for missing, unknown or out-of-range keys."""
    path = pathlib.Path(path)
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, "", error.strerror, "a settings file that can be read") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(path, "", str(error), "TOML") from None
    for change in overrides:
        _override(tables, change)
    prove = tables.pop("prove", None)
    if not isinstance(prove, dict):
        raise InputError(path, "", "no table [prove]", "one")
    for key in tables:
        raise InputError(path, key, "an unknown key", "the table [prove] alone")
    values = {}
    for key, value in prove.items():
        if key not in _RULES:
            raise InputError(path, f"prove.{key}", "an unknown key", "one of " + ", ".join(_RULES))
        values[key] = _check(path, key, value, *_RULES[key])
    if "rates_Hz" in values:
        values["rates_Hz"] = tuple(float(x) for x in values["rates_Hz"])
    if "document" in values:
        values["document"] = path.parent / values["document"]
        if not values["document"].is_file():
            raise InputError(path, "prove.document", f"no file {values['document']}", "a page to renew")
    if seed is not None:
        values["seed"] = seed
    return Plan(**values)
