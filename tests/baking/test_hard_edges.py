"""Creases in bakes: planes of one tone with every method, and a note where that would help."""

import numpy as np
import pytest
from method_families import ON_MESHES, needing
from parts import angle_profile, bevelled_box, box, cylinder

import meshdepict as md
from meshdepict.baking.smearing import smeared_share
from meshdepict.congruence.comparison import compare
from meshdepict.errors import MeshdepictWarning
from meshdepict.shapes.gbuffer import GBuffer
from meshdepict.shapes.parted import PartedMesh, parted_at_creases
from meshdepict.viewer.session import Session

SAMPLED = ("sky_view", "positive_openness")  # each sample has its own rays
# What these see depends on how far the edge is, at whichever side of it a sample lies.
ACROSS = ("integral_invariant", "negative_openness")
LIGHT = (0.3, 0.5, 0.81)

pytestmark = pytest.mark.filterwarnings("ignore:.*vertices were added")


def spread_within_planes(baked):
    """The largest difference of tone, in grey levels, between corners of one plane."""
    mesh = baked.shape
    a, b, c = mesh.vertices[mesh.outward_faces].swapaxes(0, 1)
    cross = np.cross(b - a, c - a)
    normal = np.round(cross / np.linalg.norm(cross, axis=1, keepdims=True), 6)
    offset = np.round((normal * a).sum(axis=1), 6)
    plane = np.unique(np.c_[normal, offset], axis=0, return_inverse=True)[1].ravel()
    tone = baked.colors[mesh.faces].astype(float)
    return max(np.ptp(tone[plane == each], axis=(0, 1)).max() for each in np.unique(plane))


@pytest.mark.parametrize("name", [n for n in ON_MESHES if n not in ACROSS])
@pytest.mark.parametrize("make", [box, bevelled_box])
def test_planes_have_one_tone_with_every_method(name, make):
    baked = md.bake(make(), name, light=LIGHT, creases=40)
    # A convex body: nothing is in anything's way.
    assert spread_within_planes(baked) <= (3 if name in SAMPLED else 1)


@pytest.mark.parametrize(
    "name", [n for n in ON_MESHES if n not in ("accessibility", *ACROSS, *needing("rays"))]
)
def test_so_have_those_of_a_profile_where_no_rays_are_cast(name):
    smeared, sharp = (
        md.bake(angle_profile(), name, light=LIGHT, creases=creases) for creases in (None, 40)
    )
    assert spread_within_planes(sharp) <= 1
    if name in ("lambert", "exaggerated", "light_alignment", "light_warping"):
        assert spread_within_planes(smeared) > 10


def test_a_cylinders_side_is_shaded_smoothly():
    baked = md.bake(cylinder(), "lambert", light=(1, 0, 0), creases=40)
    mesh = baked.shape
    side = np.abs(mesh.normals[:, 2]) < 0.5
    angle = np.arctan2(mesh.vertices[side, 1], mesh.vertices[side, 0])
    np.testing.assert_allclose(
        baked.intensity[side], np.maximum(np.cos(angle), 0), atol=np.sin(np.pi / 48)
    )
    np.testing.assert_allclose(baked.intensity[~side], 0, atol=1e-6)


def test_what_was_taken_is_written():
    with pytest.warns(MeshdepictWarning, match="16 vertices were added for those at edges sharper"):
        baked = md.bake(box(), "lambert", creases=40)
    assert baked.provenance["creases"] == "40 degrees, 16 vertices added"
    assert baked.look.creases == 40
    again = md.bake(baked.space, "lambert", creases=40)  # known already
    np.testing.assert_array_equal(again.colors, baked.colors)
    assert again.look.creases == 40
    np.testing.assert_array_equal(baked.look.bake(baked.shape).colors, baked.colors)
    other = md.bake(baked.shape, "lambert", creases=100)
    assert (len(other.shape.vertices), other.provenance["creases"]) == (
        8, "100 degrees, 0 vertices added",
    )  # fmt: skip


def test_a_recipe_holds_it(tmp_path):
    look = md.Look("lambert", creases=35)
    look.save(tmp_path / "look.toml")
    assert md.Look.load(tmp_path / "look.toml").creases == 35
    assert md.Look("lambert").creases is None


@pytest.mark.parametrize(
    ("chosen", "sentence"),
    [
        ({"creases": 0}, "creases=0 is not an angle in degrees"),
        ({"creases": "wide"}, "creases='wide' is not an angle"),
        ({"normals": "mine"}, "normals='mine' is neither 'computed' nor 'file'"),
        ({"normals": ["file"]}, "is neither 'computed' nor 'file'"),
        ({"creases": 40, "normals": "file"}, "say themselves which edges are sharp"),
    ],
)
def test_what_no_look_takes(chosen, sentence):
    with pytest.raises(md.MeshdepictError, match=sentence):
        md.Look("lambert", **chosen)


