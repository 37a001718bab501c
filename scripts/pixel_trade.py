"""Measure how far colours baked at vertices are from the same shading of every pixel.

    python scripts/pixel_trade.py > tables.md            # three minutes; docs/pixel_trade.png
    python scripts/pixel_trade.py --data scan.ply …      # decimated scans instead, no plot

Prints Markdown: docs/pixels.md is this output with sentences round it. Two references: the same
shading with the vertices' normals interpolated in every pixel, which leaves nothing but the error
of interpolated colours; and the image-space filters that the papers use, for everything that
differs. Errors are in grey levels of 255, of display values.
"""

from __future__ import annotations

import argparse
import inspect
import platform
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from tables import head, row

import meshdepict as md
from benchmarks.timing import shortest
from meshdepict import samples
from meshdepict.color.srgb import linear_to_srgb
from meshdepict.scales.image_scales import image_space
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scene.names import as_light
from meshdepict.shading import declaration
from meshdepict.shading.registry import METHODS as ALL
from meshdepict.shading.registry import find_method
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.threads import thread_count

PLOT = Path(__file__).resolve().parent.parent / "docs" / "pixel_trade.png"
# Those that shade each sample by itself: the others have no values between vertices.
METHODS = tuple(name for name, function in ALL.items() if declaration(function).local)
COUNTS = (5_000, 10_000, 20_000, 40_000, 80_000, 160_000)
REFINED = (10_000, 40_000)
WIDTH = "0.5%"  # of the diagonal: the golf ball's median edge at 50,000 vertices
SIZE = 600
BETWEEN, FILTERS = "interpolated normals", "the papers' filters"
FACING = 0.8  # n·e, beyond which a surface counts as facing the eye

Values = Any


class Case(NamedTuple):
    """A mesh in a picture, and what a method's scale space is made with."""

    mesh: md.Mesh
    buffer: GBuffer
    width: str | None

    @property
    def pixels_per_edge(self) -> float:
        """How long a median edge is, in pixels."""
        return self.mesh.edge_length / self.buffer.edge_length

    def space(self, method: str) -> md.ScaleSpace:
        """Return the vertices' scale space, as a bake makes it."""
        declared = declaration(find_method(method))
        return md.scale_space(
            self.mesh, scales=declared.scales, ratio=declared.ratio, width=self.width
        )

    def shaded(self, space: md.ScaleSpace, method: str, **options: Any) -> Values:
        """Return display values in grey levels."""
        function = find_method(method)
        if "view" in inspect.signature(function).parameters:
            options["view"] = self.buffer.view
        values = function(space, light(method, self.buffer), **options)
        return 255 * (linear_to_srgb(values) if declaration(function).linear else values)

    def between(self, space: md.ScaleSpace) -> md.ScaleSpace:
        """Return the pixels' scale space: the vertices', interpolated."""
        return InterpolatedSpace(
            space, self.mesh.faces[self.buffer.triangle], self.buffer.barycentric
        )

    def pictured(self, method: str) -> Values:
        """Return what the papers' filters make of the pixels."""
        declared = declaration(find_method(method))
        curved = seen_by_view(method)
        kind = "diffusion" if curved else "bilateral" if declared.scales else "none"
        # As wide as the mesh's own, but no less than a pixel: less is no smoothing.
        width = max(self.mesh.edge_length, self.buffer.edge_length)
        if self.width is not None:
            width = max(float(self.width[:-1]) / 100 * self.mesh.diagonal, self.buffer.edge_length)
        space = image_space(
            self.buffer, scales=declared.scales, ratio=declared.ratio, width=width, filter=kind
        )
        return self.shaded(space, method, **({"curvature": "view"} if curved else {}))


def light(method: str, buffer: GBuffer) -> Any:
    """Return one light; for Light Warping, which draws hard edges under one, a wide one."""
    lamp = as_light("northwest", buffer.view)
    return replace(lamp, spread=40).disc(32) if method == "light_warping" else lamp


def seen_by_view(method: str) -> bool:
    """Whether a method asks whose curvature it is to show."""
    return "curvature" in inspect.signature(find_method(method)).parameters


def error(values: Values, reference: Values) -> tuple[float, float]:
    """Return the root mean square difference, and the share in per cent beyond two levels."""
    off = np.abs(values - reference)
    return float(np.sqrt(np.mean(off**2))), 100 * float(np.mean(off > 2))


