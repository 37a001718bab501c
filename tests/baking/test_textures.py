"""Textures that are baked: the same shading as at the pixels of a picture."""

import dataclasses

import numpy as np
import pytest
from textured_shapes import globe, laid, picture, sheet

import meshdepict as md
from meshdepict import color, samples
from meshdepict.baking.layer_list import Layer
from meshdepict.baking.textures import bake_texture
from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.images.encoded import kind_of
from meshdepict.scales.interpolated_scales import InterpolatedSpace
from meshdepict.scales.making import scale_space
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.mesh import Mesh
from meshdepict.shapes.textures import Texture


def looked_up(baked, triangle, weights):
    """What a viewer shows of a texture at places in triangles, in grey levels."""
    texture = Texture("baked", None)
    vars(texture)["pixels"] = baked.image
    at = np.einsum("nc,ncx->nx", weights, baked.texcoords[triangle])
    return 255 * texture.lookup(at)


def per_pixel(mesh, baked, view="front", side=300):
    """Differences to the same shading at the pixels of a view, in grey levels."""
    buffer, look = GBuffer.of(mesh, view, size=(side, side)), baked.look
    space = scale_space(mesh, scales=look.ladder[0], ratio=look.ladder[1], width=look.width)
    seen = InterpolatedSpace(space, mesh.faces[buffer.triangle], buffer.barycentric)
    values = look.shade(seen, look.light, look.eye(mesh))
    wanted = color.encode(values, linear=look.declared.linear).astype(float)
    return np.abs(looked_up(baked, buffer.triangle, buffer.barycentric) - wanted).max(axis=1)


def agrees(error):
    """At most one grey level rms, and 99 % within three."""
    assert np.sqrt(np.mean(error**2)) <= 1
    assert np.mean(error <= 3) >= 0.99


@pytest.mark.parametrize(
    "method", ["exaggerated", "lambert", "radiance_scaling", "light_alignment"]
)
@pytest.mark.parametrize("atlas", ["own", "new"])
def test_a_textured_sphere_is_shaded_as_its_pixels_are(method, atlas):
    ball = globe(24)
    baked = bake_texture(ball, method, size=1024, atlas=atlas)
    for view in ("front", "left", "top"):
        agrees(per_pixel(ball, baked, view))


@pytest.mark.parametrize("atlas", ["new", "xatlas"])
def test_a_golf_ball_is_shaded_as_its_pixels_are(atlas):
    if atlas == "xatlas":
        pytest.importorskip("xatlas")
    ball = samples.golf_ball(1500)
    baked = bake_texture(ball, size=2048, atlas=atlas)
    agrees(per_pixel(ball, baked))


def test_a_scan_is_shaded_as_its_pixels_are(bunny):
    baked = bake_texture(bunny, size=3000)
    agrees(per_pixel(bunny, baked, side=500))


def smaller(image, times):
    """A texture's mipmap, so many times halved."""
    found = image.astype(np.float64)
    for _ in range(times):
        found = sum(found[a::2, b::2] for a in (0, 1) for b in (0, 1)) / 4
    return np.rint(found).astype(np.uint8)


def test_on_both_sides_of_seams_every_mipmap_shows_what_it_does_within_charts():
    ball = globe(24, margin=0.08)
    baked = bake_texture(ball, "exaggerated", size=1024)
    image = baked.image
    sides = [np.arange(3), np.roll(np.arange(3), -1)]
    places = np.round(ball.vertices[ball.faces], 9)
    edge = np.stack([places[:, s] for s in sides], 2).reshape(-1, 2, 3)
    at = np.stack([ball.texcoords[:, s] for s in sides], 2).reshape(-1, 2, 2)
    forward = np.lexsort(edge.reshape(-1, 6).T)
    backward = np.lexsort(edge[:, ::-1].reshape(-1, 6).T)
    assert np.array_equal(edge[forward], edge[backward][:, ::-1])  # closed: each has its other side
    one, other = at[forward].mean(axis=1), at[backward].mean(axis=1)
    seam = np.abs(one - other).max(axis=1) > 1e-9
    assert 500 < seam.sum() < len(seam) / 5
    across = at[forward][:, 1] - at[forward][:, 0]
    across = np.stack([-across[:, 1], across[:, 0]], 1)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    for times in range(5):
        texture = Texture("mipmap", None)
        vars(texture)["pixels"] = smaller(image, times)
        half = across * 2**times / len(image) / 2
        at_seams = texture.lookup(one[seam]) - texture.lookup(other[seam])
        inside = texture.lookup((one + half)[~seam]) - texture.lookup((one - half)[~seam])
        rms = [255 * np.sqrt(np.mean(part**2)) for part in (at_seams, inside)]
        assert rms[0] <= rms[1] + 2


