"""Curvature as the eye sees it, against exact depths and their derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import rotation
from exact_surfaces import SURFACES, graph

from meshdepict import curvature, samples, scale_space
from meshdepict.curvature.principal import PrincipalCurvatures
from meshdepict.curvature.view import conductance, eye_frames, view_hessian, view_tensor
from meshdepict.errors import MeshdepictError
from meshdepict.scene.view import View
from meshdepict.shapes.mesh import Mesh

FORESHORTENINGS = [0.0, 0.4, 1.0, 2.0]


def front(**options):
    return View((0, 0, 10), (0, 0, 0), (0, 1, 0), **({"parallel_scale": 1.0} | options))


def exact_curvatures(exact):
    return PrincipalCurvatures(exact.k1, exact.k2, exact.d1, exact.d2)


def seen(exact, view, **options):
    """View curvature of exact normals and curvatures: no estimate enters."""
    points = exact.mesh.vertices
    turns = np.ones(len(points))
    return view_tensor(points, exact.normals, exact_curvatures(exact), turns, view, **options)


def hessian(found, view):
    """H = [u v] diag(ku, kv) [u v]ᵀ in the view's image plane: (n, 2, 2)."""
    image = view.frame[:2]
    u, v = (d.astype(float) @ image.T for d in (found.u, found.v))
    ku, kv = found.ku[:, None, None], found.kv[:, None, None]
    return ku * u[:, :, None] * u[:, None] + kv * v[:, :, None] * v[:, None]


@pytest.mark.parametrize("name", ["plane", "saddle", "monkey", "wavy"])
def test_a_graph_seen_from_above_shows_the_hessian_of_its_height(name):
    exact = graph(name)
    view = front(parallel_scale=2.0, height_px=800)
    x, y = exact.mesh.vertices[:, 0], exact.mesh.vertices[:, 1]
    zero = 0 * x
    xx, xy, yy = {
        "plane": (zero, zero, zero),
        "saddle": (zero + 2, zero, zero - 1.4),
        "monkey": (6 * x, -6 * y, -6 * x),
        "wavy": (
            -3.2 * np.sin(8 * x) * np.cos(8 * y),
            -3.2 * np.cos(8 * x) * np.sin(8 * y),
            -3.2 * np.sin(8 * x) * np.cos(8 * y),
        ),
    }[name]
    pixel = 2 * 2.0 / 800
    found = seen(exact, view)
    expected = np.stack([[xx, xy], [xy, yy]]).transpose(2, 0, 1) * pixel
    np.testing.assert_allclose(hessian(found, view), expected, atol=1e-6 * pixel)
    # Its trace is the Laplacian of the height.
    np.testing.assert_allclose(2 * found.mean, (xx + yy) * pixel, atol=1e-9)


@pytest.mark.parametrize("f", FORESHORTENINGS)
@pytest.mark.parametrize("name", ["saddle", "monkey", "wavy"])
def test_every_foreshortening_is_the_derivative_of_its_slope(name, f):
    exact = graph(name)
    x, y, _ = exact.mesh.vertices.T
    step = 1e-5

    def slope(x, y):  # g = (−n_x, −n_y) / n_z^f of the height's exact gradient
        hx, hy = {
            "saddle": lambda: (2 * x, -1.4 * y),
            "monkey": lambda: (3 * x * x - 3 * y * y, -6 * x * y),
            "wavy": lambda: (
                0.4 * np.cos(8 * x) * np.cos(8 * y),
                -0.4 * np.sin(8 * x) * np.sin(8 * y),
            ),
        }[name]()
        nz = 1 / np.sqrt(1 + hx * hx + hy * hy)
        return np.stack([hx * nz, hy * nz]) / nz**f

    gx = (slope(x + step, y) - slope(x - step, y)) / (2 * step)
    gy = (slope(x, y + step) - slope(x, y - step)) / (2 * step)
    off = (gx[1] + gy[0]) / 2
    expected = np.stack([[gx[0], off], [off, gy[1]]]).transpose(2, 0, 1)
    view = front(parallel_scale=0.5, height_px=1)  # one pixel is one unit
    np.testing.assert_allclose(
        hessian(seen(exact, view, foreshortening=f), view), expected, atol=1e-5
    )


