"""The JSON Schema of experiments: it is what the program writes, takes every experiment that is
shipped and every key of tests/data/keys, and refuses broken ones. So do the tables in the documents.

    check.py PROGRAM SOURCE_FOLDER
"""

import copy
import datetime
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is missing (tools/install --tests)")
    sys.exit(77)

program, root = sys.argv[1], pathlib.Path(sys.argv[2])
failures = []


def expect(is_so, message):
    if not is_so:
        failures.append(message)


def plain(value):
    """TOML as JSON has it: dates are their text."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, (datetime.date, datetime.datetime, datetime.time)):
        return value.isoformat()
    return value


def run(*arguments):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)


# Written by the build, where editors look for it.
built = root / "docs/experiment.schema.json"
expect(run("schema").stdout == built.read_text(), f"{built} is not what `photorque schema` writes")
schema = json.loads(built.read_text())
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)


def errors(experiment):
    return [error.message[:200] for error in validator.iter_errors(plain(experiment))]


# ---- What is shipped, and every key.
shipped = sorted(p for folder in ("scenes", "docs") for p in (root / folder).rglob("*.toml")
                 if p.stem not in ("parameters", "proof", "proof_light"))
expect(len(shipped) >= 18, f"only {len(shipped)} experiments are shipped")
for path in shipped:
    text = path.read_text()
    expect(not errors(tomllib.loads(text)), f"{path}: {errors(tomllib.loads(text))[:3]}")
    line = re.match(r"#:schema (\S+)\n", text)
    expect(line and (path.parent / line[1]).resolve() == built.resolve(),
           f"{path} does not begin with a line `#:schema` that leads to {built}")
examples = sorted((root / "tests/data/keys").glob("*.toml")) + sorted(
    (root / "tests/data/cases").glob("*/experiment.toml"))
for path in examples:
    found = errors(tomllib.loads(path.read_text()))
    expect(not found, f"{path}: {found[:3]}")


# ---- Every key with a value of the wrong type, and with a letter too many.
def spots(table, path=()):
    for key, value in table.items():
        yield path, key
        items = value if isinstance(value, list) else [value]
        for i, item in enumerate(items):
            if isinstance(item, dict):
                yield from spots(item, path + ((key, i if isinstance(value, list) else None),))


def inside(table, path):
    for key, i in path:
        table = table[key] if i is None else table[key][i]
    return table


broken = 0
def alone(experiment, where, key):
    """The top table, or one item of it, that the key is in, and the path from there."""
    top, i = where[0] if where else (key, None)
    value = experiment[top]
    if i is not None:
        return {top: [copy.deepcopy(value[i])]}, ((top, 0),) + where[1:]
    return {top: copy.deepcopy(value)}, where


for path in examples:
    experiment = tomllib.loads(path.read_text())
    for where, key in spots(experiment):
        if where and where[-1][0] in ("columns", "inertia_kg_m2"):
            continue  # any channel of a recording; a matrix with its errors, which its reader checks
        for change in ("type", "name"):
            other, place = alone(experiment, where, key)
            table = inside(other, place)
            if change == "name":
                table[key + "x"] = table.pop(key)
            else:
                table[key] = 7 if isinstance(table[key], bool) else True
            broken += 1
            expect(not validator.is_valid(plain(other)),
                   f"{path}: {where} {key} of another {change} is taken")
expect(broken > 1000, f"only {broken} broken experiments were tried")

# ---- Mistakes that people make: the schema refuses them, and `check` says each in one line.
stasis = root / "scenes/stasis"
mistakes = [
    # file, from, to, what `check` says
    ("nominal.toml", "fwhm_deg = 3.0", "fwhm_dge = 3.0", 'perhaps "fwhm_deg"'),
    ("nominal.toml", "total_power_W = 88", 'total_power_W = "88"', "a number > 0 W"),
    ("nominal.toml", "pitch_mm = 46", "pitch_kg = 46", "a unit of length"),
    ("nominal.toml", "spectral_fwhm_nm = 30", "spectral_fwhm_nm = -30", "a number in [0, 1000000] nm"),
    ("nominal.toml", 'kind = "led_array"', 'kind = "led_aray"', 'did you mean "led_array"?'),
    ("nominal.toml", 'layout = "grid"', 'layout = "hexagon"', 'did you mean "hexagonal"?'),
    ("nominal.toml", "ring", "ring_radius_m = 0.1\n# ring", None),
    ("nominal.toml", "[trace]", "[trase]", 'perhaps "trace"'),
    ("attitude.toml", "mass_kg = 6.99995", "mass_kg = -7", "a number > 0 kg"),
    ("attitude.toml", 'kind = "static_unbalance"', 'kind = "static_unbalanse"',
     'did you mean "static_unbalance"?'),
    ("attitude.toml", "[balance]", "[balance]\nmases = 3", "an unknown key"),
]
for file, before, after, said in mistakes:
    text = (stasis / file).read_text()
    if said is None:  # a key of another layout
        before, after = "pitch_mm = 46", "ring_radius_m = 0.1\npitch_mm = 46"
        said = "an unknown key"
    expect(before in text, f"{file} has no {before}")
    changed = text.replace(before, after, 1)
    expect(errors(tomllib.loads(changed)), f"the schema takes {after}")
    with tempfile.TemporaryDirectory(dir=stasis) as folder:
        path = pathlib.Path(folder) / file
        for name in ("stasis.gltf", "light_torque.csv"):
            changed = changed.replace(f'"{name}"', f'"../{name}"')
        path.write_text(changed)
        got = run("check", path)
    lines = got.stderr.splitlines()
    expect(got.returncode == 2 and len(lines) == 1 and said in lines[0], f"{after}: {lines}")

# ---- The tables in the documents.
documents = [p for p in sorted((root / "docs").glob("*.md")) if "<!-- keys " in p.read_text()]
expect(len(documents) >= 6, f"only {len(documents)} documents have tables of keys")
for document in documents:
    with tempfile.TemporaryDirectory() as folder:
        renewed = pathlib.Path(folder) / document.name
        renewed.write_text(document.read_text())
        got = run("schema", "--document", renewed)
        expect(got.returncode == 0, got.stderr)
        expect(renewed.read_text() == document.read_text(),
               f"{document}: run `photorque schema --document docs/{document.name}`")

for failure in failures:
    print(failure)
print(f"{len(shipped)} shipped experiments, {len(examples)} examples, {broken} broken keys, "
      f"{len(mistakes)} mistakes, {len(documents)} documents: {len(failures)} failures")
sys.exit(1 if failures else 0)