# --- looks -----------------------------------------------------------------------------------


def test_a_new_light_gives_what_a_new_bake_gives():
    ball = globe(8)
    first = bake_texture(ball, size=128, light="east")
    again = first.with_look(light="west")
    assert np.array_equal(again.image, bake_texture(ball, size=128, light="west").image)
    assert not np.array_equal(again.image, first.image)
    assert again.provenance["light"].startswith("west")


@pytest.mark.parametrize("change", [{"scales": 3}, {"method": "lambert"}, {"creases": 40}])
def test_other_samples_come_too_late_for_a_new_light(change):
    with pytest.raises(MeshdepictError, match=f"{next(iter(change))} comes too late"):
        bake_texture(globe(4), size=64).with_look(**change)


def test_the_same_texture_comes_from_any_number_of_threads(monkeypatch):
    from meshdepict import threads

    images = []
    for count in (1, 3):
        monkeypatch.setattr(threads, "_limit", count)
        images.append(bake_texture(globe(8), size=700).image)
    assert np.array_equal(*images)


def test_colour_maps_tints_blends_and_two_lights_reach_the_texels():
    ball = globe(8)
    gray = bake_texture(ball, size=128).image
    assert (gray == gray[..., :1]).all()
    for look in (
        {"colormap": "viridis"}, {"tint": "earth"}, {"colormap2d": "dusk"},
        {"blend": "lambert:multiply:0.5,exaggerated", "tint": "earth"},
    ):  # fmt: skip
        found = bake_texture(ball, size=128, **look).image
        assert not (found == found[..., :1]).all()


def test_at_the_vertices_a_texture_has_the_colours_of_a_bake():
    ball = globe(16)
    options = {"light": "west", "colormap": "viridis"}
    at_vertices = md.bake(ball, **options).colors[ball.faces[:, 0]].astype(float)
    baked = bake_texture(ball, size=2048, **options)
    first = np.zeros((len(ball.faces), 3))
    first[:, 0] = 1
    error = np.abs(looked_up(baked, np.arange(len(ball.faces)), first) - at_vertices)
    assert np.median(error) <= 1
    assert np.quantile(error, 0.99) <= 6


def test_methods_that_look_around_are_shaded_at_the_vertices_and_interpolated():
    ball = globe(12)
    for method in ("accessibility", "unsharp_masking", "integral_invariant"):
        look = md.bake(ball, method)
        baked = bake_texture(ball, method, size=512)
        buffer = GBuffer.of(ball, "front", size=(150, 150))
        values = np.clip(buffer.sample(look.intensity), 0, 1)
        wanted = color.encode(values, linear=look.look.declared.linear).astype(float)
        agrees(np.abs(looked_up(baked, buffer.triangle, buffer.barycentric) - wanted).max(axis=1))


def test_rays_leave_from_the_texels():
    """A ball that hangs over a coarse floor casts a shadow much smaller than its triangles."""
    floor = sheet(1)
    ball = samples.sphere(400)
    points = np.concatenate([floor.vertices * 4 - (2, 2, 0), ball.vertices * 0.3 + (0, 0, 0.8)])
    mesh = Mesh(points, np.concatenate([floor.faces, ball.faces + 4]), winding="keep")
    baked = bake_texture(
        mesh, "phong", size=1024, shadows=True, light=(0, 0, 1), view="top", up="z"
    )
    x, y = np.meshgrid([-1.5, 0.0, 1.5], [-1.4, 0.0])
    spots = np.stack([x.ravel(), y.ravel()], 1) / 4 + 0.5
    below = spots[:, 0] > spots[:, 1]  # in the first of the two triangles
    weights = np.where(
        below[:, None],
        np.stack([1 - spots[:, 0], spots[:, 0] - spots[:, 1], spots[:, 1]], 1),
        np.stack([1 - spots[:, 1], spots[:, 0], spots[:, 1] - spots[:, 0]], 1),
    )
    shown = looked_up(baked, np.where(below, 0, 1), weights)[:, 0].reshape(2, 3)
    assert shown[1, 1] < shown[0, 0] - 50
    assert np.ptp(np.delete(shown.ravel(), 4)) < 3


LIT = {"light": "west:30", "shadows": True, "bounces": 1}


