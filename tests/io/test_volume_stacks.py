"""TIFF stacks, and folders of images as slices: what ImageJ and OME say, and what doesn't fit."""

import struct

import numpy as np
import pytest
from marked_volumes import marked
from volume_files import tiff

from meshdepict.errors import MeshdepictError, MeshdepictWarning
from meshdepict.io.volumes import is_volume_path, read_volume


def imagej(lines: str) -> dict:
    words = f"ImageJ=1.54f\n{lines}".encode("latin-1")
    return {270: (2, words), 282: (5, [4, 1]), 283: (5, [2, 1])}


@pytest.mark.parametrize("order", "<>")
def test_imagej_says_spacing_and_unit(tmp_path, order):
    first = imagej("images=7\nslices=7\nunit=micron\nspacing=1.5\nloop=false\n")
    (tmp_path / "a.tif").write_bytes(tiff(marked(), order=order, first=first))
    volume = read_volume(tmp_path / "a.tif")
    np.testing.assert_array_equal(volume.values, marked())
    np.testing.assert_allclose(volume.spacing, (0.25, 0.5, 1.5))
    assert volume.length_unit == "µm"
    other = read_volume(tmp_path / "a.tif", spacing=(1, 2, 3))
    np.testing.assert_array_equal(other.spacing, (1, 2, 3))
    assert other.length_unit == ""


@pytest.mark.parametrize("unit", ["pixel", "\\u00B5m", ""])
def test_imagej_units_are_believed_where_they_are_lengths(tmp_path, unit):
    first = imagej(f"images=7\nunit={unit}\nspacing=1.5\n")
    (tmp_path / "a.tif").write_bytes(tiff(marked(), first=first))
    if "u00B5" in unit:
        assert read_volume(tmp_path / "a.tif").length_unit == "µm"
        return
    with pytest.warns(MeshdepictWarning, match="no spacing is given"):
        assert read_volume(tmp_path / "a.tif").length_unit == ""


def test_imagejs_large_stacks_have_a_single_page(tmp_path):
    first = imagej("images=7\nslices=7\nunit=mm\nspacing=2\n")
    values = marked("u2")
    one = tiff(values[:1], first=first)
    # The other slices follow the first one, whose page's directory is behind them all.
    start = 8 + values[0].nbytes
    shift = values[1:].nbytes
    data = bytearray(one[:start] + values[1:].tobytes() + one[start:])
    (at,) = struct.unpack_from("<I", one, 4)
    struct.pack_into("<I", data, 4, at + shift)
    (count,) = struct.unpack_from("<H", one, at)
    for entry in range(count):
        place = at + 2 + 12 * entry
        _, kind, number = struct.unpack_from("<HHI", one, place)
        size = {2: 1, 3: 2, 4: 4, 5: 8}[kind] * number
        if size > 4:
            (where,) = struct.unpack_from("<I", one, place + 8)
            struct.pack_into("<I", data, place + shift + 8, where + shift)
    (tmp_path / "a.tif").write_bytes(data)
    np.testing.assert_array_equal(read_volume(tmp_path / "a.tif").values, values)
    (tmp_path / "a.tif").write_bytes(one)
    with pytest.raises(MeshdepictError, match=r"is cut off|damaged or cut off"):
        read_volume(tmp_path / "a.tif")


@pytest.mark.parametrize("stated", ['PhysicalSizeZUnit="mm"', ""])
def test_ome_says_spacing_and_unit(tmp_path, stated):
    words = (
        '<?xml version="1.0"?><OME><Image ID="Image:0"><Pixels SizeX="5" SizeC="1" SizeT="1" '
        f'PhysicalSizeX="0.5" PhysicalSizeY="0.75" PhysicalSizeZ="0.002" {stated}></Pixels></Image>'
        "</OME>"
    )
    (tmp_path / "a.tif").write_bytes(tiff(marked(), first={270: (2, words.encode())}))
    volume = read_volume(tmp_path / "a.tif")
    np.testing.assert_allclose(volume.spacing, (0.5, 0.75, 2 if stated else 0.002))
    assert volume.length_unit == "µm"


@pytest.mark.parametrize(
    ("first", "entries", "sentence"),
    [
        (imagej("images=14\nchannels=2\n"), {}, "holds several channels: save one of them"),
        (imagej("images=14\nframes=2\n"), {}, "holds several frames: save one of them"),
        ({270: (2, b'<OME><Pixels SizeC="3" SizeT="1"/></OME>')}, {}, "several channels"),
        ({}, {"t277": (3, [3])}, "has 3 values in a voxel"),
        ({}, {"t262": (3, [2])}, "has 3 values in a voxel"),
        ({}, {"t262": (3, [0])}, r"counts white as zero: a\.tif; save it with black as zero"),
        ({}, {"t258": (3, [12])}, r"has 12 bits in a pixel: a\.tif; save it with 8, 16 or 32"),
        ({}, {"t339": (3, [6])}, "bits in a pixel"),
        ({256: (4, [4])}, {}, r"pages of different size or type: page 1 \(4 x 6 .* page 2 \(5 x"),
        ({}, {"t256": (4, [50_000]), "t257": (4, [50_000])}, "claim more pixels than the file"),
        ({}, {"t279": (4, [9])}, "is cut off or damaged: a.tif, page 1"),
        ({}, {"t259": (3, [5]), "t262": (3, [3])}, "numbers of colours, compressed"),
        ({}, {"t259": (3, [5]), "t256": (4, [90_000]), "t257": (4, [90_000])}, "claims more pixel"),
    ],
)
def test_tiffs_of_other_kinds_say_what_they_are(tmp_path, first, entries, sentence, capfd):
    (tmp_path / "a.tif").write_bytes(tiff(marked("u2"), first=first, **entries))
    with pytest.raises(MeshdepictError, match=sentence):
        read_volume(tmp_path / "a.tif", spacing=(1, 1, 1))
    assert capfd.readouterr() == ("", "")


