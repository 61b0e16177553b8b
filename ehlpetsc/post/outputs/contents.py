"""Datasets of a post-processing result, from computed damage."""

import numpy as np

from ehlpetsc.materials import DEFAULT
from ehlpetsc.post.fatigue.passes import largest_near
from ehlpetsc.post.fatigue.statistics import asperities, log_life, rank_correlation, weibull_fit
from ehlpetsc.post.fatigue.weibull import CONFIDENCE, weibull_bounds, weibull_likelihood
from ehlpetsc.post.temperatures import point_temperatures


class Contents:
    """Datasets, root attributes and group attributes for `write_result`.

    One surface has the fixed names: surface 2, whose asperities have more contacts, if it is rough and
    passed.

    Parameters
    ----------
    prepared : ehlpetsc.post.prepare.Prepared
    regression : str
        Regression of the Weibull fit.
    columns : sequence of (criterion, column)
        Columns after damage, cycles and peak range.
    within : float
        Half widths on either side of a peak, in which the damage of its asperity is the maximum.
    """

    def __init__(self, prepared, regression, columns=(), within=0.0):
        self.prepared, self.regression, self.columns, self.within = prepared, regression, columns, within
        self.first = self._first_surface()
        self.datasets = {"damage/s": prepared.s, "damage/z_over_a": np.array(prepared.settings.depths)}
        self.groups = {"damage": {"surface": self.first}}
        self.notes = []

    def _first_surface(self):
        passed = [name for name, motion in self.prepared.motions.items() if motion.complete.any()]
        return next((name for name in passed if self.prepared.loads.profiles[name] is not None), passed[0])

    def add(self, surface, values):
        """Damage, cycles, peak range, criteria (depths, points, 3 ...) of a surface; its asperities."""
        other = "" if surface == self.first else f"{surface}_"
        passage = self.prepared.motions[surface]
        self.datasets |= {
            f"damage/{surface}": values[..., 0],
            f"damage/{surface}_complete": passage.complete.astype(np.uint8),
            f"damage/{surface}_missed": self.prepared.missed[surface].astype(np.int32),
            f"damage/{other}cycles": values[..., 1],
            f"damage/{other}peak_range": values[..., 2],
        }
        for index, (criterion, column) in enumerate(self.columns, start=3):
            group = f"criteria/{criterion.replace('-', '_')}"
            self.datasets[f"{group}/{surface}_{column}"] = values[..., index]
            if column in ("damage", "utilisation"):
                complete = passage.complete
                pairs = zip(values[:, complete, 0], values[:, complete, index], strict=True)
                ranks = np.array([rank_correlation(paper, other) for paper, other in pairs])
                self.datasets[f"{group}/{surface}_rank_correlation"] = ranks
        self._add_asperities(surface, values[..., 0])

    def add_temperatures(self, surface):
        """Add the surface temperatures of the points of a surface, if stored."""
        prepared = self.prepared
        if surface not in prepared.loads.heated([surface]):
            return
        motion = prepared.motions[surface]
        temperatures = point_temperatures(prepared.loads, surface, motion, prepared.s.size)
        self.datasets |= {
            f"temperature/{surface}_{name}": values for name, values in temperatures._asdict().items()
        }
        bulk = {f"bulk_temperature_{surface}": prepared.loads.bulk_temperature(surface)}
        self.groups["temperature"] = self.groups.get("temperature", {}) | bulk

    def _add_asperities(self, surface, damage):
        prepared, inner = self.prepared, "" if surface == self.first else f"{surface}/"
        profile = prepared.loads.profiles[surface]
        peaks = asperities(profile, prepared.s, prepared.motions[surface].complete)
        under = damage[:, peaks.point]
        near = largest_near(prepared.s, damage, peaks.s, self.within * prepared.loads.a)
        fits = np.array([weibull_fit(log_life(row), self.regression) for row in under]).reshape(-1, 3)
        failed = (under >= 1).sum(axis=1)
        self._put("asperities", inner, s=peaks.s, height=peaks.height, damage=under, largest=near)
        self._put("weibull", inner, **dict(zip(("alpha", "beta", "r_squared"), fits.T, strict=True)))
        self._put_confidence(inner, [log_life(row) for row in under])
        self._put("weibull", inner, at_least_one=failed, undamaged=(under == 0).sum(axis=1))
        for group in ("asperities", "weibull"):
            self.groups[f"{group}/{inner}".rstrip("/")] = {"surface": surface}
        if profile is not None:
            self.datasets[f"profile/{surface}/s"], self.datasets[f"profile/{surface}/z"] = profile
        for depth, count in zip(prepared.settings.depths, failed, strict=True):
            if count:
                self.notes.append(
                    f"note: {count} of {peaks.s.size} asperities of surface {surface} have damage of 1 "
                    f"or more at z/a = {depth:g}: failure in the first pass"
                )

    def _put_confidence(self, inner, lives):
        """Add maximum likelihood and bounds by resampling, for each depth."""
        best = np.array([weibull_likelihood(row) for row in lives]).reshape(-1, 2)
        bounds = [weibull_bounds(row, self.regression) for row in lives]
        for k, name in enumerate(("alpha", "beta")):
            ends = np.array([bound[k] for bound in bounds]).reshape(-1, 2)
            self._put("weibull", inner, **{f"{name}_likelihood": best[:, k]})
            self._put("weibull", inner, **{f"{name}_low": ends[:, 0], f"{name}_high": ends[:, 1]})

    def _put(self, group, inner, **values):
        self.datasets |= {f"{group}/{inner}{name}": value for name, value in values.items()}

    def attributes(self, identity, counting, settings=()):
        """Root attributes: provenance and settings of the result."""
        loads = self.prepared.loads
        mean = (loads.speeds["1"] + loads.speeds["2"]) / 2
        return {
            "title": loads.title,
            "case": loads.case_text,
            "source": str(loads.path),
            "material": ", ".join(loads.case.contact.material or (DEFAULT,)),
            "settings": "\n".join(settings),
            "fingerprint": identity,
            "a": loads.a,
            "inlet": loads.x[0],
            "outlet": loads.x[-1],
            "p0": loads.p0,
            "slide_roll_ratio": (loads.speeds["1"] - loads.speeds["2"]) / mean if mean else 0.0,
            "regression": self.regression,
            "every": self.prepared.every,
            "within": self.within,
            "bounds_level": CONFIDENCE,
            "residual_stress": np.array(self.prepared.settings.residual_stress, float).reshape(-1, 2),
            **{f"speed_{name}": loads.speeds[name] for name in self.prepared.motions},
            **counting._asdict(),
        }