def test_a_sphere_in_closed_form():
    exact = SURFACES["sphere"]()
    view = front()
    found = seen(exact, view)
    x, y, z = exact.mesh.vertices.T
    # z = √(1 − ρ²): −1/z³ along ρ, −1/z across it.
    near = z > 0.05
    pixel = 2 / 1000
    np.testing.assert_allclose(found.ku[near], -pixel / z[near] ** 3, rtol=1e-9)
    np.testing.assert_allclose(found.kv[near], -pixel / z[near], rtol=1e-9)
    radius = np.hypot(x, y)
    outwards = np.stack([x, y, 0 * x], axis=1) / np.where(radius > 0, radius, 1)[:, None]
    clear = near & (radius > 0.1)
    along = np.abs(np.einsum("ij,ij->i", found.u, outwards))[clear]
    np.testing.assert_allclose(along, 1, atol=1e-6)


def cylinder():
    """Unit normals and curvature of a cylinder of radius ½ about the y axis, its front."""
    angle = np.linspace(-1.4, 1.4, 57)
    normals = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    across = np.stack([np.cos(angle), 0 * angle, -np.sin(angle)], axis=1)
    along = np.broadcast_to([0.0, 1.0, 0.0], across.shape)
    curvatures = PrincipalCurvatures(0 * angle + 2, 0 * angle, across, along)
    return normals / 2, normals, curvatures


def test_a_cylinder_in_closed_form():
    points, normals, curvatures = cylinder()
    found = view_tensor(points, normals, curvatures, np.ones(len(points)), front())
    np.testing.assert_allclose(found.ku, -(2 / 1000) * 2 / normals[:, 2] ** 3, rtol=1e-9)
    np.testing.assert_allclose(found.kv, 0, atol=1e-12)
    np.testing.assert_allclose(np.abs(found.u[:, 0]), 1, atol=1e-6)
    # Without foreshortening it is the derivative of −n_x alone: −dn_x/dx = −1/r everywhere.
    plain = view_tensor(
        points, normals, curvatures, np.ones(len(points)), front(), foreshortening=0
    )
    np.testing.assert_allclose(plain.ku, -(2 / 1000) * 2, rtol=1e-9)


@pytest.mark.parametrize("perspective", [False, True])
def test_a_plane_shows_no_curvature_however_it_is_seen(perspective):
    exact = graph("plane")
    eye = (
        {"field_of_view": 40.0, "parallel_scale": None} if perspective else {"parallel_scale": 1.0}
    )
    found = seen(exact, View((3, 2, 4), (0, 0, 0), (0, 1, 0), **eye))
    np.testing.assert_allclose(found.ku, 0, atol=1e-12)


def test_bumps_are_negative_and_hollows_positive():
    ball = samples.sphere(600)
    for faces, sign in ((ball.faces, -1), (ball.faces[:, ::-1], 1)):
        space = scale_space(Mesh(ball.vertices, faces, winding="keep"), scales=1)
        found = curvature.view_curvature(space, "front" if sign < 0 else "back", scale=0)
        facing = found.weight > 0.99
        assert facing.any()
        assert (sign * found.ku[facing] > 0).all()
        assert (sign * found.kv[facing] > 0).all()


@pytest.mark.parametrize("eye", [{"parallel_scale": 1.3}, {"field_of_view": 50.0}])
def test_frames_are_right_handed_and_ordered(eye, rng):
    exact = SURFACES["torus"]()
    view = View((1.5, 2, 2.5), (0.1, 0, 0), (0, 1, 0.2), **eye)
    found = seen(exact, view)
    (_, _, z), _ = eye_frames(exact.mesh.vertices, view)
    frame = np.stack([found.u, found.v, z], axis=1)
    products = np.einsum("nij,nkj->nik", frame, frame)
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(3), products.shape), atol=1e-6)
    assert (np.linalg.det(frame) > 0).all()
    assert (np.abs(found.ku) >= np.abs(found.kv)).all()


