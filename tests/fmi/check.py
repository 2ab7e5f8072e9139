"""A co-simulation unit as an importer meets it: unpacked with Python's zipfile, its description
compared with the rules of FMI 3.0 (and 2.0), its library driven through ctypes by the signatures of the
standard. What it gives is what `propagate` writes for the same commands, to the bit.

    check.py PROGRAM

Source of the rules: Functional Mock-up Interface Specification 3.0 (10 May 2022), of the
Modelica Association: its chapters 2 (common) and 4 (co-simulation); likewise version 2.0.4 (1 December 2022).
"""

import csv
import ctypes
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile

program = pathlib.Path(sys.argv[1]).resolve()
failures = []


def expect(is_so, message):
    if not is_so:
        failures.append(message)


PLATFORM = """
[platform]
topology = "tabletop"
mass_kg = 8.0
inertia_kg_m2 = [[0.11, 0, 0], [0, 0.12, 0], [0, 0, 0.19]]
tilt_limit_deg = 6
[[disturbance]]
kind = "static_unbalance"
offset_m = [2e-6, -1e-6, -3e-5]
[[disturbance]]
kind = "floor_vibration"
acceleration_m_s2 = [5e-4, 5e-4, 1e-3]
frequency_Hz = 8
[[disturbance]]
kind = "bearing_drag"
coefficient_N_m_s = 1.5e-5
[sensors.camera]
noise_arcsec = [37, 37, 12]
rate_Hz = 80
latency_s = 0.02
[sensors.gyro]
noise_rad_s = 2e-4
bias_rad_s = [1e-4, 0, 0]
bias_drift = 1e-5
[serve]
rate_Hz = 160
max_torque_N_m = 0.05
[propagate]
duration_s = 1.5
initial_tilt_deg = 2
initial_rate_rad_s = [0.01, -0.005, 0.08]
initial_time_s = 0.5
"""
# A plate in sunlight whose corners are in a separate file.
LIT = """
[scene]
file = "models/plate.gltf"
[[source]]
kind = "sun"
irradiance_W_m2 = 1000
angular_radius_deg = 0.27
direction = [0.6, 0, -0.8]
[light]
tolerance = 0.01
rays = 4096
max_tilt_deg = 4
""" + PLATFORM
GLTF = """{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"name":"plate"}],
"materials":[{"name":"black","doubleSided":true,"extras":{"photorque":{"absorptance":1}}}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-0.2,0.1,-0.2],"max":[0.2,0.1,0.2]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
"buffers":[{"byteLength":60,"uri":"corners%20of%20it.bin"}]}
"""
CORNERS = struct.pack("<12f", -0.2, 0.1, -0.2, -0.2, 0.1, 0.2, 0.2, 0.1, 0.2, 0.2, 0.1, -0.2) + struct.pack(
    "<6H", 0, 1, 2, 0, 2, 3)


# The functions of FMI 3.0: its section 2.2 (common), 3.2 (model exchange), 4.2 (co-simulation), 5.2 (scheduled execution).
TYPES = ["Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Boolean", "String",
         "Binary", "Clock"]
FUNCTIONS = {f"fmi3{verb}{kind}" for verb in ("Get", "Set") for kind in TYPES} | {"fmi3" + name for name in """
GetVersion SetDebugLogging InstantiateModelExchange InstantiateCoSimulation InstantiateScheduledExecution FreeInstance
EnterInitializationMode ExitInitializationMode EnterEventMode Terminate Reset GetNumberOfVariableDependencies
GetVariableDependencies GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize SerializeFMUState DeserializeFMUState
GetDirectionalDerivative GetAdjointDerivative EnterConfigurationMode ExitConfigurationMode GetIntervalDecimal
GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction SetShiftDecimal SetShiftFraction
EvaluateDiscreteStates UpdateDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep SetTime SetContinuousStates
GetContinuousStateDerivatives GetEventIndicators GetContinuousStates GetNominalsOfContinuousStates
GetNumberOfEventIndicators GetNumberOfContinuousStates EnterStepMode GetOutputDerivatives DoStep ActivateModelPartition
""".split()}