@pytest.fixture
def patient(monkeypatch):
    """The search for a number of rays takes what it takes: a busy machine would end it sooner."""
    from meshdepict.shading import sampled

    monkeypatch.setattr(sampled, "AUTO_SECONDS", np.inf)


@pytest.mark.usefixtures("patient")
def test_as_many_rays_as_it_takes_are_recorded_as_a_number_and_how_sure_light_is():
    """Both are the vertices', which stand for the texels."""
    bowl = sheet(12, height=lambda x, y: 0.3 * np.sin(9 * x + y))
    for rays in ("auto", 16):
        at_vertices = md.bake(bowl, "lambert", rays=rays, **LIT)
        baked = bake_texture(bowl, "lambert", size=64, rays=rays, **LIT)
        for name in ("rays auto", "light error", "options"):
            assert baked.provenance.get(name) == at_vertices.provenance.get(name)
        assert isinstance(baked.look.options["rays"], int)
        assert ("rays auto" in baked.provenance) == (rays == "auto")
        assert baked.provenance["light error"] != "0 grey levels"
    plain = bake_texture(bowl, "lambert", size=64)
    assert "light error" not in plain.provenance


@pytest.mark.usefixtures("patient")
def test_layers_find_their_rays_too():
    bowl = sheet(8, height=lambda x, y: 0.3 * np.sin(9 * x + y))
    lit = {"shadows": True, "bounces": 1, "rays": "auto"}
    blend = [Layer("lambert", options=lit), Layer("phong", "multiply", 0.5)]
    baked = bake_texture(bowl, size=64, blend=blend, light="west:30")
    said = baked.provenance["blend"]
    assert said == md.bake(bowl, blend=blend, light="west:30").provenance["blend"]
    assert "auto" not in said


# --- normal maps, colours of its own ------------------------------------------------------------


def bumps(size=256, number=16, depth=0.4):
    v, u = (np.mgrid[:size, :size] + 0.5) / size
    x, y = depth * np.cos(2 * np.pi * number * u), depth * np.cos(2 * np.pi * number * v)
    normal = np.stack([x, y, np.sqrt(1 - x * x - y * y)], -1)
    return np.rint(255 * (normal / 2 + 0.5))


def test_a_normal_map_gives_the_unsmoothed_normals():
    flat = sheet(2)
    mapped = laid(flat, flat.texcoords, normal=picture(bumps()))
    options = {"light": (0.6, 0, 0.8), "size": 256}
    plain = bake_texture(flat, "lambert", **options).image
    shown = bake_texture(mapped, "lambert", **options)
    assert np.ptp(plain.astype(int)) <= 1
    normal = 2 * bumps() / 255 - 1
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    wanted = color.encode(np.clip(normal @ (0.6, 0, 0.8), 0, 1).ravel(), linear=True)
    error = np.abs(shown.image.reshape(-1, 3).astype(int) - wanted)
    assert error.max() <= 2
    assert "normals of its normal map" in shown.provenance["texture"]


def test_what_follows_the_shape_follows_its_normal_map_too():
    flat = sheet(16, height=lambda x, y: 0.02 * np.sin(9 * x))
    mapped = laid(flat, flat.texcoords, normal=picture(bumps(depth=0.1)))
    finest = [
        bake_texture(mesh, size=128).look.options["exaggeration"][0] for mesh in (flat, mapped)
    ]
    assert finest[1] < finest[0]


def test_radiance_scaling_brightens_the_bumps_of_a_normal_map():
    """On the unsmoothed scale curvature is the map's: a bump is where its normals part."""
    flat = sheet(2)
    mapped = laid(flat, flat.texcoords, normal=picture(bumps(number=4)))
    options = {"size": 256, "map": "curvature", "scale": 0}
    shown = bake_texture(mapped, **options).image[..., 0].astype(int)
    assert np.ptp(bake_texture(flat, **options).image) == 0
    v, u = (np.mgrid[:256, :256] + 0.5) / 256
    # ∇·n of the map: convex where its normals part.
    bend = -np.sin(2 * np.pi * 4 * u) - np.sin(2 * np.pi * 4 * (1 - v))
    assert (shown[bend > 0.7] > 128).all()
    assert (shown[bend < -0.7] < 128).all()


def test_a_normal_map_that_cant_be_read_is_left_out_with_a_note():
    flat = sheet(2)
    broken = laid(flat, flat.texcoords, normal=Texture("moon.png", b"no picture", "png"))
    with pytest.warns(MeshdepictWarning, match=r"moon.png.*: shaded without it"):
        baked = bake_texture(broken, "lambert", size=64)
    assert np.array_equal(baked.image, bake_texture(flat, "lambert", size=64).image)


