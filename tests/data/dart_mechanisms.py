#!/usr/bin/env python3
"""Makes recordings of mechanisms whose motion comes from DART 6.12 (Debian: python3-dartpy), in the form of given cases.

    tests/data/dart_mechanisms.py OUT SEED [NAME ...] [--short]

Each folder holds experiment.toml, run1.csv.gz, run2.csv.gz and truth.json (verdict, effects, accept). Bodies, joints, springs and
Coulomb friction are those of DART; dipole, steady torque and air drag are external torques. Steps of 0.2 and 0.1 ms (semi-implicit
Euler) are extrapolated. `--short` makes 120 s at 10 Hz instead of 240 s at 20 Hz; tests/data/cases/appendage and deflected are
`appendage_0 ringing_1 --short` of seed 1. `tools/prove docs/proof.toml --cases OUT --out SCORES` scores the answers of a program.
"""

import gzip
import json
import pathlib
import sys

import dartpy as dart
import numpy as np

G = 9.80665
FIELD_T = np.array([1e-6, 2.1e-5, -4.1e-5])
STEP_S = 2e-4
SHORT = "--short" in sys.argv


def matrix(rows):
    return [[float(x) for x in row] for row in rows]


class Mechanism:
    """A body on a ball joint, a hinge or free, with hinged parts."""

    def __init__(self, joint, axis=None):
        self.skeleton = dart.dynamics.Skeleton("s")
        self.joint_kind = joint
        if joint == "ball":
            self.joint, self.body = self.skeleton.createBallJointAndBodyNodePair()
        elif joint == "hinge":
            self.joint, self.body = self.skeleton.createRevoluteJointAndBodyNodePair()
            self.joint.setAxis(axis)
        else:
            self.joint, self.body = self.skeleton.createFreeJointAndBodyNodePair()
        self.parts = []

    @staticmethod
    def fill(body, mass, centre, about_centre):
        i = about_centre
        body.setInertia(dart.dynamics.Inertia(mass, centre, i))

    def add(self, place, axis, mass, centre, about_centre, stiffness=0.0, damping=0.0, angle=0.0, speed=0.0):
        joint, body = self.skeleton.createRevoluteJointAndBodyNodePair(self.body)
        joint.setAxis(axis)
        move = dart.math.Isometry3()
        move.set_translation(place)
        joint.setTransformFromParentBodyNode(move)
        self.fill(body, mass, centre, about_centre)
        joint.setSpringStiffness(0, stiffness)
        joint.setRestPosition(0, 0.0)
        joint.setDampingCoefficient(0, damping)
        joint.setPosition(0, angle)
        joint.setVelocity(0, speed)
        self.parts.append((joint, body, place, mass, centre, about_centre))
        return joint

    def whole(self, mass, centre, about_centre):
        """Mass, centre of mass and inertia about the origin, of all bodies with joints at rest."""
        total, moment = mass, mass * centre
        inertia = about_centre + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        for _, _, place, m, c, i in self.parts:
            at = place + c
            total += m
            moment = moment + m * at
            inertia = inertia + i + m * (at @ at * np.eye(3) - np.outer(at, at))
        return total, moment / total, inertia


def quaternion(rotation):
    q = np.empty(4)
    m = rotation
    trace = np.trace(m)
    if trace > 0:
        s = 2 * np.sqrt(1 + trace)
        q[:] = [s / 4, (m[2, 1] - m[1, 2]) / s, (m[0, 2] - m[2, 0]) / s, (m[1, 0] - m[0, 1]) / s]
    else:
        k = int(np.argmax(np.diag(m)))
        a, b = (k + 1) % 3, (k + 2) % 3
        s = 2 * np.sqrt(1 + m[k, k] - m[a, a] - m[b, b])
        q[0] = (m[b, a] - m[a, b]) / s
        q[1 + k], q[1 + a], q[1 + b] = s / 4, (m[a, k] + m[k, a]) / s, (m[b, k] + m[k, b]) / s
    return q / np.linalg.norm(q)


