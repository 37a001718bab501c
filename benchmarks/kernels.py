"""The kernels that most time goes to, each alone on one core, and what they cannot do without.

`scripts/bounds.py` sets their seconds beside what the machine's memory and multipliers allow.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

import meshdepict as md
from benchmarks import subjects
from meshdepict import threads
from meshdepict.scene.names import as_light
from meshdepict.shading.exaggerated_kernel import combine_bands
from meshdepict.sums import direct_sums as direct
from meshdepict.sums import grid_sums as blocks
from meshdepict.sums import spectral_sums as spectral
from meshdepict.sums.bells import RULES, blur_taps
from meshdepict.sums.block_kernels import BLOCK
from meshdepict.sums.block_layout import blurs
from meshdepict.sums.lanes import WIDE, add_each, load, many, store
from meshdepict.sums.ordered_points import OrderedPoints
from meshdepict.threads import kernel
from meshdepict.voxels.gaussian_bands import gaussian_band
from meshdepict.voxels.gaussian_gradient import resample

SUBJECT = "large golf ball"
CHANNELS = 9  # of smoothed normals


class Needed(NamedTuple):
    """Bytes that have to come from memory or go there once, and multiply-adds."""

    bytes: float
    multiply_adds: float


# --- the machine --------------------------------------------------------------------------------


class _OneCore:
    def teardown(self, *_: object) -> None:
        threads.limit(None)


class Triad(_OneCore):
    """a = b + 2c over arrays far larger than the nearer caches: McCalpin's STREAM."""

    count = 16_000_000

    def setup(self) -> None:
        self.arrays = np.zeros(self.count, np.float32), *np.ones((2, self.count), np.float32)
        self.time_running()

    def time_running(self) -> None:
        _triad(*self.arrays)

    def needed(self) -> Needed:
        return Needed(12 * self.count, self.count)


class MultiplyAdds(_OneCore):
    """Multiply-adds in registers, sixteen in a vector."""

    rounds = 1_000_000

    def setup(self) -> None:
        self.numbers = np.full(8 * WIDE, 1e-3, np.float32)
        self.time_running()

    def time_running(self) -> None:
        _multiply(self.numbers, self.rounds, many(len(self.numbers)))

    def needed(self) -> Needed:
        return Needed(0, self.rounds * len(self.numbers))


@kernel("contracted")
def _triad(a, b, c):  # type: ignore[no-untyped-def]
    for i in range(len(a)):
        a[i] = b[i] + np.float32(2) * c[i]


@kernel("contracted")
def _multiply(numbers, rounds, like):  # type: ignore[no-untyped-def]
    sums = load(numbers, 0, like)
    for _ in range(rounds):
        sums = add_each(sums, numbers, 0, numbers, 0)
    store(sums, numbers, 0)


# --- Gaussian sums ------------------------------------------------------------------------------


class _Ball(_OneCore):
    edges = 3.0

    def setup(self) -> None:
        threads.limit(1)
        ball = subjects.mesh(SUBJECT)
        self.count, self.width = len(ball.vertices), self.edges * ball.edge_length
        rows = np.random.default_rng(1).random((CHANNELS, self.count))
        self.points = OrderedPoints(ball.vertices, rows)


class _OnGrid(_Ball):
    """A point has so many nodes, and a sum of each channel over all of them."""

    rule = RULES[-1]

    def setup(self) -> None:
        super().setup()
        self.grid = blocks.PointGrid(self.points)
        self.sums = self.grid.sums(self.width, self.rule)
        kept = self.grid._kept
        assert kept is not None
        self.sort, self.spread = kept
        self.cells = 0, len(self.sort.cells.keys)
        self.block_bytes = 4 * BLOCK**3 * CHANNELS
        self.point_bytes = self.count * (3 * 8 + 8 + 4 * CHANNELS)

    def _of_points(self) -> Needed:
        nodes = self.count * CHANNELS * self.rule.nodes**3
        return Needed(self.point_bytes + len(self.spread.keys) * self.block_bytes, nodes)


class Spreading(_OnGrid):
    """Points on the nodes round them."""

    def time_running(self) -> None:
        self.grid._spread(self.sort, *self.cells)

    def needed(self) -> Needed:
        return self._of_points()