# The functions of FMI 2.0: its sections 2.1 (common), 3.2 (model exchange) and 4.2 (co-simulation).
FUNCTIONS |= {f"fmi2{verb}{kind}" for verb in ("Get", "Set") for kind in ("Real", "Integer", "Boolean", "String")}
FUNCTIONS |= {"fmi2" + name for name in """
GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance SetupExperiment EnterInitializationMode
ExitInitializationMode Terminate Reset GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate
DeSerializeFMUstate GetDirectionalDerivative EnterEventMode NewDiscreteStates EnterContinuousTimeMode CompletedIntegratorStep
SetTime SetContinuousStates GetDerivatives GetEventIndicators GetContinuousStates GetNominalsOfContinuousStates
SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep GetStatus GetRealStatus GetIntegerStatus GetBooleanStatus
GetStringStatus""".split()}


def check_exports(library):
    """The library exports the standard's functions and nothing else, and holds no further symbols."""
    listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    exported = {line.split()[-1].split("@")[0] for line in listed.splitlines()}
    expect(exported == FUNCTIONS, f"exported: missing {FUNCTIONS - exported}, more {exported - FUNCTIONS}")
    inner = subprocess.run(["nm", library], capture_output=True, text=True, check=False)
    expect(not inner.stdout.strip(), f"{len(inner.stdout.splitlines())} symbols that strip would remove")