def rotated(vector):
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    k = vector / angle
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def run(mechanism, duration_s, every_s, act=None, gravity=None, free_fall=False, step_s=STEP_S):
    """Times, rotation matrices and body rates (or angle and rate) at the readings."""
    world = dart.simulation.World()
    world.setTimeStep(step_s)
    world.setGravity([0, 0, 0.0 if free_fall else -G])
    world.addSkeleton(mechanism.skeleton)
    per = round(every_s / step_s)
    steps = round(duration_s / step_s)
    times, attitudes, rates = [], [], []
    body, joint = mechanism.body, mechanism.joint
    hinge = mechanism.joint_kind == "hinge"
    for k in range(steps + 1):
        if k % per == 0:
            times.append(k * step_s)
            if hinge:
                attitudes.append(joint.getPosition(0))
                rates.append(joint.getVelocity(0))
            else:
                r = body.getTransform().rotation()
                attitudes.append(np.array(r))
                rates.append(r.T @ body.getAngularVelocity())
        if gravity:
            world.setGravity(gravity(k * step_s))
        if act:
            act(k * step_s, body, joint)
        world.step()
    return np.array(times), attitudes, np.array(rates)


def turn_of(rotation):
    """Rotation vector of a small rotation."""
    return 0.5 * np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])


def extrapolated(mechanism, act, duration_s, every_s, **how):
    """run() with steps of STEP_S and half of it, extrapolated to none: the error is then of second order."""
    q, v = mechanism.skeleton.getPositions(), mechanism.skeleton.getVelocities()
    times, coarse, coarse_rates = run(mechanism, duration_s, every_s, act, step_s=STEP_S, **how)
    mechanism.skeleton.setPositions(q)
    mechanism.skeleton.setVelocities(v)
    _, fine, fine_rates = run(mechanism, duration_s, every_s, act, step_s=0.5 * STEP_S, **how)
    if mechanism.joint_kind == "hinge":
        attitudes = [2 * b - a for a, b in zip(coarse, fine)]
    else:
        attitudes = [b @ rotated(turn_of(a.T @ b)) for a, b in zip(coarse, fine)]
    return times, attitudes, 2 * fine_rates - coarse_rates


class Case:
    def __init__(self, out, name, rng):
        self.folder = pathlib.Path(out) / name
        self.folder.mkdir(parents=True, exist_ok=True)
        self.name, self.rng = name, rng

    def write_runs(self, make, duration_s=240.0, every_s=0.05, late_s=0.0, **how):
        """`make` returns a mechanism and its act; two runs of it. Camera 37, 37, 12 arcsec about lab axes."""
        if SHORT:
            duration_s, every_s = 120.0, 0.1
        bias = 1e-3 * self.rng.standard_normal(3)
        for file in ("run1.csv.gz", "run2.csv.gz"):
            mechanism, act = make()
            times, attitudes, rates = extrapolated(mechanism, act, duration_s, every_s, **how)
            lines = []
            if mechanism.joint_kind == "hinge":
                lines.append("t_s,angle_rad,rate_rad_s")
                for t, a, w in zip(times, attitudes, rates):
                    a += np.radians(20 / 3600) * self.rng.standard_normal()
                    w += bias[0] * 0.1 + 2e-4 * self.rng.standard_normal()
                    lines.append(f"{t:.4f},{a:.9f},{w:.8e}")
            else:
                if late_s > 0:
                    shift = round(late_s / every_s)
                    assert abs(shift * every_s - late_s) < 1e-9
                    attitudes = attitudes[:1] * shift + attitudes[: len(attitudes) - shift]
                    times, attitudes, rates = times[shift:], attitudes[shift:], rates[shift:]
                lines.append("t_s,q_w,q_x,q_y,q_z,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s")
                noise = np.radians(np.array([37, 37, 12]) / 3600)
                for t, r, w in zip(times, attitudes, rates):
                    q = quaternion(rotated(noise * self.rng.standard_normal(3)) @ r)
                    w = w + bias + 2e-4 * self.rng.standard_normal(3)
                    lines.append(f"{t - times[0]:.4f}," + ",".join(f"{x:.9f}" for x in q) + "," + ",".join(f"{x:.7e}" for x in w))
            with gzip.open(self.folder / file, "wt") as out:
                out.write("\n".join(lines) + "\n")

    def write_truth(self, verdict, effects, accept, accept_verdicts=None):
        truth = {"name": self.name, "verdict": verdict, "effects": effects, "accept": accept,
                 "accept_verdicts": accept_verdicts or [verdict], "below_detection": False, "depends_on": [], "oracle": False}  # fmt: skip
        (self.folder / "truth.json").write_text(json.dumps(truth, indent=1))

    def write_experiment(self, topology, mass, centre, inertia, drag=None, axis=None, offset_sigma=(1.4e-5, 1.4e-5, 5.5e-5)):
        rng = self.rng
        lines = ["[platform]", f'topology = "{topology}"', f"mass_kg = {mass:.7f}",
                 "inertia_kg_m2 = " + json.dumps([[round(x, 10) for x in row] for row in matrix(inertia)])]
        if axis:
            lines.append(f'axis = "{axis}"')
        if topology != "free":
            lines += ["", "[environment]", f"gravity_m_s2 = {G}"]
            if topology != "one_axis":
                lines += [f"magnetic_field_T = {[float(x) for x in FIELD_T]}", "latitude_deg = 45.5"]
            if centre is not None:
                sigma = np.array(offset_sigma)
                guess = centre + sigma * rng.standard_normal(3)
                lines += ["", "[[disturbance]]", 'kind = "static_unbalance"',
                          f"offset_m = {{ value = {[float(x) for x in guess]}, sigma = {[float(x) for x in sigma]} }}"]
        if drag:
            guess = drag * (1 + 0.15 * rng.standard_normal())
            lines += ["", "[[disturbance]]", 'kind = "bearing_drag"',
                      f"coefficient_N_m_s = {{ value = {guess:.9g}, sigma = {0.15 * drag:.3g} }}"]
        if topology == "one_axis":
            lines += ["", "[sensors.angle]", "noise_arcsec = 20"]
        else:
            lines += ["", "[sensors.camera]", "noise_arcsec = [37, 37, 12]"]
        lines += ["", "[sensors.gyro]", "noise_rad_s = 0.0002", "bias_rad_s = { value = [0, 0, 0], sigma = [1e-3, 1e-3, 1e-3] }", ""]
        (self.folder / "experiment.toml").write_text("\n".join(lines))


