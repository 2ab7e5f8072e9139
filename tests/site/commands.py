#!/usr/bin/env python3
"""The commands of README.md and of the documents fit the program, and README's figures are those that it computes.

commands.py PROGRAM SOURCE_FOLDER

Every line of code "photorque VERB FILE …" of a document whose file is shipped: the verb has all options, `check` finds no
mistake in the file with its --set, and says that the verb is possible. The commands of README.md are run, and the table
that tools/readme writes is compared (numbers within 0.5 %). tutorials.py runs those of the tutorials.
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from tutorials import agree, words

program, source = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
failures = []


def run(*arguments, status=0):
    done = subprocess.run([program, *arguments], cwd=source, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          check=False)
    if done.returncode != status:
        failures.append(f"photorque {shlex.join(map(str, arguments))}: exit status {done.returncode}\n{done.stdout}")
    return done.stdout


def commands(text):
    """Lines of code, with their continuations, that call the program."""
    text = text.replace("\\\n", " ")
    code = re.findall(r"^ {4}(.*)$", text, re.M)
    for block in re.findall(r"^```(?:sh|bash)?\n(.*?)^```$", text, re.M | re.S):
        code += block.splitlines()
    code += re.findall(r"`((?:build/)?photorque [^`]*)`", text)
    for line in code:
        match = re.match(r"\s*(?:build/)?photorque\s+([a-z][\w-]*)\s+(.*)", line)
        if match and "…" not in line and "[--" not in line:
            yield match[1], shlex.split(match[2], comments=True)


helps, checked = {}, {}
count = 0
for page in [source / "README.md", *sorted((source / "docs").glob("*.md"))]:
    for verb, arguments in commands(page.read_text(encoding="utf-8")):
        if verb not in helps:
            helps[verb] = run(verb, "--help")
        where = f"{page.name}: photorque {verb} {shlex.join(arguments)}"
        for option in (a for a in arguments if a.startswith("--")):
            if not re.search(rf"(^|[\s,]){re.escape(option)}\b", helps[verb]):
                failures.append(f"{where}: no option {option}")
        experiment = next((a for a in arguments if a.endswith(".toml") and (source / a).is_file()), None)
        if experiment is None or verb in ("check", "new", "schema"):
            continue
        settings = [word for a, b in zip(arguments, arguments[1:]) if a == "--set" for word in (a, b)]
        if any("COMMANDS.csv" in word or "/where/it/is" in word for word in settings):
            continue  # the reader's own file
        key = (experiment, *settings)
        if key not in checked:
            checked[key] = run("check", experiment, *settings)
        if not re.search(rf"^{verb}\b", checked[key], re.M):
            failures.append(f"{where}: {verb} is not possible\n{checked[key]}")
        count += 1
if count < 30:
    failures.append(f"only {count} commands found")

readme = (source / "README.md").read_text(encoding="utf-8")
with tempfile.TemporaryDirectory() as out:
    for verb, arguments in commands(readme):
        run(verb, *arguments, "--out", out, "--quiet")
table = subprocess.run([sys.executable, "-B", source / "tools/readme", "--print", program], text=True, check=True,
                       stdout=subprocess.PIPE).stdout.strip().splitlines()
quoted = readme.split("<!-- figures begin -->\n")[1].split("<!-- figures end -->")[0].strip().splitlines()
if len(table) != len(quoted):
    failures.append(f"README: {len(quoted)} lines of figures, computed {len(table)}")
for expected, found in zip(quoted, table):
    if not agree(words(expected.replace("−", "-")), words(found.replace("−", "-")), 0.005):
        failures.append(f"README: {expected}\ncomputed {found}")

for failure in failures:
    print("wrong:", failure)
print(f"{count} commands checked, {len(failures)} failed")
sys.exit(1 if failures else 0)
