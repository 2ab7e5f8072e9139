"""Irradiance of lamps on a plate, with shadows and with light reflected by one wall.

A lamp is a disc that emits uniformly over its area. Its radiant intensity depends on the angle to its axis
and is equal at every point of the disc. The irradiance at a point is (J. H. Lambert 1760)

    E = P / A  *  integral over the disc of  I(angle) cos(incidence) / r^2  dA,   I in 1/sr per watt.

The integral is a product rule (Gauss in the squared radius, uniform in azimuth). If an object may hide a
part of the disc, the hidden part is integrated with a scrambled Sobol sequence and subtracted. All
computations are in body axes: the plate is perpendicular to body z and faces along it.
"""

import dataclasses
import functools
import math

import numpy as np
from scipy import integrate
from scipy.spatial.transform import Rotation
from scipy.stats import qmc

DISC_SAMPLES = 1024  # points of a partly hidden disc
CELL_SAMPLES = 2**14  # pairs of a point of a partly hidden disc and a point of the cell
MIRROR_SAMPLES = 256
WALL_PATCHES = (150, 60)  # along and up
MOST_KNOWN = 4000


@dataclasses.dataclass(frozen=True)
class Beam:
    """Decrease of the radiant intensity with the angle from the axis (docs/experiment.md, [[source]])."""

    profile: str  # "gaussian", "super_gaussian" or "cosine_power"
    fwhm_rad: float = 0.1
    order: float = 2.0
    exponent: float = 10.0

    def relative(self, cosine):
        """Intensity relative to the axis at angles of these cosines; 0 behind the lamp."""
        front = np.clip(cosine, 0.0, 1.0)
        if self.profile == "cosine_power":
            return front**self.exponent
        half_widths = 2.0 * np.arccos(front) / self.fwhm_rad
        power = half_widths**2 if self.profile == "gaussian" else half_widths**self.order
        return np.where(cosine > 0.0, np.exp2(-power), 0.0)

    @functools.lru_cache(maxsize=1000)
    def on_axis_per_sr(self):
        """Intensity on the axis [1/sr] of a lamp of 1 W."""
        if self.profile == "cosine_power":
            return (self.exponent + 1.0) / (2.0 * math.pi)

        def per_angle(angle):
            return float(self.relative(math.cos(angle))) * math.sin(angle)

        edge = min(0.5 * math.pi, 3.0 * self.fwhm_rad)
        parts = ((0.0, edge), (edge, 0.5 * math.pi))
        flux = sum(integrate.quad(per_angle, *part, epsabs=0.0, epsrel=1e-12)[0] for part in parts)
        return 1.0 / (2.0 * math.pi * flux)


@dataclasses.dataclass(frozen=True)
class Lamp:
    """A round aperture in the lab; `axis` is a unit vector."""

    position_m: tuple
    axis: tuple
    power_W: float
    radius_m: float
    beam: Beam


@dataclasses.dataclass(frozen=True)
class Wall:
    """A rectangle perpendicular to body x (axis 0) or y (axis 1) that reflects on the side `facing` (+1 or -1)."""

    axis: int
    at_m: float
    from_m: float
    to_m: float
    bottom_m: float
    top_m: float
    facing: float
    diffuse: float = 0.0
    specular: float = 0.0

    def bounds(self):
        low, high = np.empty(3), np.empty(3)
        low[self.axis] = high[self.axis] = self.at_m
        low[1 - self.axis], high[1 - self.axis] = self.from_m, self.to_m
        low[2], high[2] = self.bottom_m, self.top_m
        return low, high

    def black(self):
        """The wall without reflection: the key of quantities that depend only on its geometry."""
        return dataclasses.replace(self, diffuse=0.0, specular=0.0)


@dataclasses.dataclass(frozen=True)
class Box:
    """An opaque box with edges along lab or body axes."""

    on_body: bool
    low_m: tuple
    high_m: tuple


@dataclasses.dataclass(frozen=True)
class Plate:
    """The rectangle of the cells: body x is u, body y is v."""

    u_low_m: float
    u_high_m: float
    v_low_m: float
    v_high_m: float
    z_m: float


