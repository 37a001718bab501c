"""Knobs of light and bending: rays, bounces, lights of an environment, curvature's estimator."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from light_trade import fading
from tradeoff_subjects import Row, data, scans, trade

from meshdepict.curvature import ESTIMATORS, principal_curvatures
from meshdepict.scene.environment import Environment

RAYS, EXACT_RAYS = (16, 64, 256, 1024), 2048
BOUNCES = (0, 1, 2, 3, 5, 8)
MATT = {"shadows": True, "ambient": 0.0, "diffuse": 0.8, "specular": 0.0}
LIGHTS = (9, 18, 54, 216, 432, 2048)


def rays() -> Iterator[Row]:
    """Send rays from each vertex: how much of the sky is seen, and three bounces under one."""
    methods = {
        "sky_view": {}, "phong": {**MATT, "bounces": 3, "light": fading()},
    }  # fmt: skip
    for one in scans()[:1]:
        for method, chosen in methods.items():
            settings = {
                f"{method}: {n}": lambda n=n, m=method, c=chosen, s=one: s.bake(m, rays=n, **c)
                for n in (*RAYS, EXACT_RAYS)
            }
            yield from trade("rays", one, settings, exact=f"{method}: {EXACT_RAYS}")


def bounces() -> Iterator[Row]:
    """Let light go on so often; under a sky that fades from above."""
    for one in scans()[:2]:
        chosen = {**MATT, "light": fading(), "rays": 64}
        settings = {
            str(n): lambda n=n, c=chosen, s=one: s.bake("phong", bounces=n, **c) for n in BOUNCES
        }
        yield from trade("bounces", one, settings, exact=str(BOUNCES[-1]))


def lights() -> Iterator[Row]:
    """Cut an environment into so many lights."""
    folder = data()
    light = fading() if folder is None else Environment.from_file(folder / "env/ennis_256x128.hdr")
    for one in scans()[:2]:
        for method in ("radiance_scaling", "light_warping"):
            settings = {
                f"{method}: {n}": lambda n=n, m=method, s=one: s.bake(
                    m, light=light, lights=n, exposure=0.5
                )
                for n in LIGHTS
            }
            exact = f"{method}: {LIGHTS[-1]}"
            yield from trade("lights of an environment", one, settings, exact=exact)


def curvature() -> Iterator[Row]:
    """Estimate curvature, shown as mean-curvature shading shows it; against the tensor."""
    for one in scans():

        def shown(estimator, s=one):
            found = principal_curvatures(s.shape, method=estimator)
            bend = (found.k1 + found.k2) / 2 * s.shape.edge_length
            gray = np.rint(255 * np.clip(0.5 * 2 ** np.clip(5 * bend, -9, 1), 0, 1))
            return np.repeat(gray[:, None], 3, axis=1).astype(np.uint8)

        settings = {e: lambda e=e, f=shown: f(e) for e in ESTIMATORS}
        yield from trade("curvature estimator", one, settings, exact="tensor")


KNOBS = (rays, bounces, lights, curvature)