def unit(rng):
    v = rng.standard_normal(3)
    return v / np.linalg.norm(v)


def positive_inertia(rng, scale):
    """Of a random cloud of points: any possible moments."""
    points = rng.standard_normal((12, 3)) * rng.uniform(0.6, 1.4, 3)
    points -= points.mean(axis=0)
    i = sum((p @ p * np.eye(3) - np.outer(p, p)) for p in points)
    return scale * i / (np.trace(i) / 3)


def supported(case, parts, extra=None, late_s=0.0, gravity=None, effects=None, accept=None, verdicts=None, stiffness=0.0, drag_known=True):
    """A platform on a ball joint with drag; `parts` add hinged bodies."""
    rng = case.rng
    mass = rng.uniform(4, 9)
    base = rotated(0.03 * rng.standard_normal(3)) @ np.diag([0.11, 0.12, 0.19]) * rng.uniform(0.5, 1.2) @ rotated(np.zeros(3))
    base = 0.5 * (base + base.T)
    drag = rng.uniform(1e-5, 4e-5)
    specs = parts(rng, base)
    offset = np.array([rng.normal(0, 3e-5), rng.normal(0, 3e-5), -rng.uniform(4e-4, 1e-3)])
    probe = Mechanism("ball")
    for s in specs:
        probe.add(**s)
    # The body's own centre of mass, so that that of the whole is `offset`.
    total = mass + sum(s["mass"] for s in specs)
    centre = (total * offset - sum((s["mass"] * (s["place"] + s["centre"]) for s in specs), np.zeros(3))) / mass
    m, c, inertia = probe.whole(mass, centre, base)

    def make():
        mechanism = Mechanism("ball")
        mechanism.fill(mechanism.body, mass, centre, base)
        for s in specs:
            mechanism.add(**s)
        joint = mechanism.joint
        joint.setPositions(np.append(rng.normal(0, 0.06, 2), 0.0))
        joint.setVelocities(np.array([rng.normal(0, 0.03), rng.normal(0, 0.03), rng.normal(0, 0.08)]))
        for k in range(3):
            joint.setDampingCoefficient(k, drag)
            joint.setSpringStiffness(k, stiffness)
            joint.setRestPosition(k, 0.0)
        return mechanism, extra
    case.write_runs(make, late_s=late_s, gravity=gravity)
    case.write_experiment("tabletop", m, c, inertia, drag)
    case.write_truth("missing_physics" if effects(specs) else "consistent", effects(specs), accept, verdicts)


def mode_of(s):
    """flexible_mode of a balanced hinged part."""
    coupling = s["about_centre"] @ s["axis"]
    j = s["axis"] @ coupling
    return {"kind": "flexible_mode", "axis": list(coupling / np.linalg.norm(coupling)),
            "frequency_Hz": float(np.sqrt(s["stiffness"] / j) / (2 * np.pi)), "damping": float(s["damping"] / (2 * np.sqrt(s["stiffness"] * j))),
            "inertia_kg_m2": float(coupling @ coupling / j)}  # fmt: skip