@functools.lru_cache
def _gauss(count):
    """Nodes and weights of the Gauss-Legendre rule on (0, 1)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (nodes + 1.0), 0.5 * weights


@functools.lru_cache
def _disc_rule(rings=3, around=7):
    """Points of the unit disc (n, 2) and their fractions of the area."""
    squares, weights = _gauss(rings)
    angles = [2.0 * math.pi * (np.arange(around) + k / rings) / around for k in range(rings)]
    places = [math.sqrt(s) * np.column_stack([np.cos(a), np.sin(a)]) for s, a in zip(squares, angles)]
    return np.concatenate(places), np.repeat(weights / around, around)


@functools.lru_cache
def _sobol(dimensions, count):
    return qmc.Sobol(dimensions, scramble=True, seed=20).random(count)


def _on_disc(unit):
    """Uniform points of the unit disc from uniform points of the unit square."""
    radius, angle = np.sqrt(unit[:, 0]), 2.0 * math.pi * unit[:, 1]
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


class Points:
    """Single points of the plate, as scanned by a photodiode."""

    has_glass = False

    def __init__(self, plate, u_m, v_m):
        self.plate = plate
        self.points = np.column_stack([u_m, v_m, np.full(len(u_m), plate.z_m)])
        self.key = (plate.z_m, self.points.tobytes())

    def average(self, values):
        """One value per place, from values at all points (last axis)."""
        return values

    def fine(self, disc_samples=DISC_SAMPLES):
        """For every place: points (n, m, 3) in it, and the corresponding points of the unit disc (m, 2)."""
        disc = _on_disc(_sobol(2, disc_samples))
        return np.repeat(self.points[:, None, :], len(disc), axis=1), disc

    def probes(self):
        """Points (n, m, 3) for testing whether a place may be shaded."""
        return self.points[:, None, :]


class Cells:
    """Means over the cells of a regular array, behind the glass if there is one."""

    has_glass = True

    def __init__(self, plate, columns, rows, order=7):
        self.plate = plate
        column, row = np.meshgrid(np.arange(columns), np.arange(rows))
        self.size_m = np.array([(plate.u_high_m - plate.u_low_m) / columns, (plate.v_high_m - plate.v_low_m) / rows])
        corner = np.array([plate.u_low_m, plate.v_low_m])
        self.corners = corner + np.column_stack([column.ravel(), row.ravel()]) * self.size_m
        nodes, weights = _gauss(order)
        u, v = np.meshgrid(nodes, nodes)
        self.weights = np.outer(weights, weights).ravel()
        self.points = self._at(np.column_stack([u.ravel(), v.ravel()])).reshape(-1, 3)
        self.key = (plate, columns, rows, order)

    def _at(self, fractions):
        """Points (cells, n, 3) at fractions (n, 2) of every cell."""
        uv = self.corners[:, None, :] + fractions[None, :, :] * self.size_m
        return np.concatenate([uv, np.full((*uv.shape[:2], 1), self.plate.z_m)], axis=2)

    def average(self, values):
        return values.reshape(*values.shape[:-1], len(self.corners), len(self.weights)) @ self.weights

    def fine(self, _disc_samples=None):
        unit = _sobol(4, CELL_SAMPLES)
        return self._at(unit[:, 2:]), _on_disc(unit[:, :2])

    def probes(self):
        along = np.linspace(0.0, 1.0, 10)
        u, v = np.meshgrid(along, along)
        return self._at(np.column_stack([u.ravel(), v.ravel()]))


def crosses_box(low, high, start, end):
    """Whether segments pass through the box with sides along the axes (slab method)."""
    enter, leave = 0.0, 1.0
    for k in range(3):
        direction = end[..., k] - start[..., k]
        direction = np.where(np.abs(direction) < 1e-15, 1e-15, direction)
        first, second = (low[k] - start[..., k]) / direction, (high[k] - start[..., k]) / direction
        enter = np.maximum(enter, np.minimum(first, second))
        leave = np.minimum(leave, np.maximum(first, second))
    return enter <= leave


def fresnel_ratio(index, cosine):
    """Transmittance of unpolarised light into glass, relative to normal incidence (Fresnel's equations)."""
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine**2)) / index
    inside = np.sqrt(1.0 - sine**2)
    across = ((cosine - index * inside) / (cosine + index * inside)) ** 2
    along = ((inside - index * cosine) / (inside + index * cosine)) ** 2
    return (1.0 - 0.5 * (across + along)) / (1.0 - ((index - 1.0) / (index + 1.0)) ** 2)


