"""Build backend (PEP 517) for the wheel of photorque: CMake compiles, this module packs. Standard library only.

Environment: PHOTORQUE_BUILD sets another build folder than build/; files that are already compiled there
are not compiled again.
"""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import zipfile

root = pathlib.Path(__file__).resolve().parent.parent


def _version():
    text = (root / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(photorque VERSION ([\d.]+)", text).group(1)


def _metadata():
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {_version()}",
        f"Summary: {project['description']}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {one}" for one in project["dependencies"]),
        "Description-Content-Type: text/markdown",
    ]
    return "\n".join(lines) + "\n\n" + (root / project["readme"]).read_text(encoding="utf-8")


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def _has_pybind11_of_debian():
    """Whether CMake finds Debian's pybind11 without help."""
    return any(pathlib.Path(f"/usr/{place}/cmake/pybind11").exists() for place in ("lib", "share"))


def _compile():
    """Compiles the module; returns the folder of the package with it."""
    build = pathlib.Path(os.environ.get("PHOTORQUE_BUILD", root / "build"))
    configure = ["cmake", "--preset", "release", "-B", str(build), "-DPHOTORQUE_PYTHON=ON"]
    # The base interpreter: that of a virtual environment may be gone when the build folder is used again.
    configure.append(f"-DPython_EXECUTABLE={sys._base_executable}")
    if not _has_pybind11_of_debian():
        import pybind11  # in pip's environment, which is removed after the build

        configure.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
    subprocess.run(configure, cwd=root, check=True)
    subprocess.run(["cmake", "--build", str(build), "--target", "photorque_python"], cwd=root, check=True)
    return build / "python" / "photorque"


def get_requires_for_build_wheel(config_settings=None):
    """Empty on a machine with Debian's pybind11, so that no package index is used."""
    return [] if _has_pybind11_of_debian() else ["pybind11>=2.10"]


def _wheel_text(tag):
    return f"Wheel-Version: 1.0\nGenerator: photorque\nRoot-Is-Purelib: false\nTag: {tag}\n"


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Metadata for an installer before the build; without this function it would build twice."""
    info = pathlib.Path(metadata_directory) / f"photorque-{_version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(_metadata(), encoding="utf-8")
    (info / "WHEEL").write_text(_wheel_text(_tag()), encoding="utf-8")
    return info.name


def module_files(package):
    """The module in the built `package` folder and its files: {name in the wheel: path}."""
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    return {f"photorque/{file.relative_to(package)}": file for file in sorted(package.rglob("*"))
            if file.name.endswith(suffix) or file.suffix in (".py", ".pyi", ".typed")}


def write_wheel(folder, files, tag, commands=()):
    """Packs {name: path} as a wheel with this tag into `folder`, and returns its name.

    `commands` are entry points, as "photorque = photorque.program:main"."""
    info = f"photorque-{_version()}.dist-info"
    texts = {f"{info}/METADATA": _metadata(), f"{info}/WHEEL": _wheel_text(tag),
             f"{info}/LICENSE": (root / "LICENSE").read_text(encoding="utf-8")}
    if commands:
        texts[f"{info}/entry_points.txt"] = "[console_scripts]\n" + "".join(f"{one}\n" for one in commands)
    record = ""
    name = f"photorque-{_version()}-{tag}.whl"
    with zipfile.ZipFile(pathlib.Path(folder) / name, "w", zipfile.ZIP_DEFLATED) as archive:

        def add(inside, content, mode=0o644):
            nonlocal record
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record += f"{inside},sha256={digest},{len(content)}\n"
            entry = zipfile.ZipInfo(inside, (2026, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100000 | mode) << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)

        for inside, path in files.items():
            add(inside, path.read_bytes(), 0o755 if os.access(path, os.X_OK) else 0o644)
        for inside, text in texts.items():
            add(inside, text.encode())
        archive.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return write_wheel(wheel_directory, module_files(_compile()), _tag())


def build_sdist(sdist_directory, config_settings=None):
    """Archive of all files that git tracks."""
    name = f"photorque-{_version()}"
    known = subprocess.run(["git", "ls-files"], cwd=root, check=True, capture_output=True, text=True)
    with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as archive:
        for file in known.stdout.splitlines():
            archive.add(root / file, f"{name}/{file}")
    return f"{name}.tar.gz"