def appendage(rng, base, low_Hz=0.3, high_Hz=1.5, angle=0.0):
    axis = unit(rng)
    inertia = positive_inertia(rng, np.trace(base) / 3 * rng.uniform(0.04, 0.12))
    j = axis @ inertia @ axis
    k = j * (2 * np.pi * rng.uniform(low_Hz, high_Hz)) ** 2
    return dict(place=np.array([0, 0, rng.uniform(0, 0.08)]), axis=axis, mass=rng.uniform(0.2, 0.6), centre=np.zeros(3),
                about_centre=inertia, stiffness=k, damping=2 * rng.uniform(0.003, 0.02) * np.sqrt(k * j), angle=angle)  # fmt: skip


def spacecraft(case, kind):
    rng = case.rng
    mass = rng.uniform(5, 15)
    base = positive_inertia(rng, rng.uniform(0.1, 0.4))
    specs, effects, accept, verdicts = [], [], [[]], ["missing_physics"]
    if kind == "panel":
        j = rng.uniform(0.01, 0.03)
        k = j * (2 * np.pi * rng.uniform(0.4, 1.2)) ** 2
        axis = np.array([0.0, 1.0, 0.0])
        m = rng.uniform(0.1, 0.3)
        arm = np.array([np.sqrt(j / m) * 0.8, 0, 0])
        own = np.diag([0.1 * j, j - m * arm @ arm, j - m * arm @ arm + 0.1 * j])
        specs = [dict(place=np.array([0.15, 0, 0]), axis=axis, mass=m, centre=arm, about_centre=own, stiffness=k,
                      damping=2 * rng.uniform(0.005, 0.02) * np.sqrt(k * j))]  # fmt: skip
        effects = [{"kind": "flexible_mode", "axis": [0, 1, 0], "frequency_Hz": float(np.sqrt(k / j) / 2 / np.pi)}]
        accept, verdicts = [["flexible_mode"], ["flexible_mode", "inertia_error"], []], ["missing_physics", "unexplained"]
    probe = Mechanism("free")
    for s in specs:
        probe.add(**s)
    centre = -sum((s["mass"] * (s["place"] + s["centre"]) for s in specs), np.zeros(3)) / mass
    m, c, inertia = probe.whole(mass, centre, base)
    nominal = inertia
    if kind == "inertia":
        wrong = rotated(rng.normal(0, 0.06, 3))
        nominal = wrong @ inertia @ wrong.T
        effects, accept = [{"kind": "inertia_error"}], [["inertia_error"]]

    def make():
        mechanism = Mechanism("free")
        mechanism.fill(mechanism.body, mass, centre, base)
        for s in specs:
            mechanism.add(**s)
        q = mechanism.joint.getPositions()
        q[:3] = rng.normal(0, 0.5, 3)
        mechanism.joint.setPositions(q)
        v = mechanism.joint.getVelocities()
        v[:3] = rng.normal(0, 0.12, 3)
        mechanism.joint.setVelocities(v)
        return mechanism, None
    case.write_runs(make, duration_s=200.0, free_fall=True)
    case.write_experiment("free", m, None, nominal)
    case.write_truth("missing_physics" if effects else "consistent", effects, accept, verdicts if effects else ["consistent"])


def hinge(case, kind):
    rng = case.rng
    axis = np.array([1.0, 0, 0])
    mass = rng.uniform(1, 3)
    about = np.diag([0.057, 0.06, 0.02]) * rng.uniform(0.7, 1.3)
    arm = np.array([0, 0, -rng.uniform(0.01, 0.03)])
    inertia = about + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    drag = rng.uniform(4e-5, 8e-5)
    dry = rng.uniform(5e-5, 3e-4) if "dry" in kind else 0.0
    air = rng.uniform(2e-4, 6e-4) if "air" in kind else 0.0
    if kind == "wheel dry air":
        arm = np.zeros(3)
        inertia = about

    def act(t, body, joint):
        if air:
            w = joint.getVelocity(0)
            joint.setForce(0, -air * abs(w) * w)

    def make():
        mechanism = Mechanism("hinge", axis)
        mechanism.fill(mechanism.body, mass, arm, about)
        mechanism.joint.setDampingCoefficient(0, drag)
        if dry:
            mechanism.joint.setCoulombFriction(0, dry)
        if kind == "wheel dry air":
            mechanism.joint.setVelocity(0, rng.uniform(8, 20))
        else:
            mechanism.joint.setPosition(0, rng.uniform(0.3, 0.8))
        return mechanism, act if air else None
    case.write_runs(make, duration_s=200.0)
    case.write_experiment("one_axis", mass, arm if arm.any() else None, inertia, drag, axis="x", offset_sigma=(0, 2e-4, 1e-3))
    kinds = (["dry_friction"] if dry else []) + (["air_pressure_drag"] if air else [])
    effects = []
    if dry:
        effects.append({"kind": "dry_friction", "torque_N_m": dry})
    if air:
        effects.append({"kind": "air_pressure_drag", "coefficient_N_m_s2": air})
    case.write_truth("missing_physics" if kinds else "consistent", effects, [kinds])


