#!/usr/bin/env python3
"""Makes the files of this folder from the originals; README.md says what they are.

Usage: make.py FOLDER, the folder that holds cases/, photometry/ and reference/.
Plain Python and the standard library only. Equal originals give equal files.
"""
import array
import pathlib
import shutil
import sys


def as_float32(original, copy):
    values = array.array("d", original.read_bytes())
    copy.write_bytes(array.array("f", values).tobytes())


def without_needless_digits(original, copy):
    """Numbers, each as the shortest text that reads back equal."""
    lines = original.read_text().splitlines()
    short = [line if line.startswith("#") else ",".join(map(shortest, line.split(",")))
             for line in lines]
    copy.write_text("\n".join(short) + "\n")


def shortest(cell):
    text = repr(float(cell))
    return text[:-2] if text.endswith(".0") else text


def main():
    shared, data = pathlib.Path(sys.argv[1]), pathlib.Path(__file__).parent
    for folder in ("optics", "electrical", "beams", "cases"):
        shutil.rmtree(data / folder, ignore_errors=True)
        (data / folder).mkdir()
    for original, copy in (("refA0", "disc_angle"), ("refA1", "disc_projected")):
        as_float32(shared / "reference/optics" / (original + ".f64"), data / "optics" / (copy + ".f32"))
    for part in ("maps", "ngspice"):
        for original in sorted((shared / "reference/electrical" / part).glob("*.csv")):
            without_needless_digits(original, data / "electrical" / original.name)
    beams = shared / "photometry/synthetic"
    for name in ("gauss3", "core3_halo12_20pct"):
        for kind in (".ies", ".ldt"):
            shutil.copyfile(beams / (name + kind), data / "beams" / (name + kind))
    (data / "beams/gauss3_begin.dat").write_bytes((beams / "gauss3.dat").read_bytes()[:208 + 28 * 50])
    for case in sorted(path.parent for path in shared.glob("cases/*/truth.json")):
        shutil.copytree(case, data / "cases" / case.name, copy_function=shutil.copyfile)
        (data / "cases" / case.name).chmod(0o755)


main()