@dataclasses.dataclass
class _Aperture:
    """A lamp in body axes."""

    beam: Beam
    radius_m: float
    centre: np.ndarray
    axis: np.ndarray
    across: np.ndarray  # two radii perpendicular to the axis, one per row

    @classmethod
    def of(cls, lamp, lab_from_body):
        axis = np.asarray(lamp.axis) @ lab_from_body
        # Two unit vectors perpendicular to the axis: rows of the Householder matrix that rotates the axis to z.
        away = axis + np.array([0.0, 0.0, math.copysign(1.0, axis[2])])
        across = (np.eye(3) - 2.0 * np.outer(away, away) / (away @ away))[:2]
        return cls(lamp.beam, lamp.radius_m, np.asarray(lamp.position_m) @ lab_from_body, axis, lamp.radius_m * across)

    def behind_mirror(self, wall):
        """The lamp's mirror image in the plane of a wall."""
        turn = np.ones(3)
        turn[wall.axis] = -1.0
        centre = self.centre * turn
        centre[wall.axis] += 2.0 * wall.at_m
        return _Aperture(self.beam, self.radius_m, centre, self.axis * turn, self.across * turn)

    def places(self, disc):
        """Points of the aperture for points (n, 2) of the unit disc."""
        return self.centre + disc @ self.across

    def received(self, source, point, normal, glass_index=None):
        """Irradiance per watt at `point` if all light came from `source`; the normal is along an axis."""
        to = [point[..., k] - source[..., k] for k in range(3)]
        r2 = to[0] ** 2 + to[1] ** 2 + to[2] ** 2
        r = np.sqrt(r2)
        leaves = (to[0] * self.axis[0] + to[1] * self.axis[1] + to[2] * self.axis[2]) / r
        axis, sign = normal
        meets = np.maximum(0.0, -sign * to[axis] / r)
        light = self.beam.on_axis_per_sr() * self.beam.relative(leaves) * meets / r2
        return light if glass_index is None else light * fresnel_ratio(glass_index, meets)


UP = (2, 1.0)  # a normal: index of the body axis, and its sign