def dipole_torque(moment):
    def act(_t, body, _joint):
        r = body.getTransform().rotation()
        body.addExtTorque(np.cross(r @ moment, FIELD_T), False)
    return act


def make_all(out, seed, names):
    def of(name):
        return not names or name in names
    cases = {}
    for i in range(2):
        cases[f"none_{i}"] = lambda c: supported(c, lambda r, b: [], effects=lambda s: [], accept=[[]])
    for i in range(6):
        cases[f"appendage_{i}"] = lambda c: supported(c, lambda r, b: [appendage(r, b)], effects=lambda s: [mode_of(s[0])], accept=[["flexible_mode"]])
    for i in range(2):
        cases[f"ringing_{i}"] = lambda c: supported(c, lambda r, b: [appendage(r, b, angle=0.05)], effects=lambda s: [mode_of(s[0])], accept=[["flexible_mode"]])
    for i in range(2):
        cases[f"two_{i}"] = lambda c: supported(c, lambda r, b: [appendage(r, b, 0.3, 0.6), appendage(r, b, 0.9, 1.6)],
                                                effects=lambda s: [mode_of(x) for x in s], accept=[["flexible_mode", "flexible_mode"]])  # fmt: skip
    for i in range(2):
        def with_dipole(c):
            moment = c.rng.normal(0, 0.02, 3)
            supported(c, lambda r, b: [appendage(r, b)], extra=dipole_torque(moment), accept=[["flexible_mode", "magnetic_dipole"]],
                      effects=lambda s: [mode_of(s[0]), {"kind": "magnetic_dipole", "dipole_A_m2": list(moment)}])  # fmt: skip
        cases[f"dipole_{i}"] = with_dipole
    for i in range(2):
        def late(c):
            torque = c.rng.choice([-1, 1]) * c.rng.uniform(6e-7, 2e-6)
            def act(_t, body, _joint):
                body.addExtTorque(np.array([0, 0, torque]), False)
            supported(c, lambda r, b: [appendage(r, b)], extra=act, late_s=0.1, accept=[["flexible_mode", "turbine_torque", "attitude_latency"]],
                      effects=lambda s: [mode_of(s[0]), {"kind": "turbine_torque", "torque_N_m": float(torque)}, {"kind": "attitude_latency", "latency_s": 0.1}])  # fmt: skip
        cases[f"late_{i}"] = late
    for i in range(2):
        def floor(c):
            a = np.append(c.rng.normal(0, 0.08, 2), 0.0)
            f, phase = c.rng.uniform(0.7, 2.0), c.rng.uniform(0, 6)
            supported(c, lambda r, b: [], gravity=lambda t: np.array([0, 0, -G]) - a * np.sin(2 * np.pi * f * t + phase), accept=[["floor_vibration"]],
                      effects=lambda s: [{"kind": "floor_vibration", "acceleration_m_s2": list(a), "frequency_Hz": f}])  # fmt: skip
        cases[f"floor_{i}"] = floor
    for i in range(2):
        def flexure(c):
            k = c.rng.uniform(3e-5, 3e-4)
            supported(c, lambda r, b: [], stiffness=k, effects=lambda s: [{"kind": "tether", "stiffness_N_m_per_rad": k}], accept=[["tether"]])
        cases[f"flexure_{i}"] = flexure
    for i in range(3):
        cases[f"panel_{i}"] = lambda c: spacecraft(c, "panel")
    for i in range(2):
        cases[f"inertia_{i}"] = lambda c: spacecraft(c, "inertia")
    cases["free_none"] = lambda c: spacecraft(c, "none")
    for kind in ("dry", "dry air", "air", "none", "wheel dry air"):
        cases["hinge_" + kind.replace(" ", "_")] = lambda c, kind=kind: hinge(c, kind)
    for k, (name, make) in enumerate(cases.items()):
        if of(name):
            make(Case(out, name, np.random.default_rng([seed, k])))
            print(name, flush=True)


if __name__ == "__main__":
    names = [name for name in sys.argv[3:] if name != "--short"]
    make_all(sys.argv[1], int(sys.argv[2]), names)
