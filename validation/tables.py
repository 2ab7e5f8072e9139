"""Tables of scores: CSV, JSON and the marked sections of docs/proof.md."""

import csv
import io
import json
import math
import statistics

from .errors import InputError
from .scoring import Fraction, calibration, claims_of_names, claims_of_verdicts, figures, questions

RELIABILITY_EDGES = (0.0, 0.5, 0.8, 0.95, 0.99, 1.0)
CALIBRATION_EDGES = (0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
CALIBRATION_COLUMNS = ("from", "to", "answers", "mean_stated", "share_right", "low_95", "high_95")


def _joined(names, none="-"):
    return " + ".join(names) or none


def summary(scores):
    """The main counts as (columns, rows)."""
    rows = [(text, aim or "-", f.hits, f.of, f.hits / f.of, f.low, f.high) for text, f, aim in questions(scores) if text not in _REPEATED]
    return ("question", "aim", "hits", "of", "share", "low_95", "high_95"), rows


def by_family(scores):
    groups = {}
    for s in scores:
        names = [f"family {s.family}"] + ([f"maker {s.maker.split(',')[0]}"] if s.maker else [])
        for name in names:
            groups.setdefault(name, []).append(s)
    rows = []
    for name, group in sorted(groups.items()):
        right = Fraction(sum(s.right for s in group), len(group))
        times_s = [s.processor_s for s in group if math.isfinite(s.processor_s)] or [math.nan]
        rows.append((name, right.of, right.hits, right.hits / right.of, right.low, right.high,
                     sum(s.wrong_name for s in group), statistics.median(times_s), max(times_s)))  # fmt: skip
    return ("group", "cases", "right", "share", "low_95", "high_95", "wrong_name", "median_s", "largest_s"), rows


def _group_of_kinds(score):
    name = {0: "nothing missing", 2: "two effects", 3: "three effects"}.get(len(score.true_kinds),
                                                                              _joined(score.true_kinds))  # fmt: skip
    if score.is_outside:
        name = "unknown: " + ("beside a known effect" if len(score.true_kinds) > 1 else name)
    return name + (", other noise" if score.family.startswith("noise") else "")


def by_kind(scores):
    groups = {}
    for s in scores:
        groups.setdefault(_group_of_kinds(s), []).append(s)
    rows = []
    for name, group in sorted(groups.items()):
        shown = [s for s in group if s.is_visible or s.is_outside or s.is_none]
        weak = [s for s in group if s not in shown]
        rows.append((name, len(shown), sum(s.right for s in shown), len(weak), sum(s.right for s in weak),
                     sum(s.wrong_name for s in group), sum(not s.answered for s in group)))  # fmt: skip
    return ("concealed", "shown", "right", "too_weak", "too_weak_right", "wrong_name", "unanswered"), rows


def _calibration_table(claims, edges):
    return CALIBRATION_COLUMNS, [(low, high, f.of, stated, f.hits / f.of, f.low, f.high)
                                 for low, high, f, stated in calibration(claims, edges)]  # fmt: skip


def reliability(scores):
    return _calibration_table(claims_of_names(scores), RELIABILITY_EDGES)


def confidence(scores):
    return _calibration_table(claims_of_verdicts(scores), CALIBRATION_EDGES)


def cases(scores):
    columns = ("case", "true_verdict", "concealed", "verdict", "named", "right", "right_within_group", "chi2_gain",
               "confidence", "holdout_chi2", "oracle_chi2", "predictive_chi2", "predictive_sigma", "expected_chi2",
               "replay_chi2", "pulls_rms", "impossible", "exit_status", "processor_s", "family", "maker")  # fmt: skip
    rows = []
    for s in scores:
        rms = math.sqrt(statistics.fmean(p * p for p in s.pulls)) if s.pulls else math.nan
        rows.append((s.name, s.true_verdict, _joined(s.true_kinds), s.verdict if s.answered else "no answer",
                     _joined(s.kinds), int(s.right), int(s.right_within_group), s.chi2_gain, s.confidence,
                     s.holdout_chi2, s.oracle_chi2, s.predictive_chi2, s.predictive_sigma, s.expected_chi2,
                     s.replay_chi2, rms, _joined(s.impossible), s.exit_status, s.processor_s, s.family,
                     s.maker or "-"))  # fmt: skip
    return columns, rows


TABLES = {"proof": summary, "proof_by_family": by_family, "proof_by_kind": by_kind, "proof_reliability": reliability,
          "proof_calibration": confidence, "proof_cases": cases}  # fmt: skip


def csv_text(table, provenance):
    """A table as CSV after lines of provenance; NaN is an empty cell."""
    columns, rows = table
    out = io.StringIO()
    for key, value in provenance.items():
        out.write(f"# {key}: {value}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow(["" if isinstance(x, float) and math.isnan(x) else x for x in row])
    return out.getvalue()


def summary_json(scores, provenance):
    """Every figure with value and standard error, and the provenance."""
    summary = {name: {"value": value, "standard_error": error} for name, (value, error) in figures(scores).items()}
    return json.dumps(summary | {"provenance": provenance}, indent=2, ensure_ascii=False) + "\n"


# Markdown.


def _cell(value, digits):
    if isinstance(value, str):
        return value
    return f"{value:{digits}}" if math.isfinite(value) else "–"


# Columns of the CSV files with other headings in documents.
_HEADINGS = {"concealed": "injected effect", "share": "fraction", "share_right": "fraction right", "mean_stated": "mean stated",
             "low_95": "95 % from", "high_95": "to", "wrong_name": "wrong name", "median_s": "median s", "largest_s": "largest s",
             "too_weak": "too weak", "too_weak_right": "of these right"}  # fmt: skip


def _markdown_table(columns, rows, digits=".3g"):
    if not rows:
        return "(none)\n"
    lines = [[_HEADINGS.get(name, name) for name in columns], ["---", *["---:"] * (len(columns) - 1)], *[[_cell(x, digits) for x in row] for row in rows]]
    text = ["| " + " | ".join(line) + " |" for line in lines]
    text[1] = "|" + "|".join(lines[1]) + "|"
    return "\n".join(text) + "\n"


def _percent(fraction):
    return f"{100.0 * fraction:.1f} %"


def _wrong_cases(scores):
    rows = []
    for s in scores:
        if not s.right:
            said = f"{s.verdict}: {_joined(s.kinds, '–')}" if s.answered else f"no answer: {s.failure.split(chr(10))[0]}"
            rows.append((s.name, f"{s.true_verdict}: {_joined(s.true_kinds, '–')}", s.chi2_gain, said))
    return _markdown_table(("case", "truth", "χ² gain", "answer"), rows) if rows else "None.\n"


# Figures and questions that are repeated in other rows of the document; they are only in the CSV files.
_REPEATED = {"cases", "holdout_within_10_percent_of_oracle", "processor_over_60_s", "answers without a confidence", "exits other than 0",
             "missing_physics without a stated prediction"}  # fmt: skip


def markdown(title, description, scores):
    """The section of a document: counts with their intervals, figures, and every wrong case. Only the times depend on
    the machine. Calibration, kinds and families are only in the CSV files."""
    counts = [(text, f"{f.hits} of {f.of}", _percent(f.hits / f.of), f"{_percent(f.low)} to {_percent(f.high)}", aim)
              for text, f, aim in questions(scores) if text not in _REPEATED]  # fmt: skip
    values = [(name, f"{value:.4g}" + (f" ± {error:.2g}" if error > 0.0 else ""))
              for name, (value, error) in figures(scores).items() if name not in _REPEATED]  # fmt: skip
    return "\n".join([
        f"### {title}\n\n{description}\n",
        _markdown_table(("question", "right", "fraction", "95 % interval", "aim"), counts),
        _markdown_table(("figure", "value"), values),
        "Wrong answers:\n",
        _wrong_cases(scores),
    ])  # fmt: skip


def with_section(document, name, text, file):
    """`document` with the text between <!-- NAME begin --> and <!-- NAME end --> replaced."""
    begin, end = f"<!-- {name} begin -->\n", f"<!-- {name} end -->"
    start, stop = document.find(begin), document.find(end)
    if start < 0 or stop < start:
        raise InputError(file, "", f'no lines "<!-- {name} begin -->" and end', "a document with both")
    return document[: start + len(begin)] + "\n" + text + "\n" + document[stop:]