def test_a_perspective_frame_looks_at_the_eye(rng):
    view = View((1, 2, 3), (0, 0, 0), (0, 1, 0), field_of_view=60)
    points = rng.normal(size=(200, 3))
    (x, y, z), pixel = eye_frames(points, view)
    towards = view.position - points
    np.testing.assert_allclose(z, towards / np.linalg.norm(towards, axis=1, keepdims=True))
    for a, b, expected in ((x, x, 1), (y, y, 1), (x, y, 0), (x, z, 0), (y, z, 0)):
        np.testing.assert_allclose(np.einsum("ij,ij->i", a, b), expected, atol=1e-12)
    np.testing.assert_allclose(np.cross(x, y), z, atol=1e-12)
    # On the view's axis the frame is the view's own, and a pixel 2 · depth · tan / height.
    (x, y, z), pixel = eye_frames(np.zeros((1, 3)), view)
    np.testing.assert_allclose(np.concatenate([x, y, z]), view.frame, atol=1e-12)
    np.testing.assert_allclose(pixel, 2 * np.sqrt(14) * np.tan(np.radians(30)) / 1000)


def test_a_pixel_of_a_perspective_is_what_one_row_of_the_picture_shows():
    view = View((0, 0, 5), (0, 0, 0), (0, 1, 0), field_of_view=40, height_px=300)
    depth, rows = 3.0, np.array([0.0, 1.0])
    height = rows / 150 * np.tan(np.radians(20)) * depth  # two rows' places at that depth
    points = np.stack([0 * height, height, 5 - depth + 0 * height], axis=1)
    _, pixel = eye_frames(points, view)
    np.testing.assert_allclose(pixel, height[1] - height[0])


def test_doubling_the_distance_doubles_curvature_per_pixel():
    # A pixel then spans twice as much of the surface, so the slope changes twice as much across
    # it, as on a sphere drawn half as large. With twice the pixels nothing changes.
    exact = SURFACES["sphere"]()
    top = [int(np.argmax(exact.mesh.vertices[:, 2]))]
    centre = exact.mesh.vertices[top[0]]
    out = exact.normals[top[0]]
    near = View(centre + 4 * out, centre, (0, 1, 0), field_of_view=30)
    far = View(centre + 8 * out, centre, (0, 1, 0), field_of_view=30)
    one, two = (seen(exact, view).ku[top] for view in (near, far))
    np.testing.assert_allclose(two, 2 * one, rtol=1e-9)
    fine = seen(exact, replace(far, height_px=2000)).ku[top]
    np.testing.assert_allclose(fine, one, rtol=1e-9)
    narrow = replace(far, field_of_view=2 * np.degrees(np.arctan(np.tan(np.radians(15)) / 2)))
    np.testing.assert_allclose(seen(exact, narrow).ku[top], one, rtol=1e-9)


def test_a_distant_perspective_is_the_parallel_view():
    exact = SURFACES["torus"]()
    direction = np.array([1.0, 2.0, 1.5])
    parallel = View(direction, (0, 0, 0), (0, 1, 0), parallel_scale=1.0)
    distance = 1e6
    angle = 2 * np.degrees(np.arctan(1.0 / distance))
    far = View(
        direction / np.linalg.norm(direction) * distance, (0, 0, 0), (0, 1, 0), field_of_view=angle
    )
    one, other = seen(exact, parallel), seen(exact, far)
    clear = one.weight > 0.5
    np.testing.assert_allclose(other.ku[clear], one.ku[clear], rtol=1e-4)
    np.testing.assert_allclose(other.weight, one.weight, atol=1e-4)


