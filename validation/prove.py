"""The command line: tools/prove SETTINGS.toml [--only-make] [--cases DIR] [--out DIR] [--set KEY=VALUE] …"""

import argparse
import concurrent.futures
import hashlib
import importlib
import multiprocessing
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from . import tables
from .blind_run import BlindRun, diagnose_blind
from .errors import InputError, MotionError
from .files import cases_in, is_case, write_file
from .plan import read_plan
from .scoring import score_case


class Progress:
    """Progress of the work and the remaining time: on one line of a terminal, otherwise every ten seconds."""

    def __init__(self, what, count, quiet):
        self.what, self.count, self.quiet = what, count, quiet
        self.done, self.begin, self.last = 0, time.monotonic(), 0.0

    def step(self):
        self.done += 1
        now, finished = time.monotonic(), self.done == self.count
        is_terminal = sys.stderr.isatty()
        if self.quiet or (now - self.last < (0.1 if is_terminal else 10.0) and not finished):
            return
        self.last = now
        left_s = (now - self.begin) / self.done * (self.count - self.done)
        left = f"{left_s / 60:.0f} min" if left_s > 90 else f"{left_s:.0f} s"
        text = f"{self.what}: {self.done} of {self.count}" + ("" if finished else f", {left} left")
        print(f"\r{text}\033[K" if is_terminal else text, end="\n" if finished or not is_terminal else "",
              file=sys.stderr, flush=True)  # fmt: skip


def parsed(arguments):
    parser = argparse.ArgumentParser(
        prog="tools/prove", description="Inject effects in recordings, diagnose them blind, score the answers.")
    parser.add_argument("settings", type=pathlib.Path, help="settings file with a table [prove]: docs/proof.toml")
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path(shutil.which("photorque") or "build/photorque"),
                        help="the photorque to be tried (default: the installed one)")
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE",
                        help="change a key of the settings")
    parser.add_argument("-o", "--out", type=pathlib.Path, help="folder for the results (default: out/SETTINGS/prove)")
    parser.add_argument("--cases", type=pathlib.Path, help="score this folder of cases instead of new ones")
    parser.add_argument("--only-make", action="store_true", help="make the cases, diagnose nothing")
    parser.add_argument("--threads", type=int, default=0,
                        help="cases made side by side (default: all cores), and threads of one diagnosis (default: 1)")
    parser.add_argument("--seed", type=int, help="seed of all randomness, over the settings' own")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON instead of text")
    options = parser.parse_args(arguments)
    for name, value in (("--threads", options.threads), ("--seed", options.seed)):
        if value is not None and value < 0:
            raise InputError("", name, str(value), "a number of at least 0")
    return options


def _hash(path):
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    except OSError as error:
        raise InputError(path, "", error.strerror, "a file that can be read") from None


def _version(program):
    try:
        run = subprocess.run([str(program), "--version"], capture_output=True, text=True, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError) as error:
        raise InputError("", "--program", f"{program}: {error}", "the program photorque") from None
    return run.stdout.strip()


def plan_text(plan):
    """Description of the plan."""
    groups = [[(plan.per_kind, "of every kind"), (plan.pairs, "pairs")]]
    if plan.of == "light":
        groups += [[(plan.none, "with nothing missing"), (plan.outside, "of every law outside the catalogue"),
                    (plan.below, "below the limit")]]  # fmt: skip
    else:
        groups[0] += [(plan.triples, "triples")]
        groups += [[(plan.known_unknown, "with a known effect and an unknown law"),
                    (plan.outside, "of every law outside the catalogue")],
                   [(plan.none, "with nothing missing"),
                    (plan.noise_none, "with nothing missing and noise not as stated"),
                    (plan.noise_effect, "of one effect under correlated noise")]]  # fmt: skip
    lists = [", ".join(f"{count} {what}" for count, what in group if count > 0) for group in groups]
    text = "".join(f"{one}. " for one in lists if one)
    damaged = f"{100.0 * plan.dirty_share:g} % of the files are damaged; seed {plan.seed}."
    if plan.of == "light":
        return text + damaged
    rates = ", ".join(f"{rate:g}" for rate in plan.rates_Hz)
    return (f"{text}{100.0 * plan.second_maker_share:g} % are of the second generator. The others are recordings of "
            f"{plan.duration_s:g} s with hold-outs of {plan.holdout_s:g} s at {rates} Hz. {damaged}")  # fmt: skip


def _maker(plan):
    return importlib.import_module("." + ("light" if plan.of == "light" else "scenarios"), __package__)


def _make(plan, index, folder):
    if not is_case(folder):
        _maker(plan).make_case(plan, index, folder)