def run(*arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"photorque {' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def check_description(text):
    """modelDescription.xml; gives the variables by name."""
    root = ElementTree.fromstring(text)
    expect(root.tag == "fmiModelDescription" and root.get("fmiVersion") == "3.0", "the root")
    for name in ("modelName", "instantiationToken"):
        expect(root.get(name), f"{name} is required")
    # The elements and their order.
    order = ["ModelExchange", "CoSimulation", "ScheduledExecution", "UnitDefinitions", "TypeDefinitions",
             "LogCategories", "DefaultExperiment", "ModelVariables", "ModelStructure", "Annotations"]
    tags = [child.tag for child in root]
    expect(tags == sorted(set(tags), key=order.index), f"elements {tags}")
    kind = root.find("CoSimulation")
    expect(kind is not None and kind.get("modelIdentifier", "").isidentifier(), "modelIdentifier")
    known = {  # CoSimulation and what all interfaces have
        "modelIdentifier", "needsExecutionTool", "canBeInstantiatedOnlyOncePerProcess", "canGetAndSetFMUState",
        "canSerializeFMUState", "providesDirectionalDerivatives", "providesAdjointDerivatives",
        "providesPerElementDependencies", "canHandleVariableCommunicationStepSize", "fixedInternalStepSize",
        "maxOutputDerivativeOrder", "recommendedIntermediateInputSmoothness", "providesIntermediateUpdate",
        "mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate", "hasEventMode",
        "providesEvaluateDiscreteStates"}
    expect(set(kind.keys()) <= known, f"attributes {set(kind.keys()) - known}")
    units = {unit.get("name"): unit.find("BaseUnit").attrib for unit in root.find("UnitDefinitions")}
    # Exponents of SI units.
    expect(units.get("N.m") == {"kg": "1", "m": "2", "s": "-2"}, "newton metres")
    expect(units.get("rad/s") == {"rad": "1", "s": "-1"}, "rad/s")
    expect(units.get("W") == {"kg": "1", "m": "2", "s": "-3"}, "watts")
    variables = {}
    references = set()
    for one in root.find("ModelVariables"):
        name = one.get("name")
        expect(name not in variables, f"two variables {name}")
        variables[name] = one
        references.add(one.get("valueReference"))
        expect(one.get("unit") is None or one.get("unit") in units, f"unit of {name}")
        if one.get("causality") == "input":  # table of initial: an input has a start and no initial
            expect(one.get("start") is not None and one.get("initial") is None, f"start of {name}")
        if one.get("causality") == "output" and one.get("initial") == "calculated":
            expect(one.get("start") is None, f"{name} is calculated and has a start")
        if one.tag == "Boolean":
            expect(one.get("variability") == "discrete", f"{name} cannot be continuous")
        expect((name.endswith("N_m"), name.endswith("rad_s")) == (one.get("unit") == "N.m", one.get("unit") == "rad/s"),
               f"unit of {name}")
    expect(len(references) == len(variables), "references are not unique")
    independent = [one for one in variables.values() if one.get("causality") == "independent"]
    expect(len(independent) == 1 and independent[0].get("start") is None and independent[0].get("initial") is None,
           "exactly one independent variable, without start and initial")
    outputs = {one.get("valueReference") for one in variables.values() if one.get("causality") == "output"}
    structure = root.find("ModelStructure")
    for tag in ("Output", "InitialUnknown"):  # all of them, once
        listed = [one.get("valueReference") for one in structure.findall(tag)]
        expect(sorted(listed) == sorted(outputs), f"{tag} of the structure")
    return root, variables


def check_description2(text):
    """modelDescription.xml by the rules of FMI 2.0 (its section 2.2 and the schemas that it prints)."""
    root = ElementTree.fromstring(text)
    expect(root.tag == "fmiModelDescription" and root.get("fmiVersion") == "2.0", "the root of FMI 2.0")
    expect(root.get("modelName") and root.get("guid"), "modelName and guid")
    expect(set(root.keys()) <= {"fmiVersion", "modelName", "guid", "description", "author", "version", "copyright", "license",
                                "generationTool", "generationDateAndTime", "variableNamingConvention",
                                "numberOfEventIndicators"}, f"attributes {root.keys()}")
    order = ["ModelExchange", "CoSimulation", "UnitDefinitions", "TypeDefinitions", "LogCategories", "DefaultExperiment",
             "VendorAnnotations", "ModelVariables", "ModelStructure"]
    tags = [child.tag for child in root]
    expect(tags == sorted(set(tags), key=order.index), f"elements {tags}")
    kind = root.find("CoSimulation")
    expect(kind.get("modelIdentifier", "").isidentifier(), "modelIdentifier")
    expect(set(kind.keys()) <= {"modelIdentifier", "needsExecutionTool", "canHandleVariableCommunicationStepSize",
                                "canInterpolateInputs", "maxOutputDerivativeOrder", "canRunAsynchronuously",
                                "canBeInstantiatedOnlyOncePerProcess", "canNotUseMemoryManagementFunctions",
                                "canGetAndSetFMUstate", "canSerializeFMUstate", "providesDirectionalDerivative"},
           f"attributes {kind.keys()}")
    units = {unit.get("name") for unit in root.find("UnitDefinitions")}
    outputs, names = [], set()
    for index, one in enumerate(root.find("ModelVariables"), 1):
        expect(one.tag == "ScalarVariable" and len(one) == 1 and one[0].tag in ("Real", "Boolean"), one.get("name"))
        expect(set(one.keys()) <= {"name", "valueReference", "description", "causality", "variability", "initial"},
               f"attributes {one.keys()}")
        expect(one.get("name") not in names, f"two variables {one.get('name')}")
        names.add(one.get("name"))
        causality, has_start = one.get("causality"), one[0].get("start") is not None
        expect(has_start == (causality == "input"), f"start of {one.get('name')}")  # table of section 2.2.7
        expect(one.get("initial") == ("calculated" if causality == "output" else None), f"initial of {one.get('name')}")
        expect(one[0].tag == "Real" or one.get("variability") == "discrete", f"{one.get('name')} cannot be continuous")
        expect(one[0].get("unit") is None or one[0].get("unit") in units, f"unit of {one.get('name')}")
        if causality == "output":
            outputs.append(str(index))
    for name in ("Outputs", "InitialUnknowns"):
        listed = root.find("ModelStructure").find(name)
        expect([one.get("index") for one in listed] == outputs, f"{name} of the structure")
    return root


Log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
Log2 = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)