@pytest.mark.parametrize("eye", [{"parallel_scale": 1.3}, {"field_of_view": 50.0}])
def test_turning_mesh_and_view_together_turns_the_frame_alone(eye, rng):
    exact = SURFACES["torus"](600)
    turn, shift = rotation(rng), np.array([5.0, -3, 2])
    position, focus, up = np.array([1.5, 2, 2.5]), np.array([0.1, 0, 0]), np.array([0, 1, 0.2])
    turned = Mesh(exact.mesh.vertices @ turn.T + shift, exact.mesh.faces)
    other = replace(
        exact, mesh=turned, normals=exact.normals @ turn.T,
        d1=exact.d1 @ turn.T, d2=exact.d2 @ turn.T,
    )  # fmt: skip
    one = seen(exact, View(position, focus, up, **eye), foreshortening=0.4)
    two = seen(
        other, View(turn @ position + shift, turn @ focus + shift, turn @ up, **eye),
        foreshortening=0.4,
    )  # fmt: skip
    np.testing.assert_allclose(two.ku, one.ku, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(two.kv, one.kv, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(two.weight, one.weight, atol=1e-6)
    sense = np.sign(np.einsum("ij,ij->i", two.u, one.u @ turn.T))[:, None]
    clear = np.abs(one.ku) > 1.01 * np.abs(one.kv)
    np.testing.assert_allclose((two.u * sense)[clear], (one.u @ turn.T)[clear], atol=1e-4)


def test_scaling_mesh_and_view_together_changes_nothing(ball):
    for factor in (1e-120, 40.0, 1e120):
        large = Mesh(ball.vertices * factor, ball.faces)
        eye = View(np.array([3, 1, 4]) * factor, (0, 0, 0), (0, 1, 0), field_of_view=30)
        small = View((3, 1, 4), (0, 0, 0), (0, 1, 0), field_of_view=30)
        one = curvature.view_curvature(scale_space(ball, scales=1), small)
        two = curvature.view_curvature(scale_space(large, scales=1), eye)
        # The normals of the two scale spaces agree to single precision.
        facing = one.weight > 0.5
        np.testing.assert_allclose(
            two.mean[facing], one.mean[facing], atol=1e-4 * np.ptp(one.mean[facing])
        )


def test_everything_is_finite_behind_and_at_the_eye():
    exact = SURFACES["torus"]()
    for position in ((0.0, 0, 0), tuple(exact.mesh.vertices[7]), (1.0, 0, 0)):
        for towards in ((0.3, 0, 0.1), (-1, 0, 0), (0, 0, 1)):
            view = View(position, np.add(position, towards), (0, 1, 0.1), field_of_view=90)
            found = seen(exact, view, foreshortening=2.0)
            for array in found:
                assert np.isfinite(array).all()
            lengths = np.linalg.norm(found.u, axis=1)
            np.testing.assert_allclose(lengths, 1, atol=1e-6)


def test_behind_the_eye_there_are_no_pixels():
    view = View((0, 0, 1), (0, 0, 0), (0, 1, 0), field_of_view=30)
    (x, y, z), pixel = eye_frames(np.array([[0.0, 0, 2], [0, 0, 1], [0.5, 0, 3]]), view)
    np.testing.assert_array_equal(pixel, 0)
    np.testing.assert_allclose(np.cross(x, y), z, atol=1e-12)


def test_a_surface_turned_away_takes_the_value_at_the_limit():
    points, _, curvatures = cylinder()
    (x, y, z), pixel = eye_frames(points, front())
    edge = np.array([[1.0, 0, 0]])
    some = PrincipalCurvatures(*(np.broadcast_to(a[:1], (1, *a.shape[1:])) for a in curvatures))
    some = some._replace(d1=np.array([[0.0, 0, -1]]))
    row = (x[:1], y[:1], z[:1])
    limit = view_hessian(edge, some, row, pixel[:1])
    # n_z is held at 0.01: t_x = (1, 0, −100), and −II / n_z = −2 · 100² · 100 per unit.
    assert limit[0][0] == pytest.approx(-2 * 1e6 * pixel[0])
    away = view_hessian(np.array([[1.0, 0, -0.5]]), some, row, pixel[:1])
    np.testing.assert_allclose(away, limit)


def test_the_weight_falls_at_silhouettes_and_creases():
    np.testing.assert_allclose(
        conductance([1.0, 0.2, 0.1, 0.0, -1.0], np.ones(5)), [1, 1, 0.5, 0, 0]
    )
    angles = np.array([0, 30, 45, 60, 180])
    np.testing.assert_allclose(
        conductance(np.ones(5), np.cos(np.radians(angles))), [1, 1, 0.5, 0, 0], atol=1e-12
    )
    # The larger of the two decides.
    assert conductance(0.1, np.cos(np.radians(60))) == pytest.approx(0, abs=1e-12)
    assert conductance(0.1, np.cos(np.radians(40))) == pytest.approx(0.5)


def test_a_cube_has_creases_along_its_edges_and_a_ball_has_none():
    side = np.linspace(-1, 1, 9)
    a, b = (grid.ravel() for grid in np.meshgrid(side, side))
    face = np.arange(81).reshape(9, 9)
    quads = np.stack([face[:-1, :-1], face[:-1, 1:], face[1:, 1:], face[1:, :-1]], axis=-1).reshape(
        -1, 4
    )
    one = np.ones(81)
    parts = [(one, a, b), (-one, b, a), (b, one, a), (a, -one, b), (a, b, one), (b, a, -one)]
    vertices = np.vstack([np.stack(part, axis=1) for part in parts])
    cube = Mesh(vertices, np.vstack([quads + 81 * i for i in range(6)]))
    space = scale_space(cube, scales=1, width=1e-3)
    found = curvature.view_curvature(space, View((5, 4, 7), (0, 0, 0), (0, 1, 0)), scale=0)
    seen_faces = (space.normals[0] @ [5, 4, 7]) > 0
    from_edge = np.sort(1 - np.abs(vertices), axis=1)[:, 1]
    assert (found.weight[seen_faces & (from_edge == 0)] < 0.7).all()  # 45° between neighbours
    assert (found.weight[seen_faces & (from_edge > 0.3)] == 1).all()
    ball = curvature.view_curvature(scale_space(samples.sphere(600), scales=1), "front")
    assert ball.weight.max() == 1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda s: curvature.view_curvature(s, "front", scale=3),
            "scale=3 is not one of .* 0 to 2",
        ),
        (lambda s: curvature.view_curvature(s, "front", scale=-1), "scale=-1 is not one of"),
        (lambda s: curvature.view_curvature(s, "front", scale=1.5), "scale=1.5 is not one of"),
        (lambda s: curvature.view_curvature(s, "frnt"), "no view is called 'frnt'"),
        (lambda s: curvature.view_curvature(s, "front", foreshortening=-1), "foreshortening=-1"),
        (lambda s: curvature.view_curvature(s, "front", foreshortening=float("nan")), "nan is not"),
        (lambda s: s.curvature(True), "scale=True is not one of"),
        (lambda s: s.curvature("fine"), "scale='fine' is not one of"),
    ],
)
def test_errors(call, message):
    space = scale_space(samples.sphere(42), scales=2)
    with pytest.raises(MeshdepictError, match=message):
        call(space)


