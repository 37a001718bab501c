"""``meshdepict volume``: what it writes, what it says, and what it refuses before reading."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import bake_volume
from meshdepict.drawing.slices import draw_slice
from meshdepict.errors import MeshdepictError
from meshdepict.io.volumes import read_volume, write_volume


@pytest.fixture
def head(folder):
    volume = md.samples.ct_phantom((40, 40, 40))
    write_volume("head.nrrd", volume.values, volume)
    return ["volume", "head.nrrd", "--scales", "2", "--size", "60x60", "--quiet"]


def test_voxels_and_pictures_are_written(run, head):
    words = ["-o", "out.vti", "--picture", "a.png", "--before", "b.png", "--slice", "z=50%"]
    status, (line,), err = run(*head, *words)
    assert (status, err) == (0, [])
    assert line.startswith("out.vti, a.png, b.png, a-z50.png: exaggerated, light northwest, ")
    assert "voxels shaded" in line
    import pyvista as pv

    rgba = pv.read("out.vti").point_data["RGBA"].reshape(40, 40, 40, 4)
    volume = read_volume("head.nrrd")
    expected = bake_volume(volume, transfer="bone", scales=2).rgba
    np.testing.assert_array_equal(rgba, expected)
    after, before = (np.asarray(Image.open(name).convert("RGB")) for name in ("a.png", "b.png"))
    assert after.shape == (60, 60, 3)
    assert (after < 250).any()
    assert (after != before).any()


@pytest.mark.parametrize("suffix", [".vti", ".nrrd", ".mha"])
def test_voxels_carry_their_provenance_and_may_be_replaced(run, head, suffix):
    words = [*head, "-m", "lambert", "-o", f"out{suffix}"]
    assert run(*words)[0] == 0
    first = Path(f"out{suffix}").read_bytes()
    assert run(*words)[0] == 0
    assert Path(f"out{suffix}").read_bytes() == first
    if suffix == ".vti":
        import pyvista as pv

        lines = list(pv.read("out.vti").field_data["meshdepict"])
    else:
        import SimpleITK

        lines = SimpleITK.ReadImage(f"out{suffix}").GetMetaData("meshdepict_provenance").split("; ")
    assert "meshdepict method: lambert" in lines


def test_info_says_what_a_volume_is(run, head):
    status, out, _ = run("info", "head.nrrd")
    assert status == 0
    text = "\n".join(out)
    assert "40 x 40 x 40" in text
    assert "HU (int16)" in text


@pytest.mark.parametrize(("said", "shown"), [("um", "µm"), ("m", "m"), ("", "not said")])
def test_info_says_what_lengths_are_in(run, said, shown):
    line = f'space units: "{said}" "{said}" "{said}"\n' if said else ""
    head = "NRRD0004\ntype: uchar\ndimension: 3\nspace dimension: 3\nsizes: 2 2 2\nencoding: raw\n"
    places = "space directions: (10,0,0) (0,10,0) (0,0,20)\n"
    Path("small.nrrd").write_bytes((head + places + line + "\n").encode() + bytes(range(8)))
    status, out, _ = run("info", "small.nrrd")
    assert status == 0
    assert [line.split(maxsplit=2)[2] for line in out if "length unit" in line] == [shown]


def test_without_anything_asked_for_a_picture_is_drawn(run, head):
    status, (line,), _ = run(*head, "-m", "lambert")
    assert status == 0
    assert line.startswith("head-lambert.png: lambert")
    assert run(*head, "-m", "lambert")[0] == 0  # its own picture may be replaced


def test_a_surface_is_baked_as_a_mesh(run, head):
    status, (line,), _ = run(*head, "--surface", "200", "-o", "skull.ply")
    assert status == 0
    assert "triangles at 200" in line
    assert len(md.read("skull.ply").faces) > 1000
    assert md.read("skull.ply").attributes["vertex"]["red"].dtype == np.uint8


def test_a_clipped_volume_is_the_part_of_it(run, head):
    assert run(*head, "--clip", "x=50%:100%", "--clip", "z=0:0.5", "-o", "half.mha")[0] == 0
    half, whole = read_volume("head.nrrd").cropped(x=(0.5, 1), z=(0, 0.5)), read_volume("head.nrrd")
    assert half.values.shape == (21, 40, 20)
    np.testing.assert_allclose(half.to_world((0, 0, 0)), whole.to_world((20, 0, 0)))
    np.testing.assert_array_equal(half.values, whole.values[:21, :, 20:])
    import SimpleITK

    assert SimpleITK.ReadImage("half.mha").GetSize() == (20, 40, 21)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["-o", "out.ply"], "-o out.ply: end the name with .vti"),
        (["--surface", "200", "-o", "out.vti"], "-o out.vti: end the name with .ply"),
        (["--surface", "200", "--before", "b.png"], "leave one out"),
        (["--surface", "9000", "-o", "a.ply"], "a surface at 9000.0 can't be found"),
        (["--picture", "a.tif"], "end the name with .png"),
        (["--slice", "z"], "--slice wants AXIS=SHARE"),
        (["--slice", "z=2"], "is not a share of the axis"),
        (["--clip", "z=1"], "--clip wants AXIS=FROM:TO"),
        (["--clip", "z=60%:10%"], "are not two shares of an axis"),
        (["--transfer", "bones"], "did you mean 'bone'"),
        (["--spacing", "1,2"], "--spacing 1,2 is not 3 numbers"),
        (["--series", "2"], "head.nrrd is no DICOM"),
        (["-o", "mine.vti"], "mine.vti exists and was not written by meshdepict"),
        (["-m", "ambient_occlusion"], "rays need a surface to meet"),
    ],
)
def test_what_is_refused_gets_one_line_and_writes_nothing(run, head, words, sentence):
    Path("mine.vti").write_text("mine")
    status, out, err = run(*head, *words)
    assert (status, out, len(err)) == (2, [], 1)
    assert sentence in err[0]
    assert sorted(path.name for path in Path().iterdir()) == ["head.nrrd", "mine.vti"]


def test_the_built_in_phantom_is_shown(run, folder, monkeypatch):
    small = md.samples.ct_phantom((32, 32, 32))
    monkeypatch.setattr(md.samples, "ct_phantom", lambda size: small)
    status, (line,), _ = run("volume", "-m", "lambert", "--size", "40x40")
    assert status == 0
    assert line.startswith("ct-phantom-lambert.png")


# --- slices ---------------------------------------------------------------------------------------


def test_a_slice_shows_shaded_voxels_over_gray_numbers():
    baked = bake_volume(md.samples.ct_phantom((32, 32, 32)), "lambert", transfer="bone")
    for axis, along in zip("xyz", (2, 1, 0), strict=True):
        image = np.asarray(draw_slice(baked, axis, 0.5))
        rgba = np.take(baked.rgba, round(0.5 * (baked.rgba.shape[along] - 1)), axis=along)
        gray = (image[..., 0] == image[..., 1]) & (image[..., 1] == image[..., 2])
        assert gray.any()
        assert (~gray).any() == (rgba[..., 3] > 0).any()


@pytest.mark.parametrize(("axis", "share"), [("w", 0.5), ("x", 2), ("x", -0.1), ("x", True)])
def test_a_slice_elsewhere_is_refused(axis, share):
    baked = bake_volume(md.samples.ct_phantom((32, 32, 32)), "lambert")
    with pytest.raises(MeshdepictError, match="a slice"):
        draw_slice(baked, axis, share)


def test_a_crop_of_everything_is_the_volume_itself():
    volume = md.samples.ct_phantom((32, 32, 32))
    assert volume.cropped() is volume
    for span in ((0.5, 0.5), (-1, 1), (0, 2)):
        with pytest.raises(MeshdepictError, match="two shares of an axis"):
            volume.cropped(y=span)


def test_a_volume_is_no_mesh_to_bake(folder):
    volume = md.samples.ct_phantom((32, 32, 32))
    write_volume("head.nrrd", volume.values, volume)
    with pytest.raises(MeshdepictError, match=r"head.nrrd is a volume, not a mesh"):
        md.bake("head.nrrd")
    assert md.read("head.nrrd").values.shape == volume.values.shape


# --- units, tilts and memory ------------------------------------------------------------------


@pytest.fixture
def labels(monkeypatch):
    """What scale bars say."""
    from meshdepict.drawing import scale_bar

    told, choose = [], scale_bar.scale_bar

    def spy(*args, **kwargs):
        bar = choose(*args, **kwargs)
        told.append(bar.label)
        return bar

    monkeypatch.setattr(scale_bar, "scale_bar", spy)
    return told


@pytest.mark.parametrize(
    ("unit", "said", "shown"),
    [("µm", [], "µm"), ("", [], "units"), ("mm", [], "mm"), ("µm", ["--unit", "nm"], "nm")],
)
@pytest.mark.parametrize("surface", [[], ["--surface", "200"]])
def test_the_scale_bar_has_the_files_unit_or_none(run, labels, unit, said, shown, surface):
    head = md.samples.ct_phantom((24, 24, 24))
    volume = md.Volume(head.values, spacing=head.spacing, hounsfield=True, length_unit=unit)
    write_volume("head.nrrd", volume.values, volume)
    words = ["--scale-bar", "--size", "200x200", "--scales", "1", "--quiet", *said, *surface]
    assert run("volume", "head.nrrd", "--picture", "a.png", *words)[0] == 0
    assert [label.split(" ")[1] for label in labels] == [shown]


def test_a_tilted_gantry_is_resampled_or_refused(run):
    from dicom_files import write_dicom

    head = md.samples.ct_phantom((24, 24, 24)).values
    Path("ct").mkdir()
    for z, plane in enumerate(head):
        write_dicom(Path("ct", f"{z}.dcm"), plane, position=(0, 0.3 * z, z), intercept=0)
    words = ["volume", "ct", "--scales", "1", "--size", "60x60"]
    status, _, (note, *_) = run(*words)
    assert status == 0
    assert "tilted by 16.7°, its slices are resampled to a straight grid" in note
    status, out, (sentence,) = run(*words, "--tilt", "refuse")
    assert (status, out) == (2, [])
    assert "the gantry was tilted by 16.7°; resample it first" in sentence
    assert run(*words, "--tilt", "keep")[0] == 2


def test_memory_for_a_files_contents_is_raised_by_hand(run):
    values = np.zeros((40, 40, 40), np.int16)
    values[10:20, 10:20, 10:20] = 800
    volume = md.Volume(values, hounsfield=True)
    write_volume("a.nii.gz", values, volume)
    words = ["volume", "a.nii.gz", "--scales", "1", "--size", "60x60", "--quiet", "--slope", "1"]
    status, out, (sentence,) = run(*words, "--max-memory", "1kB")
    assert (status, out) == (2, [])
    assert "claims more voxels than the 1 kB of memory hold" in sentence
    assert run(*words, "--max-memory", "1MB")[0] == 0
    status, _, (sentence,) = run(*words, "--max-memory", "much")
    assert status == 2
    assert "max-memory 'much' is no amount of memory such as 4GB" in sentence
