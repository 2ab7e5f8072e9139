"""Visibility of an effect in recordings: growth of chi², and which other effects explain it as well."""

import functools

import numpy as np

from . import effects, readings

MOST_ROWS = {"scan": 300, "sweep": 80, "run": 32}  # maximum number of rows of a recording that are used


class Judge:
    """The fitted recordings of a case, thinned, with the errors of their readings."""

    def __init__(self, world, noise, recordings):
        self.world = world
        self.parts = []  # rows, and the weights of their numbers
        for rows in recordings.values():
            if not rows.is_first:
                continue
            count = min(len(rows), MOST_ROWS[rows.kind])
            some = rows.take(np.arange(count) * len(rows) // count)
            errors = readings.errors(world, some, noise, readings.read(world, some))
            self.parts.append((some, np.sqrt(len(rows) / count) / errors))
        self.nominal = self.whitened(world)
        self.kinds = {rows.kind for rows, _ in self.parts}
        self.known_slopes = {}  # of rivals, at the nominal world

    def whitened(self, world):
        """All readings in units of their errors; weights account for the omitted rows."""
        return np.concatenate([(readings.read(world, rows) * weight).ravel() for rows, weight in self.parts])

    def with_effects(self, some):
        world = self.world.copy()
        for effect in some:
            effects.act(effect, world)
        return world

    def gain(self, some):
        """chi² of the nominal world if these effects act."""
        return float(np.sum((self.whitened(self.with_effects(some)) - self.nominal) ** 2))

    def rivals(self):
        return effects.rivals_of(self.world, "scan" in self.kinds, bool(self.kinds - {"scan"}), "run" in self.kinds)

    def slopes(self, rival):
        """Derivatives of the readings with respect to the rival's numbers at their neutral values, one column each."""
        key = (rival.kind, rival.index)
        if key not in self.known_slopes:
            columns = []
            for move in np.diag(rival.step):
                world = self.world.copy()
                rival.act(world, np.array(rival.neutral) + move)
                columns.append((self.whitened(world) - self.nominal) / move.sum())
            self.known_slopes[key] = np.column_stack(columns)
        return self.known_slopes[key]

    def left(self, kept, rivals, target, near):
        """Residual chi² of `target` when the numbers of `rivals` are fitted together with `kept`. A fraction of light
        is also started from smaller values: a cell has little influence until it limits its string."""
        best = self._fit(kept, rivals, target, None)
        if rivals[-1].kind in ("cell_shaded", "cell_degraded", "led_derated"):
            for share in (0.4, 0.1):
                best = best if best < near else min(best, self._fit(kept, rivals, target, share))
        return best

    def _fit(self, kept, rivals, target, last):
        """Fit by the Levenberg–Marquardt method within the bounds; `last` is the initial value of the last number."""
        x, step, low, high = (
            np.array([n for r in rivals for n in getattr(r, name)]) for name in ("neutral", "step", "low", "high")
        )

        if last is not None:
            x[-1] = last

        def read(at):
            world, first = kept.copy(), 0
            for rival in rivals:
                rival.act(world, at[first : first + len(rival.neutral)])
                first += len(rival.neutral)
            return self.whitened(world)

        now = read(x)
        best = begin = float(np.sum((target - now) ** 2))
        for iteration in range(8):
            if len(x) == 0 or best <= 1.0:
                break
            if iteration == 0 and last is None and kept is self.world and all(rival.neutral for rival in rivals):
                jacobian = np.column_stack([self.slopes(rival) for rival in rivals])
            else:
                by = np.where((x + step > high) | (x + step < low), -step, step)
                jacobian = np.column_stack([(read(x + move) - now) / move.sum() for move in np.diag(by)])
            r = target - now
            normal, slope = jacobian.T @ jacobian, jacobian.T @ r
            improved = False
            for damping in (1e-9, 1e-2, 1.0, 30.0):
                damped = normal + np.diag(np.diag(normal) * damping + 1e-12)
                next_x = np.clip(x + np.linalg.solve(damped, slope), low, high)
                trial = read(next_x)
                remains = float(np.sum((target - trial) ** 2))
                if remains < best:
                    improved = remains < 0.98 * best
                    best, x, now = remains, next_x, trial
                    break
            # An effect with a large residual after the first steps is not a rival.
            if not improved or best > max(3000.0, 0.3 * begin):
                break
        return best

    @functools.cached_property
    def _catalogue(self):
        """Orthonormal basis of all changes of the readings due to numbers of the catalogue."""
        columns = np.column_stack([self.slopes(rival) for rival in self.rivals() if rival.neutral])
        length = np.linalg.norm(columns, axis=0)
        basis, singular, _ = np.linalg.svd(columns[:, length > 0.0] / length[length > 0.0], full_matrices=False)
        return basis[:, singular > 1e-3 * singular[0]]

    def unexplained(self, some):
        """Growth of chi² due to these effects beyond all numbers of the catalogue, to first order."""
        off = self.whitened(self.with_effects(some)) - self.nominal
        return float(np.sum((off - self._catalogue @ (self._catalogue.T @ off)) ** 2))

    def accepted(self, acting, near):
        """Answers that count as correct if `acting` acts: sets of names, indices by name, and the smallest chi² that
        a single effect leaves. An answer counts if it leaves less than `near`."""
        target = self.whitened(self.with_effects(acting))
        names, indices = [sorted(e.kind for e in acting)], {}

        def accept(kinds, rival=None):
            if sorted(kinds) not in names:
                names.append(sorted(kinds))
            if rival is not None and rival.index is not None:
                indices.setdefault(rival.kind, []).append(rival.index)

        for effect in acting:
            if effect.index is not None:
                indices.setdefault(effect.kind, []).append(effect.index)
        rivals = self.rivals()
        alone = float(np.sum((target - self.nominal) ** 2))
        for rival in rivals:
            remains = self.left(self.world, [rival], target, near)
            alone = min(alone, remains)
            if remains < near:
                accept([rival.kind], rival)
        for effect in acting if len(acting) == 2 else []:
            same = [r for r in rivals if (r.kind, r.index) == (effect.kind, effect.index) and r.neutral]
            kept = self.world if same else self.with_effects([effect])
            for rival in rivals:
                if rival.kind != effect.kind and self.left(kept, [*same, rival], target, near) < near:
                    accept([effect.kind, rival.kind], rival)
        if "scan" in self.kinds:  # a box over one cell has the effect of shading this cell
            for kinds in [n for n in names if "cell_shaded" in n]:
                accept(["unmodelled_shadow" if kind == "cell_shaded" else kind for kind in kinds])
        return names, {kind: sorted(set(numbers)) for kind, numbers in indices.items()}, alone