class Callbacks2(ctypes.Structure):
    _fields_ = [("logger", Log2), ("allocate", ctypes.c_void_p), ("free", ctypes.c_void_p), ("finished", ctypes.c_void_p),
                ("environment", ctypes.c_void_p)]


OK, WARNING, DISCARD, ERROR, FATAL = range(5)


class Unit:
    """An unpacked unit, by the signatures of the standard."""

    def __init__(self, folder, token=None):
        self.root = ElementTree.parse(folder / "modelDescription.xml").getroot()
        self.reference = {one.get("name"): int(one.get("valueReference")) for one in self.root.find("ModelVariables")}
        identifier = self.root.find("CoSimulation").get("modelIdentifier")
        self.shared_object = ctypes.CDLL(str(folder / "binaries" / "x86_64-linux" / (identifier + ".so")))
        self.shared_object.fmi3GetVersion.restype = ctypes.c_char_p
        self.shared_object.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
        self.said = []
        self.log = Log(lambda _, status, category, message: self.said.append((status, category.decode(), message.decode())))
        self.handle = self.shared_object.fmi3InstantiateCoSimulation(
            b"one", (token or self.root.get("instantiationToken")).encode(), (str(folder / "resources") + "/").encode(),
            ctypes.c_bool(False), ctypes.c_bool(True), ctypes.c_bool(False), ctypes.c_bool(False), None,
            ctypes.c_size_t(0), None, self.log, None)

    def call(self, name, *arguments):
        return getattr(self.shared_object, name)(ctypes.c_void_p(self.handle), *arguments)

    def initialise(self, start=0.5, stop=2.0):
        status = self.call("fmi3EnterInitializationMode", ctypes.c_bool(False), ctypes.c_double(0), ctypes.c_double(start),
                           ctypes.c_bool(stop is not None), ctypes.c_double(stop or 0))
        expect(status == OK, f"initialisation: {status} {self.said}")
        expect(self.call("fmi3ExitInitializationMode") == OK, "end of initialisation")

    def get(self, names):
        count = len(names)
        references = (ctypes.c_uint32 * count)(*(self.reference[name] for name in names))
        values = (ctypes.c_double * count)()
        status = self.call("fmi3GetFloat64", references, ctypes.c_size_t(count), values, ctypes.c_size_t(count))
        expect(status == OK, f"fmi3GetFloat64 {names}: {status}")
        return list(values)

    def flag(self, name):
        references, values = (ctypes.c_uint32 * 1)(self.reference[name]), (ctypes.c_bool * 1)()
        expect(self.call("fmi3GetBoolean", references, ctypes.c_size_t(1), values, ctypes.c_size_t(1)) == OK, name)
        return values[0]

    def command(self, torque):
        references = (ctypes.c_uint32 * 3)(*(self.reference[f"command_{axis}_N_m"] for axis in "xyz"))
        return self.call("fmi3SetFloat64", references, ctypes.c_size_t(3), (ctypes.c_double * 3)(*torque), ctypes.c_size_t(3))

    def step(self, time, length):
        flags = [ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool()]
        reached = ctypes.c_double()
        status = self.call("fmi3DoStep", ctypes.c_double(time), ctypes.c_double(length), ctypes.c_bool(False),
                           *(ctypes.byref(flag) for flag in flags), ctypes.byref(reached))
        return status, flags[1].value, reached.value