def test_what_is_sampled_already_is_not_parted():
    space = md.scale_space(box(), scales=0)
    buffer = GBuffer.of(box(), "isometric", size=(30, 30))
    for shape in (space, buffer):
        with pytest.raises(md.MeshdepictError, match="creases=40 is about a mesh that is yet to"):
            md.bake(shape, "lambert", creases=40)
    with pytest.raises(md.MeshdepictError, match="creases is about a mesh, and this is a volume"):
        md.bake_volume(md.samples.ct_phantom((16, 16, 16)), "lambert", creases=40)


def test_a_session_shows_it_and_so_does_its_page():
    session = Session(angle_profile(), "lambert", light=LIGHT, creases=40)
    assert isinstance(session.shape, PartedMesh)
    session.use("exaggerated")
    baked = session.baked()
    assert spread_within_planes(baked) <= 1
    assert session.look_now().creases == 40
    assert baked.provenance["creases"].startswith("40 degrees")
    np.testing.assert_array_equal(session.look_now().bake(session.shape).colors, baked.colors)


def test_a_picture_of_pixels_has_planes_of_one_tone():
    mesh = parted_at_creases(box(), 40)
    buffer = GBuffer.of(mesh, "isometric", size=(60, 60))
    tone = md.bake(buffer, "lambert", light=LIGHT).colors[:, 0]
    assert len(np.unique(tone)) == 3


def test_refined_edges_are_split_alike_on_both_sides():
    baked = md.bake(cylinder(12), "lambert", light=LIGHT, creases=40, refine=2)
    mesh = baked.shape
    assert len(mesh.vertices) > 48
    top = mesh.vertices[:, 2] == 1
    cap = np.isin(np.arange(len(top)), mesh.faces[(mesh.vertices[mesh.faces][..., 2] == 1).all(1)])
    places = [np.unique(mesh.vertices[top & which], axis=0) for which in (cap, ~cap)]
    np.testing.assert_array_equal(*places)  # no gaps
    assert spread_within_planes(md.bake(box(), "lambert", light=LIGHT, creases=40, refine=2)) <= 1


def test_compare_takes_it():
    plain, sharp = (
        compare(angle_profile(), ["lambert"], lights=["north"], view="isometric", size=(64, 64),
                scales=1, creases=creases)
        for creases in (None, 40)
    )  # fmt: skip
    assert sharp.settings["creases"] == 40
    assert "creases" not in plain.settings
    tones = [
        len(np.unique(found.pictures[0, 0].reshape(-1, 3), axis=0)) for found in (plain, sharp)
    ]
    assert tones[1] < 12 < tones[0]


def test_how_much_is_smeared():
    light = md.Light(LIGHT)
    assert smeared_share(angle_profile(), light) > 0.5
    assert smeared_share(cylinder(), light) > 0.1
    assert smeared_share(parted_at_creases(angle_profile(), 40), light) == 0
    assert smeared_share(md.samples.sphere(2000), light) == 0
    assert smeared_share(md.samples.golf_ball(2000), light) < 0.1


def test_on_the_command_line(run, folder):
    md.io.write_mesh("profile.ply", angle_profile())
    _, _, (note,) = run("bake", "profile.ply", "-m", "lambert")
    assert "sharp edges smear over" in note
    assert "--creases 40 keeps planes of one tone" in note
    status, _, (note,) = run(
        "bake", "profile.ply", "-m", "lambert", "--creases", "40", "-o", "s.ply"
    )
    assert status == 0
    assert "24 vertices were added for those at edges sharper than 40°" in note
    assert "smear" not in note
    baked = md.read_mesh("s.ply")
    assert len(baked.vertices) == 36
    assert "meshdepict creases: 40 degrees, 24 vertices added" in md.io.read_provenance("s.ply")
    status, _, (fault,) = run(
        "bake", "profile.ply", "-m", "lambert", "--normals", "file", "--force"
    )
    assert (status, "needs normals in the file" in fault) == (2, True)
    ball = md.samples.sphere(300)
    names = dict(zip(("nx", "ny", "nz"), ball.vertices.T, strict=True))
    mesh = md.Mesh(ball.vertices, ball.faces, attributes={"vertex": names})
    md.io.write_mesh("ball.ply", mesh)
    status, _, err = run("bake", "ball.ply", "-m", "lambert", "--normals", "file", "--quiet")
    assert (status, err) == (0, [])
    lines = md.io.read_provenance("ball-lambert.ply")
    assert "meshdepict normals: the file's, 0 vertices added" in lines


@pytest.mark.parametrize("name", ["lambert", "radiance_scaling", "light_alignment", "exaggerated"])
def test_fandisk_and_gears(data, name):
    for file in ("fandisk_13k", "gears_19k"):
        mesh = md.read_mesh(data / "mesh" / f"{file}.ply")
        corners = mesh.vertices[mesh.outward_faces]
        level = corners[..., 2] == corners[..., 2].max()
        up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0
        flat = level.all(axis=1) & up  # of the gears six specks of a needle's width are folded over
        assert flat.sum() > 50
        spreads = []
        for creases in (None, 40):
            baked = md.bake(mesh, name, creases=creases)
            spreads.append(np.ptp(baked.colors[baked.shape.faces[flat]].astype(int)))
        assert spreads[0] > 100
        assert spreads[1] <= 2