def decimated(path: Path, counts: tuple[int, ...]) -> list[md.Mesh]:
    """Return a scan with about so many vertices, and as it is."""
    import pyvista as pv

    whole = md.read_mesh(path)
    found = []
    for count in counts:
        if count < 0.8 * len(whole.vertices):
            poly = pv.PolyData.from_regular_faces(whole.vertices, whole.faces)
            found.append(md.Mesh.from_pyvista(poly.decimate(1 - count / len(whole.vertices))))
    return [*found, whole]


# --- tables -----------------------------------------------------------------------------------


Errors = dict[tuple[str, int], tuple[float, float]]


def errors(cases: list[Case], reference: str) -> Errors:
    """Return and print errors for every method and mesh."""
    labels = [f"{len(c.mesh.vertices):,}: {c.pixels_per_edge:.1f} px/edge" for c in cases]
    width = cases[0].width or "median edge"
    head(f"against {reference}, σ_1 = {width}", *labels)
    found: Errors = {}
    for method in METHODS:
        kinds = ("object", "view") if seen_by_view(method) else ("object",)
        for kind in kinds if reference == FILTERS else kinds[:1]:
            options = {"curvature": kind} if seen_by_view(method) else {}
            name = method if kind == "object" else f"{method}, view curvature"
            cells = []
            for i, case in enumerate(cases):
                space = case.space(method)
                baked = case.buffer.sample(case.shaded(space, method, **options))
                if reference == FILTERS:
                    exact = case.pictured(method)
                else:
                    exact = case.shaded(case.between(space), method, **options)
                found[name, i] = error(baked, exact)
                words = "{:#.2g} ({:.0f} %)".format(*found[name, i])
                if reference == FILTERS:
                    near = case.buffer.normals @ case.buffer.view.towards_eye > FACING
                    words += f", facing {error(baked[near], exact[near])[0]:#.2g}"
                cells.append(words)
            row(name, *cells)
            print(f"  {reference} {width} {name}", file=sys.stderr, flush=True)
    return found


def crossings(cases: list[Case], found: dict[str, Errors]) -> None:
    """Print at which edge length the error is two levels, between meshes on a power law."""
    edges = np.array([100 * c.mesh.edge_length / c.mesh.diagonal for c in cases])
    head("edge, % of the diagonal, where rms is two levels", *found)
    for method in METHODS:
        cells = []
        for values in found.values():
            rms = np.array([values[method, i][0] for i in range(len(cases))])
            over = np.flatnonzero(rms > 2)
            if not len(over):
                cells.append(f"over {edges[0]:.2g}")
            elif over[-1] == len(rms) - 1:
                cells.append(f"under {edges[-1]:.2g}")
            else:
                pair = slice(over[-1], over[-1] + 2)
                where = np.interp(-np.log(2), -np.log(rms[pair]), np.log(edges[pair]))
                cells.append(f"{np.exp(where):.2g}")
        row(method, *cells)


def refinement(cases: list[Case]) -> None:
    """Print what refine=2 costs and gives."""
    head(
        "refine = 2", "vertices", "triangles ×", "seconds before", "after", "error before", "after"
    )
    for method in METHODS:
        for case in cases:
            space = case.space(method)
            exact = case.shaded(case.between(space), method)
            plain = error(case.buffer.sample(case.shaded(space, method)), exact)
            lamp, view = light(method, case.buffer), case.buffer.view

            def bake(refine: float | None = None, method=method, case=case, lamp=lamp, view=view):
                return md.bake(
                    case.mesh, method, light=lamp, view=view, width=case.width, refine=refine
                )

            finer = bake(2)
            values = finer.intensity
            if declaration(find_method(method)).linear:
                values = linear_to_srgb(values)
            seen = GBuffer.of(finer.shape, view, size=case.buffer.size)
            both = (seen.mask & case.buffer.mask)[case.buffer.mask]
            shown = seen.image(255 * seen.sample(values))[case.buffer.mask]
            after = error(shown[both], exact[both])
            row(
                method, f"{len(case.mesh.vertices):,}",
                f"{len(finer.shape.faces) / len(case.mesh.faces):.1f}",
                f"{shortest(bake):.2f}", f"{shortest(lambda: bake(2), 2):.2f}",
                f"{plain[0]:#.2g} ({plain[1]:.0f} %)", f"{after[0]:#.2g} ({after[1]:.0f} %)",
            )  # fmt: skip