def test_compressed_tiffs_that_are_damaged_are_refused_without_noise(tmp_path, capfd):
    sitk = pytest.importorskip("SimpleITK")
    values = np.random.default_rng(4).integers(0, 9, (3, 30, 40)).astype(np.uint16)
    sitk.WriteImage(sitk.GetImageFromArray(values), str(tmp_path / "a.tif"), useCompression=True)
    good = (tmp_path / "a.tif").read_bytes()
    np.testing.assert_array_equal(read_volume(tmp_path / "a.tif", spacing=(1, 1, 1)).values, values)
    spoiled = bytearray(good)
    spoiled[12:200] = bytes(range(188))
    (tmp_path / "a.tif").write_bytes(spoiled)
    with pytest.raises((MeshdepictError, MeshdepictWarning), match=r"damage"):
        read_volume(tmp_path / "a.tif", spacing=(1, 1, 1))
    assert capfd.readouterr() == ("", "")


def test_pages_that_go_round_in_circles_are_refused(tmp_path):
    data = bytearray(tiff(marked("u2")[:2]))
    (at,) = struct.unpack_from("<I", data, 4)
    (count,) = struct.unpack_from("<H", data, at)
    struct.pack_into("<I", data, at + 2 + 12 * count, at)
    (tmp_path / "a.tif").write_bytes(data)
    with pytest.raises(MeshdepictError, match="its pages go round in circles"):
        read_volume(tmp_path / "a.tif", spacing=(1, 1, 1))


# --- images as slices -----------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".bmp", ".png", ".tif"])
@pytest.mark.parametrize("kind", ["u1", "u2"])
def test_images_are_slices_in_the_order_of_their_numbers(tmp_path, suffix, kind):
    from PIL import Image

    if (suffix, kind) == (".bmp", "u2"):
        pytest.skip("BMP has no 16 bits")
    values = (marked() % 251).astype(kind) * (1 if kind == "u1" else 257)
    for z, page in enumerate(values):
        Image.fromarray(page).save(tmp_path / f"rec_{z + 5}{suffix}")
    assert is_volume_path(tmp_path)
    volume = read_volume(tmp_path, spacing=(1, 1, 2))
    np.testing.assert_array_equal(volume.values, values)
    assert volume.length_unit == ""


def test_previews_and_copies_among_images_are_left_out(tmp_path):
    from PIL import Image

    values = (marked() % 251).astype("u1")
    for z, page in enumerate(values):
        Image.fromarray(page).save(tmp_path / f"rec_{z:04}.bmp")
    Image.fromarray(values[0, 1:]).save(tmp_path / "rec_spr.bmp")
    with pytest.warns(MeshdepictWarning, match=r"are left out: 1, the first rec_spr\.bmp"):
        np.testing.assert_array_equal(read_volume(tmp_path, spacing=(1, 1, 1)).values, values)
    (tmp_path / "rec_spr.bmp").unlink()
    (tmp_path / "rec_0003.bmp").unlink()
    with pytest.warns(MeshdepictWarning, match=r"missing between rec_0002\.bmp and rec_0004\.bmp"):
        assert len(read_volume(tmp_path, spacing=(1, 1, 1)).values) == 6


def test_colours_damage_and_single_images_are_refused(tmp_path):
    from PIL import Image

    gray = (marked() % 251).astype("u1")
    for z, page in enumerate(gray):
        Image.fromarray(np.repeat(page[..., None], 3, axis=-1)).save(tmp_path / f"{z}.png")
    np.testing.assert_array_equal(read_volume(tmp_path, spacing=(1, 1, 1)).values, gray)
    with pytest.raises(MeshdepictError, match=r"0\.png is a single image: give the folder of all"):
        read_volume(tmp_path / "0.png")
    colors = np.repeat(gray[4][..., None], 3, axis=-1)
    colors[0, 0] = (9, 0, 0)
    Image.fromarray(colors).save(tmp_path / "4.png")
    with pytest.raises(MeshdepictError, match=r"holds colours, not grey slices: 4\.png; save it"):
        read_volume(tmp_path, spacing=(1, 1, 1))
    (tmp_path / "4.png").write_bytes((tmp_path / "3.png").read_bytes()[:40])
    with pytest.raises(MeshdepictError, match=r"holds a damaged image, 4\.png"):
        read_volume(tmp_path, spacing=(1, 1, 1))
    Image.fromarray(gray[4, 1:]).save(tmp_path / "4.png")
    with pytest.raises(MeshdepictError, match=r"0\.png \(5 x 6 uint8\) and 4\.png \(5 x 5 uint8\)"):
        read_volume(tmp_path, spacing=(1, 1, 1))


def test_images_of_too_many_pixels_are_refused(tmp_path, monkeypatch):
    from PIL import Image

    for z in range(2):
        Image.fromarray(np.eye(20, dtype=np.uint8)).save(tmp_path / f"{z}.png")
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 150)
    with pytest.raises(MeshdepictError, match=r"an image of too many pixels, 0\.png: save the"):
        read_volume(tmp_path, spacing=(1, 1, 1))
