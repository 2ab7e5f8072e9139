"""Arithmetic of vectors (3, …), quaternions (4, …; w, x, y, z, lab from body) and matrices (3, 3, …).

The last axes are those of a batch: every function accepts one platform, many, or many at many times."""

import numpy as np




def _bilinear(rows, columns, terms):
    """Matrix that maps the products a_i b_k (i major) to sums of them: terms are (row, i, k, factor)."""
    matrix = np.zeros((rows, columns * columns))
    for row, i, k, factor in terms:
        matrix[row, columns * i + k] += factor
    return matrix


_CROSS = _bilinear(3, 3, [(i, j, k, s) for i in range(3) for j, k, s in
                          (((i + 1) % 3, (i + 2) % 3, 1.0), ((i + 2) % 3, (i + 1) % 3, -1.0))])  # fmt: skip
_PRODUCT = _bilinear(4, 4, [
    (0, 0, 0, 1), (0, 1, 1, -1), (0, 2, 2, -1), (0, 3, 3, -1), (1, 0, 1, 1), (1, 1, 0, 1), (1, 2, 3, 1), (1, 3, 2, -1),
    (2, 0, 2, 1), (2, 1, 3, -1), (2, 2, 0, 1), (2, 3, 1, 1), (3, 0, 3, 1), (3, 1, 2, 1), (3, 2, 1, -1), (3, 3, 0, 1),
])  # fmt: skip
_SPIN = np.ascontiguousarray(_PRODUCT.reshape(4, 4, 4)[:, :, 1:].reshape(4, 12))
_ROTATION = _bilinear(9, 4, [
    (0, 0, 0, 1), (0, 1, 1, 1), (0, 2, 2, -1), (0, 3, 3, -1), (1, 1, 2, 2), (1, 0, 3, 2), (2, 1, 3, 2), (2, 0, 2, -2),
    (3, 1, 2, 2), (3, 0, 3, -2), (4, 0, 0, 1), (4, 1, 1, -1), (4, 2, 2, 1), (4, 3, 3, -1), (5, 2, 3, 2), (5, 0, 1, 2),
    (6, 1, 3, 2), (6, 0, 2, 2), (7, 2, 3, 2), (7, 0, 1, -2), (8, 0, 0, 1), (8, 1, 1, -1), (8, 2, 2, -1), (8, 3, 3, 1),
])  # fmt: skip


def _apply(matrix, a, b, shape=None):
    # One matrix product is faster than a dozen operations on short arrays.
    products = a[:, np.newaxis] * b
    tail = products.shape[2:]
    sums = matrix @ products.reshape(matrix.shape[1], -1)
    return sums.reshape((shape or matrix.shape[:1]) + tail)


def cross(a, b):
    return _apply(_CROSS, a, b)


def dot(a, b):
    return (a * b).sum(axis=0)


def length(a):
    return np.sqrt(dot(a, a))


def times(matrix, v):
    """Matrix times vector."""
    return (matrix * v).sum(axis=1)


def inverse(matrix):
    """Inverse of symmetric matrices."""
    a, b, c = cross(matrix[1], matrix[2]), cross(matrix[2], matrix[0]), cross(matrix[0], matrix[1])
    return np.stack((a, b, c)) / dot(matrix[0], a)


def product(a, b):
    """Product of two quaternions: the rotation `b` followed by `a`."""
    return _apply(_PRODUCT, a, b)


def quaternion_rate(q, rate_body):
    """dq/dt = q (0, ω)/2."""
    return 0.5 * _apply(_SPIN, q, rate_body)


def conjugate(q):
    return np.concatenate((q[:1], -q[1:]))


def normalised(q):
    return q / np.sqrt((q * q).sum(axis=0))


def body_from_lab(q):
    """Rotation matrix from lab to body components, for a unit quaternion."""
    return _apply(_ROTATION, q, q, (3, 3))


def quaternion_of(turn):
    """Quaternion of the rotation vector `turn` [rad]."""
    turn = np.asarray(turn, dtype=float)
    angle = length(turn)
    scale = 0.5 * np.sinc(angle / (2 * np.pi))  # sin(angle/2) / angle
    return np.concatenate((np.cos(0.5 * angle)[np.newaxis], scale * turn))


def turn_of(q):
    """Rotation vector of a quaternion with an angle of at most π."""
    q = np.where(q[0] < 0.0, -q, q)
    sine = length(q[1:])
    small = sine < 1e-12
    scale = np.where(small, 2.0, 2.0 * np.arctan2(sine, q[0]) / np.where(small, 1.0, sine))
    return scale * q[1:]