class Unit2:
    """An unpacked unit of FMI 2.0, by the signatures of its standard; used as Unit is."""

    def __init__(self, folder, guid=None, kind=1, location=None):
        self.root = ElementTree.parse(folder / "modelDescription.xml").getroot()
        self.reference = {one.get("name"): int(one.get("valueReference")) for one in self.root.find("ModelVariables")}
        self.shared_object = ctypes.CDLL(str(folder / "binaries" / "linux64" / "photorque.so"))
        for name, result in (("GetVersion", ctypes.c_char_p), ("GetTypesPlatform", ctypes.c_char_p), ("Instantiate", ctypes.c_void_p)):
            getattr(self.shared_object, "fmi2" + name).restype = result
        self.said = []
        self.callbacks = Callbacks2(logger=Log2(
            lambda _, name, status, category, message: self.said.append((status, category.decode(), message.decode()))))
        self.handle = self.shared_object.fmi2Instantiate(
            b"one", kind, (guid or self.root.get("guid")).encode(), (location or (folder / "resources").as_uri()).encode(),
            ctypes.byref(self.callbacks), 0, 1)

    call = Unit.call

    def initialise(self, start=0.5, stop=2.0):
        status = self.call("fmi2SetupExperiment", 0, ctypes.c_double(0), ctypes.c_double(start), 1, ctypes.c_double(stop))
        expect(status == OK and self.call("fmi2EnterInitializationMode") == OK, f"initialisation: {self.said}")
        expect(self.call("fmi2ExitInitializationMode") == OK, "end of initialisation")

    def references(self, names):
        return (ctypes.c_uint * len(names))(*(self.reference[name] for name in names)), ctypes.c_size_t(len(names))

    def get(self, names):
        values = (ctypes.c_double * len(names))()
        expect(self.call("fmi2GetReal", *self.references(names), values) == OK, f"fmi2GetReal {names}")
        return list(values)

    def flag(self, name):
        values = (ctypes.c_int * 1)()
        expect(self.call("fmi2GetBoolean", *self.references([name]), values) == OK, name)
        return bool(values[0])

    def command(self, torque):
        names = [f"command_{axis}_N_m" for axis in "xyz"]
        return self.call("fmi2SetReal", *self.references(names), (ctypes.c_double * 3)(*torque))

    def step(self, time, length):
        status = self.call("fmi2DoStep", ctypes.c_double(time), ctypes.c_double(length), 1)
        ended, reached = ctypes.c_int(), ctypes.c_double()
        self.call("fmi2GetBooleanStatus", 3, ctypes.byref(ended))  # fmi2Terminated
        self.call("fmi2GetRealStatus", 2, ctypes.byref(reached))  # fmi2LastSuccessfulTime
        return status, bool(ended.value), reached.value


