"""Random numbers of a case."""

import math

import numpy as np


class Draw:
    """A separate random stream for every list of integers, independent of draws from other streams."""

    def __init__(self, *stream):
        self.generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(stream)))

    def uniform(self, low, high):
        return float(low + (high - low) * self.generator.random())

    def log_uniform(self, low, high):
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def sign(self):
        return -1.0 if self.generator.random() < 0.5 else 1.0

    def chance(self, probability):
        return bool(self.generator.random() < probability)

    def below(self, count):
        return int(self.generator.integers(count))

    def normal(self):
        return float(self.generator.standard_normal())

    def normals(self, sigma):
        return sigma * self.generator.standard_normal(3)

    def direction(self):
        v = self.generator.standard_normal(3)
        return v / np.linalg.norm(v)