def test_a_scale_space_computes_a_curvature_once_and_only_when_asked(ball, monkeypatch):
    from meshdepict.curvature import creases, principal

    calls = []

    def count(module, name):
        original = getattr(module, name)

        def counted(*given):
            calls.append(name)
            return original(*given)

        monkeypatch.setattr(module, name, counted)

    count(principal, "_from_normals")
    count(creases, "neighbour_cosines")
    space = scale_space(ball, scales=2)
    assert calls == []
    assert space.curvature(1) is space.curvature(1)
    assert calls == ["_from_normals"]
    for view in ("front", "left", "front"):
        space.view_curvature(view, 1)
    assert sorted(calls) == ["_from_normals", "neighbour_cosines"]
    space.curvature(2)
    assert calls.count("_from_normals") == 2


def test_the_function_and_the_method_give_the_same(ball):
    space = scale_space(ball, scales=2)
    one = curvature.view_curvature(space, "left", scale=2, foreshortening=0.4)
    two = space.view_curvature(View.fitted("left", ball), 2, foreshortening=0.4)
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a, b)


def test_curvature_at_a_scale_is_that_of_its_normals(ball):
    space = scale_space(ball, scales=3)
    for scale in range(4):
        direct = curvature.principal_curvatures(ball, normals=space.normals[scale])
        np.testing.assert_array_equal(space.curvature(scale).k1, direct.k1)


def test_an_estimated_surface_is_seen_like_the_exact_one():
    exact = SURFACES["torus"](10_000)
    view = View((2, 3, 4), (0, 0, 0), (0, 1, 0), parallel_scale=1.0)
    estimated = curvature.view_curvature(scale_space(exact.mesh, scales=0), view, scale=0)
    known = seen(exact, view)
    clear = known.weight > 0.99
    pixel = 2 / 1000
    difference = (estimated.mean - known.mean)[clear] / pixel
    assert np.abs(difference).max() < 0.02 * np.abs(known.mean[clear] / pixel).max()