def check_version2(folder, rows):
    check_description2((folder / "modelDescription.xml").read_text(encoding="utf-8"))
    check_exports(folder / "binaries" / "linux64" / "photorque.so")
    unit = Unit2(folder)
    expect(unit.handle, f"instantiation of FMI 2.0: {unit.said}")
    expect(unit.shared_object.fmi2GetVersion() == b"2.0" and unit.shared_object.fmi2GetTypesPlatform() == b"default", "versions")
    expect(unit.step(0.5, 0.1)[0] == ERROR, "a step before initialisation")
    unit.initialise()
    expect(drive(unit, 60) == rows[:60] + [(*rows[60][:2], None, rows[60][3])], "FMI 2.0 gives what FMI 3.0 gives")
    state, size, again = ctypes.c_void_p(), ctypes.c_size_t(), ctypes.c_void_p()
    expect(unit.call("fmi2GetFMUstate", ctypes.byref(state)) == OK, "fmi2GetFMUstate")
    on = drive(unit, 15, first=60)
    expect(unit.call("fmi2SerializedFMUstateSize", state, ctypes.byref(size)) == OK, "size of a state")
    stored = (ctypes.c_char * size.value)()
    expect(unit.call("fmi2SerializeFMUstate", state, stored, size) == OK, "fmi2SerializeFMUstate")
    expect(unit.call("fmi2DeSerializeFMUstate", stored, size, ctypes.byref(again)) == OK, "fmi2DeSerializeFMUstate")
    expect(unit.call("fmi2SetFMUstate", again) == OK and drive(unit, 15, first=60) == on, "the run after a state was set")
    for held in (state, again):
        expect(unit.call("fmi2FreeFMUstate", ctypes.byref(held)) == OK and held.value is None, "fmi2FreeFMUstate")
    expect(unit.command([0.06, 0, 0]) == DISCARD, "a torque too large")
    for name in ("fmi2GetInteger", "fmi2SetTime", "fmi2GetDerivatives", "fmi2CancelStep"):
        expect(unit.call(name) == ERROR and name in unit.said[-1][2], f"{name} is not offered")
    expect(unit.call("fmi2Terminate") == OK and unit.call("fmi2Reset") == OK, "fmi2Reset")
    unit.initialise()
    unit.command([0.05, 0.0, 0.0])
    status, ended, reached = unit.step(0.5, 1.5)  # the stop of the bearing
    expect(status == DISCARD and ended and 0.5 < reached < 2.0, f"the stop at 6 deg: {status} {ended} {reached}")
    unit.call("fmi2FreeInstance")
    spaced = folder.parent / "a folder with 100% spaces"
    spaced.symlink_to(folder)
    unit = Unit2(spaced)
    expect(unit.handle, f"a location with escapes: {unit.said}")
    unit.call("fmi2FreeInstance")
    expect(Unit2(folder, location="file:" + str(folder / "resources")).handle, "a location with one slash")
    for stranger in (Unit2(folder, guid="{of 100% another}"), Unit2(folder, kind=0), Unit2(folder, location="file:///nowhere")):
        expect(stranger.handle is None and stranger.said and stranger.said[0][0] == ERROR, "what cannot be instantiated")
    # Messages are formats of printf.
    expect("100%% another" in Unit2(folder, guid="{of 100% another}").said[0][2], "the percent sign of a message")