def test_albedo_keep_multiplies_the_textures_colours_texel_by_texel():
    flat = sheet(1)
    checks = np.zeros((64, 64, 3))
    checks[(np.indices((64, 64)) // 8).sum(axis=0) % 2 == 0] = (200, 90, 30)
    colored = laid(flat, flat.texcoords, base=picture(checks))
    baked = bake_texture(colored, "lambert", size=64, albedo="keep", light=(0, 0, 1))
    assert np.abs(baked.image.astype(int) - checks).max() <= 1


def test_albedo_keep_takes_the_vertices_colours_where_there_is_no_texture():
    flat = sheet(4)
    colors = {
        name: np.full(25, level, np.uint8)
        for name, level in zip(("red", "green", "blue"), (9, 99, 199), strict=True)
    }
    mesh = Mesh(flat.vertices, flat.faces, attributes={"vertex": colors})
    baked = bake_texture(mesh, "lambert", size=64, albedo="keep", light=(0, 0, 1))
    used = (baked.image == (9, 99, 199)).all(axis=2)
    assert used.mean() > 0.2
    with pytest.raises(MeshdepictError, match="own vertex colours"):
        bake_texture(samples.golf_ball(100), size=128, albedo="keep")


def test_a_texture_that_cant_be_read_is_one_sentence():
    flat = sheet(2)
    broken = laid(
        flat,
        flat.texcoords,
        base=Texture("oak.png", None, fault="names the texture 'oak.png', which is not there"),
    )
    with pytest.raises(MeshdepictError, match=r"albedo='keep' needs what can't be had: .*oak.png"):
        bake_texture(broken, size=64, albedo="keep")
    assert bake_texture(broken, "lambert", size=64).image.shape == (64, 64, 3)


# --- maps --------------------------------------------------------------------------------------


def test_a_map_of_the_unsmoothed_normals_is_level():
    found = bake_texture(globe(8), size=128, map="normal").image.astype(int)
    assert np.abs(found - (128, 128, 255)).max() <= 1


def test_a_map_of_smoothed_normals_leads_back_to_them():
    bumpy = sheet(24, height=lambda x, y: 0.03 * np.sin(20 * x) * np.cos(17 * y))
    baked = bake_texture(bumpy, size=512, map="normal", scales=3, width=0.05)
    mapped = laid(bumpy, bumpy.texcoords, normal=picture(baked.image))
    space = scale_space(bumpy, scales=3, width=0.05)
    light = np.array([0.5, 0.3, 0.81])
    light /= np.linalg.norm(light)
    shown = bake_texture(mapped, "lambert", size=512, light=light)
    buffer = GBuffer.of(bumpy, "front", size=(200, 200))
    smooth = buffer.sample(space.normals_at(3))
    smooth /= np.linalg.norm(smooth, axis=1, keepdims=True)
    wanted = color.encode(np.clip(smooth @ light, 0, 1), linear=True).astype(float)
    error = np.abs(looked_up(shown, buffer.triangle, buffer.barycentric) - wanted).max(axis=1)
    assert np.sqrt(np.mean(error**2)) < 2  # of eight bits in normals, and in what they show


def test_a_map_of_curvature_is_the_methods_own_and_of_a_sphere_even():
    ball = globe(16)
    found = bake_texture(ball, size=256, map="curvature")
    assert np.array_equal(found.image, bake_texture(ball, "mean_curvature", size=256).image)
    assert found.image.min() > 128
    assert np.ptp(found.image) < 12


def test_a_map_of_occlusion_is_the_share_of_light_as_it_is():
    found = bake_texture(globe(12), size=64, map="occlusion", rays=64)
    assert found.image.min() >= 250  # nothing is in the way of a sphere
    assert found.look.options["darkest"] == 0


def test_maps_refuse_what_is_about_colours():
    ball = globe(4)
    with pytest.raises(MeshdepictError, match="map='bump' is none of color, normal"):
        bake_texture(ball, size=64, map="bump")
    with pytest.raises(
        MeshdepictError, match="a map of normal is shaded by no method of one's choice: leave phong"
    ):
        bake_texture(ball, "phong", size=64, map="normal")
    with pytest.raises(MeshdepictError, match="colormap is about colours"):
        bake_texture(ball, size=64, map="curvature", colormap="viridis")


# --- what is wrong -------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [0, 15, 16_385, 64.5, "large", True, float("nan")])
def test_sizes_that_are_none_are_refused(size):
    with pytest.raises(MeshdepictError, match=r"size=.* is not a whole number from 16 to 16384"):
        bake_texture(globe(4), size=size)


def test_more_than_memory_holds_is_refused(monkeypatch):
    from meshdepict.files import limits

    monkeypatch.setattr(limits, "_chosen", 100 << 20)
    with pytest.raises(MeshdepictError, match=r"takes .* more than the 100 MB .* smaller --size"):
        bake_texture(globe(4), size=4096)


def test_refining_a_ground_and_a_cage_without_detail_are_refused():
    with pytest.raises(MeshdepictError, match="refine splits triangles"):
        bake_texture(globe(4), size=64, refine=2)
    with pytest.raises(MeshdepictError, match="ground is in pictures of a bake"):
        bake_texture(globe(4), size=64, ground="matt")
    with pytest.raises(MeshdepictError, match="cage says how far away detail may be"):
        bake_texture(globe(4), size=64, cage="1%")


def test_polygons_get_new_places_as_triangles():
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    quad = Mesh(corners, [[0, 1, 2, 3]])
    baked = bake_texture(quad, "lambert", size=32, light=(0, 0, 1))
    assert baked.texcoords.shape == (2, 3, 2)
    assert baked.mesh.polygons is None
    assert (baked.image == 255).all()


def test_progress_comes_to_its_end():
    calls = []
    bake_texture(globe(6), size=600, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1][0] == calls[-1][1] > 1


def test_a_bake_says_what_it_is():
    baked = bake_texture(globe(4), "lambert", size=64)
    assert repr(baked) == "<BakedTexture: lambert, 64 x 64 texels>"
    assert baked.provenance["texture"] == "color, 64 x 64 texels, atlas own"
    assert dataclasses.is_dataclass(baked.mesh.textures)
    assert np.array_equal(baked.mesh.texcoords, baked.texcoords)
    assert np.array_equal(baked.mesh.textures.base_colors[0].pixels[..., :3], baked.image)
    assert "meshdepict texture: color, 64 x 64 texels, atlas own" in baked.comments


@pytest.mark.parametrize("image", ["png", "jpeg", "webp"])
@pytest.mark.parametrize("suffix", [".glb", ".gltf", ".obj", ".ply"])
def test_a_texture_is_packed_as_asked_and_read_back(tmp_path, image, suffix):
    baked = md.bake_texture(md.samples.sphere(200), "lambert", size=128)
    path = baked.save(tmp_path / f"a{suffix}", image=image)
    texture = md.read_mesh(path).textures.base_colors[0]
    assert texture.kind == image
    apart = np.abs(texture.pixels[..., :3].astype(int) - baked.image)
    assert apart.max() == 0 if image == "png" else apart.mean() < 8  # of tiny, coloured places


@pytest.mark.parametrize(("suffix", "kind"), [(".jpg", "jpeg"), (".webp", "webp"), (".png", "png")])
def test_a_texture_alone_is_what_its_suffix_says(tmp_path, suffix, kind):
    baked = md.bake_texture(md.samples.sphere(200), "lambert", size=128)
    assert kind_of(baked.save(tmp_path / f"a{suffix}").read_bytes()) == kind


def test_less_quality_is_a_smaller_file(tmp_path):
    baked = md.bake_texture(md.samples.sphere(200), "lambert", size=128)
    sizes = [baked.save(tmp_path / "a.jpg", quality=quality).stat().st_size for quality in (95, 50)]
    assert sizes[1] < 0.8 * sizes[0]


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("a.glb", {"image": "gif"}, "image='gif' is none of png, jpeg, webp"),
        ("a.glb", {"quality": 80}, "quality=80 is of jpeg and webp: png is exact"),
        ("a.png", {"quality": 80}, "quality=80 is of jpeg and webp: png is exact"),
        ("a.jpg", {"quality": 101}, "quality=101 is no whole number from 1 to 100"),
        ("a.glb", {"image": "webp", "quality": 0}, "quality=0 is no whole number from 1 to 100"),
    ],
)
def test_wrong_packing_is_one_sentence_and_no_file(tmp_path, name, options, said):
    baked = md.bake_texture(md.samples.sphere(200), "lambert", size=128)
    with pytest.raises(MeshdepictError) as caught:
        baked.save(tmp_path / name, **options)
    assert str(caught.value) == said
    assert not list(tmp_path.iterdir())