@dataclasses.dataclass
class Room:
    """All inputs of the light."""

    plate: Plate
    lamps: list = dataclasses.field(default_factory=list)
    walls: list = dataclasses.field(default_factory=list)
    boxes: list = dataclasses.field(default_factory=list)
    ambient_W_m2: float = 0.0
    bias_rad: tuple = (0.0, 0.0)  # of the attitude, a rotation vector about lab x and y
    glass_index: float | None = None  # of a cover over the cells
    # Cache of light for lamps of 1 W; copies of a room share it.
    known: dict = dataclasses.field(default_factory=dict)

    def copy(self):
        return dataclasses.replace(self, lamps=list(self.lamps), walls=list(self.walls), boxes=list(self.boxes))

    def irradiance(self, places, attitude):
        """Irradiance [W/m²] at every place; `attitude` is the rotation matrix lab from body."""
        bias = Rotation.from_rotvec([*self.bias_rad, 0.0]).as_matrix()
        lab_from_body = bias @ attitude
        light = np.full(len(places.average(places.points[:, 0])), self.ambient_W_m2)
        ways = [("direct", 1.0, None)]
        for wall in self.walls:
            ways += [("diffuse", wall.diffuse, wall.black()), ("specular", wall.specular, wall.black())]
        for lamp in self.lamps:
            for way, share, wall in ways:
                if lamp.power_W * share > 0.0:
                    light = light + lamp.power_W * share * self._of_lamp(way, lamp, lab_from_body, places, wall)
        return light

    def _of_lamp(self, way, lamp, lab_from_body, places, wall):
        """Light of one lamp of 1 W along one path (direct or by a wall), cached."""
        glass = self.glass_index if places.has_glass and way == "direct" else None
        walls = tuple(w.black() for w in self.walls)
        shape = (lamp.position_m, lamp.axis, lamp.radius_m, lamp.beam)
        key = (way, wall, *shape, lab_from_body.tobytes(), places.key, glass, walls, tuple(self.boxes))
        if key not in self.known:
            if len(self.known) > MOST_KNOWN:
                self.known.clear()
            aperture = _Aperture.of(lamp, lab_from_body)
            if way == "direct":
                light = self._direct(aperture, places, lab_from_body, UP, None, glass)
            elif way == "diffuse":
                light = self._transfer(wall, places) @ self._on_wall(aperture, wall, lab_from_body)
            else:
                light = self._mirrored(aperture, wall, places)
            self.known[key] = light
        return self.known[key]

    def _occluders(self, but, lab_from_body):
        """Bounds of all opaque objects, with the matrix that rotates body vectors to their axes."""
        for wall in self.walls:
            if wall.black() != but:
                yield (*wall.bounds(), None)
        for box in self.boxes:
            yield np.array(box.low_m), np.array(box.high_m), None if box.on_body else lab_from_body.T

    def _hidden(self, start, end, but, lab_from_body, margin=0.0):
        """Whether an opaque object, enlarged by `margin`, is between two points."""
        hidden = np.zeros(np.broadcast_shapes(start.shape, end.shape)[:-1], dtype=bool)
        for low, high, turn in self._occluders(but, lab_from_body):
            a, b = (start, end) if turn is None else (start @ turn, end @ turn)
            hidden |= crosses_box(low - margin, high + margin, a, b)
        return hidden

    def _direct(self, aperture, places, lab_from_body, normal, but, glass):
        disc, shares = _disc_rule()
        sources = aperture.places(disc)[:, None, :]
        light = places.average(shares @ aperture.received(sources, places.points, normal, glass))
        if not self.walls and not self.boxes:
            return light
        probes = places.probes()
        margin = aperture.radius_m
        suspects = np.flatnonzero(self._hidden(aperture.centre, probes, but, lab_from_body, margin).any(axis=1))
        if len(suspects) == 0:
            return light
        points, disc = places.fine()
        sources = aperture.places(disc)
        for k in suspects:
            hidden = self._hidden(sources, points[k], but, lab_from_body)
            if hidden.any():
                taken = aperture.received(sources[hidden], points[k][hidden], normal, glass)
                light[k] = max(0.0, light[k] - taken.sum() / len(hidden))
        return light

    def _patches(self, wall):
        """Centres (n, 3) and areas of the wall's patches; low strips are narrow, because the plate is near."""
        along, up = WALL_PATCHES
        width = (wall.to_m - wall.from_m) / along
        edges = wall.bottom_m + (wall.top_m - wall.bottom_m) * (np.arange(up + 1) / up) ** 2
        across = wall.from_m + width * (np.arange(along) + 0.5)
        heights, across = np.meshgrid(0.5 * (edges[1:] + edges[:-1]), across, indexing="ij")
        centres = np.empty((along * up, 3))
        centres[:, wall.axis] = wall.at_m
        centres[:, 1 - wall.axis] = across.ravel()
        centres[:, 2] = heights.ravel()
        return centres, np.repeat(np.diff(edges) * width, along)

    def _on_wall(self, aperture, wall, lab_from_body):
        """Irradiance per watt on every patch of a wall."""
        centres, _ = self._patches(wall)
        patches = Points(self.plate, centres[:, 0], centres[:, 1])
        patches.points = centres
        return self._direct(aperture, patches, lab_from_body, (wall.axis, wall.facing), wall, None)

    def _transfer(self, wall, places):
        """Irradiance at every place for unit irradiance on every patch of a white Lambertian wall."""
        key = ("transfer", wall, places.key)
        if key not in self.known:
            centres, areas = self._patches(wall)
            matrix = []
            for start in range(0, len(areas), 500):
                centre, area = centres[start : start + 500, None, :], areas[start : start + 500, None]
                to = places.points[None, :, :] - centre
                r2 = (to**2).sum(axis=2)
                leaves = np.maximum(0.0, wall.facing * to[:, :, wall.axis])
                meets = np.maximum(0.0, -to[:, :, 2])
                matrix.append(places.average(area / math.pi * leaves * meets / r2**2))
            self.known[key] = np.concatenate(matrix).T
        return self.known[key]

    def _mirrored(self, aperture, wall, places):
        """Light per watt reflected by a perfect mirror: that of the lamp's image, seen through the wall."""
        if (aperture.centre[wall.axis] - wall.at_m) * wall.facing <= 0.0:
            return np.zeros(len(places.average(places.points[:, 0])))
        image = aperture.behind_mirror(wall)
        points, disc = places.fine(MIRROR_SAMPLES)
        sources = image.places(disc)
        light = np.zeros(len(points))
        low, high = wall.bounds()
        for k in range(len(points)):
            seen = crosses_box(low, high, sources, points[k])
            if seen.any():
                light[k] = image.received(sources[seen], points[k][seen], UP).sum() / len(seen)
        return light