class Blurring(_OnGrid):
    """All blocks along three axes."""

    def setup(self) -> None:
        super().setup()
        density = self.width / self.sort.spacing
        self.taps = blur_taps(self.rule, density)
        far = -(-(len(self.taps) // 2) // BLOCK)
        wanted, _ = self.sort.touched(*self.cells)
        self.way = blurs(self.spread.keys, wanted, far, self.sort.cells.step)

    def time_running(self) -> None:
        self.grid._blurred(self.way, self.spread.grid, np.pad(self.taps, BLOCK))

    def needed(self) -> Needed:
        each = sum(len(near) for near in self.way.near)
        ends = len(self.spread.keys) + len(self.way.near[2])
        nodes = each * BLOCK**3 * CHANNELS
        return Needed(ends * self.block_bytes, nodes * len(self.taps))


class Gathering(Blurring):
    """The nodes round each point, from a grid that is blurred: a sum less its blur."""

    def setup(self) -> None:
        super().setup()
        self.blurred = self.grid._blurred(self.way, self.spread.grid, np.pad(self.taps, BLOCK))
        self.grid._blurred = lambda *_: self.blurred  # type: ignore[method-assign]

    def time_running(self) -> None:
        sums = np.ascontiguousarray(self.sums.T)
        self.grid._gather(self.sort, self.spread, self.cells, self.width, None, sums)

    def needed(self) -> Needed:
        return self._of_points()


class Neighbours(_Ball):
    """Pairs within the radius, at the width of an edge: nine channels, a distance and a power."""

    edges, error = 1.0, 6e-6
    pair = CHANNELS + 3 + 7

    def setup(self) -> None:
        super().setup()
        self.groups, self.radius = direct.PointGroups(self.points), 4.9
        self.time_running()

    def time_running(self) -> None:
        self.groups.sums(self.width, self.radius, np.float32)

    def needed(self) -> Needed:
        from scipy.spatial import cKDTree

        points = self.points.points
        tree = cKDTree(points)
        some = tree.query_ball_point(points[::40], self.radius * self.width, return_length=True)
        pairs = float(np.mean(some)) * self.count
        return Needed(self.count * (12 + 8 * CHANNELS), pairs * self.pair)


class Frequencies(_Ball):
    """Transforms to frequencies and back in double precision, as tolerances of 1e-6 want them."""

    edges, error, pairs = 12.0, 6e-8, 5

    def setup(self) -> None:
        super().setup()
        self.xyz = np.ascontiguousarray(self.points.points.T) / self.width
        self.rows = np.ones((2 * self.pairs, self.count))
        self.tiles, _ = spectral.plan_tiles(self.xyz, self.error, self.pairs)
        self.time_running()

    def time_running(self) -> None:
        spectral.spectral_sums(self.xyz, self.rows, self.error, self.tiles)

    def needed(self) -> Needed:
        adds = sent = 0.0
        for tile in self.tiles:
            targets, sources = self.xyz[:, tile.targets], self.xyz[:, tile.sources]
            _, _, modes = spectral._torus(targets, sources, self.error)
            count = len(tile.targets) + len(tile.sources)
            finer, _ = spectral._refinement(modes, count, self.error)
            digits = math.log10(1 / self.error)
            across = math.ceil(digits + 2 if finer == 2 else 1.64 * digits + 1)
            cells = float(np.prod(finer * modes))
            # A complex transform of N takes 5 N log₂ N operations; a multiply-add is two, and half
            # as many as of single precision are in a vector.
            adds += self.pairs * 2 * (count * 2 * across**3 + 2 * 2.5 * cells * math.log2(cells))
            sent += self.pairs * (count * 16 + 4 * 16 * cells)
        return Needed(sent, adds)


# --- methods ------------------------------------------------------------------------------------


class Bands(_OneCore):
    """Exaggerated Shading of nine scales under a new light."""

    scales = 9
    light = as_light((30.0, 40.0)).direction

    def setup(self) -> None:
        threads.limit(1)
        self.space = md.scale_space(subjects.mesh(SUBJECT), scales=self.scales)
        self.weights = np.full(self.scales + 1, 0.1)
        assert len(self.space.planes) == self.scales + 1
        self.time_running()

    def time_running(self) -> None:
        combine_bands(self.space, self.light, self.weights, 5 * np.ones(self.scales + 1), 0.01)

    def needed(self) -> Needed:
        count = self.space.count
        return Needed(count * 4 * (3 * (self.scales + 1) + 1), count * self.scales * 17)


class Rays(_OneCore):
    """Sixteen rays from each vertex, sorted into those that meet a face and those that don't."""

    rays = 16

    def setup(self) -> None:
        from meshdepict.transport.transfer import traced_transfer

        threads.limit(1)
        self.mesh = md.samples.torus(subjects.BALLS[SUBJECT])  # whose inside sees itself
        self.trace = traced_transfer
        self.time_running()

    def time_running(self) -> None:
        self.found = self.trace(self.mesh, rays=self.rays)

    def needed(self) -> Needed:
        rays = self.rays * len(self.found)
        # At the least a way down a tree of eight branches, six planes of each, and a triangle.
        depth = math.log(len(self.mesh.faces), 8)
        return Needed(rays * (24 + 24 + 8), rays * (depth * 8 * 6 + 20))


class Bounce(Rays):
    """What arrives of red, green and blue light that the surface sends."""

    rays = 64

    def setup(self) -> None:
        super().setup()
        self.light = np.random.default_rng(1).random((len(self.found), 3)).astype(np.float32)

    def time_running(self) -> None:
        if hasattr(self, "light"):
            self.found.from_surface(self.light)
        else:
            super().time_running()

    def needed(self) -> Needed:
        hits = int(self.found.hits[-1])
        ends = self.light.nbytes * 2 + self.found.faces.nbytes
        return Needed(hits * 8 + ends, hits * 3 * 3)


class Voxels(_OneCore):
    """A CT smoothed by a Gaussian of three voxels along each axis."""

    size, width = 128, 3.0

    def setup(self) -> None:
        threads.limit(1)
        self.values = np.random.default_rng(1).random((self.size,) * 3).astype(np.float32)
        band = gaussian_band(self.size, self.size, self.width, reach=4.0)
        self.band = band.rows(0, self.size, 0, np.float32)
        self.out = np.empty_like(self.values)
        self.time_running()

    def time_running(self) -> None:
        resample(self.values, (self.band,) * 3, self.out)

    def needed(self) -> Needed:
        return Needed(2 * self.values.nbytes, self.values.size * 3 * self.band.taps)


KERNELS: dict[str, Any] = {
    "spreading": Spreading,
    "blurring": Blurring,
    "gathering": Gathering,
    "neighbours": Neighbours,
    "frequencies": Frequencies,
    "exaggerated shading": Bands,
    "rays": Rays,
    "a bounce": Bounce,
    "voxels": Voxels,
}