def times(case: Case) -> None:
    """Print seconds of a bake and of pixels, with the scale space and once there is one."""
    count = len(case.buffer.normals)
    head(
        f"seconds, {len(case.mesh.vertices):,} vertices, {count:,} pixels",
        "bake, all of it", "shading alone", "interpolated pixels", "papers' filters, all of it",
    )  # fmt: skip
    buffer_seconds = shortest(
        lambda: GBuffer.of(case.mesh, case.buffer.view, size=case.buffer.size)
    )
    for method in METHODS:
        space = case.space(method)
        lamp, view = light(method, case.buffer), case.buffer.view

        def bake(method=method, lamp=lamp, view=view):
            return md.bake(case.mesh, method, light=lamp, view=view, width=case.width)

        row(
            method, f"{shortest(bake):.2f}",
            f"{shortest(lambda s=space, m=method: case.shaded(s, m)):.3f}",
            f"{shortest(lambda s=space, m=method: case.shaded(case.between(s), m)):.2f}",
            f"{shortest(lambda m=method: case.pictured(m)):.2f}",
        )  # fmt: skip
    print(f"\nThe G-buffer itself takes {buffer_seconds:.2f} s.")


# --- the plot ---------------------------------------------------------------------------------


def plot(cases: list[Case], found: dict[str, Errors], path: Path) -> None:
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 3, figsize=(12, 4.2), layout="constrained", sharey=True)
    across = [100 * case.mesh.edge_length / case.mesh.diagonal for case in cases]
    for axis, (title, values) in zip(axes, found.items(), strict=True):
        for method in METHODS:
            rms = [values[method, i][0] for i in range(len(cases))]
            axis.loglog(across, rms, marker="o", ms=3, label=method.replace("_", " "))
        axis.axhline(2, color="grey", lw=0.8)
        axis.set(title=title, xlabel="median edge, % of the diagonal")
        axis.set_xticks([0.25, 0.5, 1, 2], ["0.25", "0.5", "1", "2"], minor=False)
        axis.set_yticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"], minor=False)
        axis.minorticks_off()
        axis.grid(visible=True, alpha=0.3)
    axes[0].set(ylabel="rms difference, grey levels")
    figure.legend(
        *axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False
    )
    figure.savefig(path, dpi=90)


def main() -> None:
    parser = argparse.ArgumentParser(description="Baked colours against shading of every pixel.")
    parser.add_argument("--data", nargs="*", type=Path, default=[], help="scans, as mesh files")
    parser.add_argument("--up", default="y", help="which axis of the scans points up")
    parser.add_argument("--size", type=int, default=SIZE, help="of the picture, in pixels")
    given = parser.parse_args()
    warnings.simplefilter("ignore", md.MeshdepictWarning)
    print(f"{thread_count()} cores, {platform.processor() or platform.machine()}, Python "
          f"{platform.python_version()}, meshdepict {md.__version__}; {given.size} × {given.size} "
          "pixels.")  # fmt: skip
    objects = {path.stem: decimated(path, COUNTS) for path in given.data}
    objects = objects or {"golf ball": [samples.golf_ball(count) for count in COUNTS]}
    for name, meshes in objects.items():
        print(f"\n### {name}")
        view = md.View.fitted("front", meshes[-1], up=given.up, height_px=given.size)
        seen = [(m, GBuffer.of(m, view, size=(given.size, given.size))) for m in meshes]
        own = [Case(*pair, None) for pair in seen]
        fixed = [Case(*pair, WIDTH) for pair in seen]
        found = {
            "interpolated normals, σ_1 = an edge": errors(own, BETWEEN),
            f"interpolated normals, σ_1 = {WIDTH}": errors(fixed, BETWEEN),
        }
        crossings(own, found)
        found[f"the papers' filters, σ_1 = {WIDTH}"] = errors(fixed, FILTERS)
        if not given.data:
            refinement([case for case, n in zip(own, COUNTS, strict=True) if n in REFINED])
            times(own[COUNTS.index(40_000)])
            plot(own, found, PLOT)


if __name__ == "__main__":
    main()
