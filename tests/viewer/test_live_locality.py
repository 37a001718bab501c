"""The order of triangles: none lost, none turned, neighbours near each other."""

import numpy as np

from meshdepict.viewer.live.locality import along_curve


def test_it_is_a_permutation(ball, rng):
    points = ball.vertices.astype(np.float32)
    shuffled = rng.permutation(ball.faces)
    ordered = along_curve(points, shuffled)
    assert (np.unique(ordered, axis=0) == np.unique(ball.faces, axis=0)).all()


def test_the_curve_is_the_interleaving_of_bits(rng):
    """Against Morton codes written bit by bit as text."""
    cells = rng.integers(0, 8, (64, 3))
    cells[0], cells[1] = 0, 7  # so that a step is a step
    points = (cells / 7).astype(np.float32)
    faces = np.repeat(np.arange(64)[:, None], 3, axis=1)

    # 21 bits of x·(2²¹ − 1) for x = k/7: binary 0.kkk… repeating, hence k's own bits seven times.
    def code(cell):
        x, y, z = (f"{k:03b}" * 7 for k in cell)
        return "".join(c + b + a for a, b, c in zip(x, y, z, strict=True))

    ordered = along_curve(points, faces)[:, 0]
    codes = [code(cells[i]) for i in ordered]
    assert codes == sorted(codes)


def test_shuffled_neighbours_come_together_again(ball, rng):
    points = ball.vertices.astype(np.float32)
    shuffled = rng.permutation(ball.faces)

    def shaded_anew(faces, cache=256):
        """How often a vertex is not among the last ones used."""
        seen, misses = {}, 0
        for step, vertex in enumerate(faces.ravel()):
            misses += step - seen.get(vertex, -cache) >= cache
            seen[vertex] = step
        return misses / len(points)

    assert shaded_anew(shuffled) > 5.5  # six triangles meet at a vertex
    assert shaded_anew(along_curve(points, shuffled)) < 2


def test_a_single_point_and_a_plane_have_an_order():
    faces = np.array([[0, 1, 2]])
    assert (along_curve(np.ones((3, 3), np.float32), faces) == faces).all()
    flat = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.float32)
    assert (along_curve(flat, faces) == faces).all()