READINGS = ["q_w", "q_x", "q_y", "q_z", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"]
TRUTH = ["true_q_w", "true_q_x", "true_q_y", "true_q_z"]


def torque_at(tick, readings):
    sign = 1 if tick % 50 < 25 else -1
    return [-0.01 * readings[4], -0.01 * readings[5], sign * 1e-4]


def drive(unit, ticks, start=0.5, ticks_a_step=1, first=0):
    """Closes a loop; gives readings, truth and command of every communication point."""
    rows = []
    for tick in range(first, first + ticks, ticks_a_step):
        readings = unit.get(READINGS)
        torque = torque_at(tick, readings)
        expect(unit.command(torque) == OK, "fmi3SetFloat64")
        rows.append((readings, unit.get(TRUTH), torque, unit.flag("camera_is_new")))
        time = start + tick / 160
        status, ended, reached = unit.step(time, ticks_a_step / 160)
        expect(status == OK and not ended and abs(reached - time - ticks_a_step / 160) < 1e-12, f"step {tick}: {unit.said}")
    rows.append((unit.get(READINGS), unit.get(TRUTH), None, unit.flag("camera_is_new")))
    return rows


def recording(path):
    lines = [line for line in open(path, encoding="utf-8") if not line.startswith("#")]
    return [{key: float(value) if value else math.nan for key, value in row.items()} for row in csv.DictReader(lines)]


def check_equal_to_propagate(place, experiment, rows):
    with open(place / "commands.csv", "w", encoding="utf-8") as file:
        file.write("t_s,command_x_N_m,command_y_N_m,command_z_N_m\n")
        for tick, row in enumerate(rows[:-1]):
            file.write(",".join(repr(value) for value in [0.5 + tick / 160, *row[2]]) + "\n")
    out = place / "propagated"
    run("propagate", experiment, "--set", "propagate.tick_rate_Hz=160", "--set", "propagate.output_rate_Hz=160", "--set",
        f'propagate.commands="{place}/commands.csv"', "--out", out, "--quiet")
    recorded, history = recording(out / "recording.csv"), recording(out / "time_history.csv")
    expect(len(recorded) == len(rows), f"{len(rows)} points, {len(recorded)} rows")
    held = None
    for i, (readings, truth, _, is_new) in enumerate(rows):
        seen = [recorded[i][name] for name in READINGS[:4]]
        expect(is_new == (not math.isnan(seen[0])), f"row {i}: whether the camera has read")
        held = seen if is_new else held
        expect(readings[:4] == held, f"row {i}: attitude {readings[:4]}, recorded {held}")
        expect(readings[4:] == [recorded[i][name] for name in READINGS[4:]], f"row {i}: gyro")
        expect(truth == [history[i][name] for name in ("q_w", "q_x", "q_y", "q_z")], f"row {i}: the true attitude")


def check_states(folder):
    unit = Unit(folder)
    unit.initialise()
    drive(unit, 20)
    state = ctypes.c_void_p()
    expect(unit.call("fmi3GetFMUState", ctypes.byref(state)) == OK, "fmi3GetFMUState")
    on = drive(unit, 15, first=20)
    size = ctypes.c_size_t()
    expect(unit.call("fmi3SerializedFMUStateSize", state, ctypes.byref(size)) == OK, "size of a state")
    stored = (ctypes.c_uint8 * size.value)()
    expect(unit.call("fmi3SerializeFMUState", state, stored, size) == OK, "fmi3SerializeFMUState")
    expect(unit.call("fmi3SetFMUState", state) == OK, "fmi3SetFMUState")
    expect(drive(unit, 15, first=20) == on, "the run after a state was set")
    other = Unit(folder)
    again = ctypes.c_void_p()
    expect(other.call("fmi3DeserializeFMUState", stored, size, ctypes.byref(again)) == OK, "fmi3DeserializeFMUState")
    ended = ctypes.create_string_buffer(bytes(stored))  # as a text: one byte more, which is zero
    as_text = ctypes.c_void_p()
    expect(
        other.call("fmi3DeserializeFMUState", ended, ctypes.c_size_t(size.value + 1), ctypes.byref(as_text)) == OK,
        "a state as a text",
    )
    other.call("fmi3FreeFMUState", ctypes.byref(as_text))
    expect(other.call("fmi3SetFMUState", again) == OK, "a state of another instance")
    expect(drive(other, 15, first=20) == on, "the run of another instance from a state")
    stored[7] = 0x7f  # a mode of 1e300
    expect(other.call("fmi3DeserializeFMUState", stored, size, ctypes.byref(again)) == ERROR, "a damaged state")
    for one, held in ((unit, state), (other, again)):
        one.call("fmi3FreeFMUState", ctypes.byref(held))
        one.call("fmi3FreeInstance")


def check_refusals(folder):
    stranger = Unit(folder, token="{of another unit}")
    expect(stranger.handle is None and stranger.said and stranger.said[0][0] == ERROR, "a wrong token")
    unit = Unit(folder)
    expect(unit.shared_object.fmi3GetVersion() == b"3.0", "fmi3GetVersion")
    expect(unit.step(0.5, 0.1)[0] == ERROR, "a step before initialisation")
    unit.initialise()
    expect(unit.command([0.06, 0, 0]) == DISCARD and unit.said[-1][1] == "logStatusDiscard", "a torque too large")
    expect(unit.command([math.nan, 0, 0]) == DISCARD, "a torque that is no number")
    expect(unit.get(["command_x_N_m"]) == [0.0], "what was refused does not act")
    expect(unit.step(0.7, 0.1)[0] == ERROR and "0.7" in unit.said[-1][2], "a step from elsewhere")
    expect(unit.step(0.5, 2.0)[0] == ERROR, "a step beyond the end")
    for name in ("fmi3GetInt32", "fmi3SetTime", "fmi3CompletedIntegratorStep", "fmi3GetNumberOfContinuousStates"):
        expect(unit.call(name) == ERROR, f"{name} is not offered")
    for name, callbacks in (("fmi3InstantiateModelExchange", 0), ("fmi3InstantiateScheduledExecution", 3)):
        instantiate = getattr(unit.shared_object, name)
        instantiate.restype = ctypes.c_void_p
        made = instantiate(b"one", b"{}", b"", ctypes.c_bool(False), ctypes.c_bool(True), None, unit.log, *[None] * callbacks)
        expect(made is None and unit.said[-1][0] == ERROR and name in unit.said[-1][2], f"{name}: {unit.said[-1]}")
    # Communication steps of any length: the outputs are those of the last tick.
    status, _, reached = unit.step(0.5, 0.01)
    expect(status == OK and reached == 0.51, "a step of 1.6 ticks")
    first = unit.get(TRUTH)
    unit.step(0.51, 0.5025 - 0.5)
    expect(unit.get(TRUTH) != first and unit.get(["time"]) == [0.51 + 0.5025 - 0.5], "two ticks after 2 ticks")
    expect(unit.call("fmi3Terminate") == OK and unit.call("fmi3Reset") == OK, "fmi3Reset")
    unit.initialise()
    expect(unit.get(TRUTH) != first, "back at the start")
    # The bearing's stop ends the run, which the importer receives.
    unit.command([0.05, 0.0, 0.0])
    status, ended, reached = unit.step(0.5, 1.5)
    expect(status == OK and ended and 0.5 < reached < 2.0, f"the stop at 6 deg: {status} {ended} {reached}")
    unit.call("fmi3FreeInstance")


with tempfile.TemporaryDirectory() as name:
    place = pathlib.Path(name)
    (place / "models").mkdir()
    (place / "models" / "plate.gltf").write_text(GLTF, encoding="utf-8")
    (place / "models" / "corners of it.bin").write_bytes(CORNERS)
    for title, text in (("platform", PLATFORM), ("lit", LIT)):
        experiment = place / f"{title}.toml"
        experiment.write_text(text, encoding="utf-8")
        run("fmu", experiment, "--out", place / title, "--quiet")
        folder = place / f"{title}_unpacked"
        with zipfile.ZipFile(place / title / f"{title}.fmu") as archive:
            expect(archive.testzip() is None, "the archive")
            archive.extractall(folder)
        check_exports(folder / "binaries" / "x86_64-linux" / "photorque.so")
        check_description((folder / "modelDescription.xml").read_text(encoding="utf-8"))
        unit = Unit(folder)
        expect(unit.handle, f"instantiation: {unit.said}")
        unit.initialise()
        rows = drive(unit, 240)
        unit.call("fmi3FreeInstance")
        if title == "lit":
            # The table came with the unit, in a folder that an importer may not write to.
            expect(any("stored by an earlier run" in message for _, _, message in unit.said), f"the table: {unit.said}")
        check_equal_to_propagate(place, experiment, rows)
        if title == "platform":
            # Three ticks a step: commands act for three ticks.
            unit = Unit(folder)
            unit.initialise()
            slower = drive(unit, 240, ticks_a_step=3)
            unit.call("fmi3FreeInstance")
            expect(len(slower) == 81 and slower[0] == rows[0] and slower[-1][1] != rows[-1][1], "steps of three ticks")
            check_states(folder)
            check_refusals(folder)
            run("fmu", experiment, "--fmi", "2", "--out", place / "version2", "--quiet")
            with zipfile.ZipFile(place / "version2" / "platform.fmu") as archive:
                archive.extractall(place / "version2_unpacked")
            check_version2(place / "version2_unpacked", rows)

for failure in failures[:20]:
    print("wrong:", failure)
print(f"{len(failures)} failed")
sys.exit(1 if failures else 0)