def make_cases(plan, folder, threads, quiet):
    """Makes the missing cases and returns the folders of all cases."""
    note, text = folder / "plan.txt", plan_text(plan) + "\n"
    if note.exists() and note.read_text() != text:
        raise InputError(folder, "--out", f"cases of another plan ({note.name})", "cases of this plan, or a new folder")
    write_file(note, text)
    count = min(_maker(plan).case_count(plan), plan.most_cases)
    folders = [folder / f"{i + 1:04d}" for i in range(count)]
    progress = Progress("making cases", count, quiet)
    with concurrent.futures.ProcessPoolExecutor(
        threads or len(os.sched_getaffinity(0)), multiprocessing.get_context("fork")
    ) as pool:
        for future in concurrent.futures.as_completed(
            [pool.submit(_make, plan, i, f) for i, f in enumerate(folders)]
        ):
            future.result()
            progress.step()
    return folders


def _diagnose(case, out, plan, how):
    blind, oracle = out / "blind" / case.name, out / "oracle" / case.name
    diagnose_blind(case, "experiment.toml", blind, how)
    score = score_case(case, blind / "diagnosis", oracle / "diagnosis")
    # The diagnosis of the oracle shows how well these recordings can be predicted.
    can_tell = score.verdict == "missing_physics" and not score.is_outside and (case / "oracle.toml").exists()
    if plan.oracle and can_tell:
        given_truth = BlindRun(how.program, how.program_hash, False, how.longest_s, how.threads)
        diagnose_blind(case, "oracle.toml", oracle, given_truth)
        score = score_case(case, blind / "diagnosis", oracle / "diagnosis")
    return score


def diagnose_and_score(folders, out, plan, how, quiet):
    progress, scores = Progress("diagnosing", len(folders), quiet), [None] * len(folders)
    with concurrent.futures.ThreadPoolExecutor(plan.at_once) as pool:
        futures = {pool.submit(_diagnose, case, out, plan, how): i for i, case in enumerate(folders)}
        try:
            for future in concurrent.futures.as_completed(futures):
                scores[futures[future]] = future.result()
                progress.step()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return scores


def report(scores):
    """The wrong answers, the counts and the figures."""
    lines = []
    for s in scores:
        if not s.right:
            said = f"{s.verdict} {' '.join(s.kinds) or 'nothing'}" if s.answered else f"nothing, {s.failure.strip()}"
            lines.append(f"  wrong: {s.name}: {s.true_verdict} {' '.join(s.true_kinds) or 'nothing'}; said {said}")
    for text, f, _ in tables.questions(scores):
        lines.append(f"  {f.hits:4d} of {f.of:4d}  {100.0 * f.hits / f.of:5.1f} %  "
                     f"({100.0 * f.low:.1f} to {100.0 * f.high:.1f})  {text}")  # fmt: skip
    for name, (value, error) in tables.figures(scores).items():
        lines.append(f"  {name} {value:.4g}" + (f" ± {error:.2g}" if error > 0.0 else ""))
    return "\n".join(lines)


def _name_of_cases(folder):
    """Name of a folder of cases: "light" for out/light/cases."""
    whole = folder.resolve()
    return whole.parent.name if whole.name == "cases" else whole.name


def run(options):
    plan = read_plan(options.settings, options.overrides, options.seed)
    out = options.out or pathlib.Path("out") / options.settings.stem / "prove"
    quiet = options.quiet or options.json

    def say(text):
        if not quiet:
            print(text, flush=True)

    program = options.program.absolute()
    version = "" if options.only_make else _version(program)
    folders = cases_in(options.cases) if options.cases else make_cases(plan, out / "cases", options.threads, quiet)
    say(f"{len(folders)} cases")
    if options.only_make:
        return
    how = BlindRun(program, _hash(program), plan.replay, plan.longest_s, max(1, options.threads))
    scores = diagnose_and_score(folders, out, plan, how, quiet)
    say(report(scores))
    provenance = {"program": version, "program_hash": how.program_hash, "seed": plan.seed,
                  "settings": f"{options.settings.name} {_hash(options.settings)}"}  # fmt: skip
    if options.cases:
        text = tables.markdown(f"Cases of {_name_of_cases(options.cases)}", f"{len(scores)} cases.", scores)
    else:
        text = tables.markdown("Cases made by this command", plan_text(plan), scores)
    for name, table in tables.TABLES.items():
        write_file(out / f"{name}.csv", tables.csv_text(table(scores), provenance))
    write_file(out / "summary.json", tables.summary_json(scores, provenance))
    write_file(out / "proof.md", text)
    if plan.document:
        old = plan.document.read_text(encoding="utf-8")
        write_file(plan.document, tables.with_section(old, plan.section, text, plan.document))
    if options.json:
        print(tables.summary_json(scores, provenance), end="")
    say(f"Written to {out}")


def main(arguments=None):
    """Exit status 0; 2 for wrong input, with one line on standard error; 130 when interrupted."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        run(parsed(arguments))
    except (InputError, MotionError) as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    except OSError as error:
        print(f"{error.filename or ''}: {error.strerror}", file=sys.stderr)
        return 2
    return 0

