"""Small good volumes of every format and packing, by name; the suffix says who reads them."""

from __future__ import annotations

import bz2
import gzip
import struct
import zlib
from pathlib import Path

import numpy as np
from dicom_files import DEFLATED, RLE, run_lengths, write_dicom, write_enhanced
from volume_files import tiff, write_metaimage, write_nrrd

import meshdepict as md
from meshdepict.io.volumes import write_volume

VALUES = (np.arange(5 * 6 * 7).reshape(5, 6, 7) ** 2 % 997).astype(np.int16)


def volume_seeds(folder: Path) -> dict[str, bytes]:
    """Return files by name."""
    return (
        _itk(folder) | _headers(folder) | _dicom(folder) | _stacks(folder) | _vtk(folder)
    )  # fmt: skip


def _itk(folder: Path) -> dict[str, bytes]:
    import SimpleITK as sitk

    found = {}
    image = sitk.GetImageFromArray(VALUES)
    for suffix in (".nrrd", ".mha", ".nii", ".nii.gz"):
        path = folder / f"ct{suffix}"
        sitk.WriteImage(image, str(path))
        found[path.name] = path.read_bytes()
    np.save(folder / "ct.npy", VALUES)
    return found | {"ct.npy": (folder / "ct.npy").read_bytes()}


def _headers(folder: Path) -> dict[str, bytes]:
    """Text, hexadecimal and packed voxels behind headers of text."""
    data = VALUES.astype("<i2").tobytes()
    words = " ".join(map(str, VALUES.ravel())).encode()
    found = {}
    for encoding, body in (
        ("ascii", words), ("hex", data.hex().encode()), ("gzip", gzip.compress(data, mtime=0)),
        ("bzip2", bz2.compress(data)),
    ):  # fmt: skip
        path = write_nrrd(folder / "a.nrrd", body, sizes="7 6 5", encoding=encoding)
        found[f"{encoding}.nrrd"] = path.read_bytes()
    lines = {"DimSize": "7 6 5"}
    packed = write_metaimage(
        folder / "a.mha", zlib.compress(data), CompressedData="True", **lines
    )  # fmt: skip
    found["packed.mha"] = packed.read_bytes()
    text = write_metaimage(folder / "a.mha", words, BinaryData="False", **lines)
    return found | {"ascii.mha": text.read_bytes()}


def _dicom(folder: Path) -> dict[str, bytes]:
    """Files of several frames: plain, enhanced, and packed in ways that GDCM unpacks."""
    import SimpleITK as sitk

    frames = VALUES.astype(np.uint16)
    places = [(0, 0, 2 * z) for z in range(len(frames))]
    packed = {"syntax": RLE, "pixels": run_lengths(frames)}
    path = folder / "a.dcm"
    found = {
        "one.dcm": write_dicom(path, frames).read_bytes(),
        "deflated.dcm": write_dicom(path, frames, syntax=DEFLATED).read_bytes(),
        "rle.dcm": write_dicom(path, frames, **packed).read_bytes(),
        "enhanced.dcm": write_enhanced(path, frames, places).read_bytes(),
        "open.dcm": write_enhanced(path, frames, places, open_end=True, **packed).read_bytes(),
    }
    # Of smaller pictures GDCM makes no JPEG 2000 without damage to its memory.
    image = sitk.GetImageFromArray(np.tile(frames[:3], (1, 6, 5)))
    for compressor in ("JPEG", "JPEG2000"):
        writer = sitk.ImageFileWriter()
        writer.SetImageIO("GDCMImageIO")
        writer.UseCompressionOn()
        writer.SetCompressor(compressor)
        writer.SetFileName(str(path))
        writer.Execute(image)
        found[f"{compressor.lower()}.dcm"] = path.read_bytes()
    return found


def _stacks(folder: Path) -> dict[str, bytes]:
    """TIFF stacks: plain, of ImageJ, OME's words, and packed."""
    from PIL import Image

    said = b"ImageJ=1.54f\nimages=5\nslices=5\nunit=micron\nspacing=2.0\n"
    scale = {"t282": (5, [4, 1]), "t283": (5, [4, 1])}
    words = (
        b'<OME><Image><Pixels SizeX="7" SizeY="6" SizeZ="5" PhysicalSizeX="0.5" '
        b'PhysicalSizeY="0.5" PhysicalSizeZ="2"/></Image></OME>'
    )
    found = {
        "pages.tif": tiff(VALUES),
        "big.tif": tiff(VALUES.astype(np.float32), order=">"),
        "imagej.tif": tiff(VALUES.astype(np.uint16), first={270: (2, said)}, **scale),
        "ome.tif": tiff(VALUES.astype(np.uint8), first={270: (2, words)}),
        "virtual.tif": _virtual(said),
    }
    pages = [Image.fromarray(plane.astype(np.uint16)) for plane in VALUES]
    for packing in ("tiff_deflate", "tiff_lzw"):
        path = folder / "a.tif"
        pages[0].save(path, save_all=True, append_images=pages[1:], compression=packing)
        found[f"{packing[5:]}.tif"] = path.read_bytes()
    return found


def _virtual(said: bytes) -> bytes:
    """ImageJ's way round TIFF's 4 GB: one page, and the others' pixels right behind its own."""
    whole = VALUES.astype(np.uint16).reshape(-1, VALUES.shape[-1])
    data = bytearray(tiff(whole[None], first={270: (2, said)}))
    at = data.find(struct.pack("<HH", 257, 4))
    data[at + 8 : at + 12] = struct.pack("<I", VALUES.shape[1])
    return bytes(data)


def _vtk(folder: Path) -> dict[str, bytes]:
    """VTK's XML in every way to write its arrays."""
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    volume = md.Volume(VALUES, spacing=(1, 1.5, 2), hounsfield=True)
    image = volume.to_pyvista()
    found = {}
    path = folder / "a.vti"
    for mode in ("Ascii", "Binary", "Appended"):
        for compressor in ("None", "ZLib", "LZ4", "LZMA"):
            if mode == "Ascii" and compressor != "None":
                continue
            for coded in (True, False) if mode == "Appended" else (True,):
                writer = vtkXMLImageDataWriter()
                writer.SetInputData(image)
                writer.SetFileName(str(path))
                getattr(writer, f"SetDataModeTo{mode}")()
                getattr(writer, f"SetCompressorTypeTo{compressor}")()
                writer.SetEncodeAppendedData(coded)
                writer.SetBlockSize(256)
                writer.Write()
                name = f"{mode}-{compressor}{'' if coded else '-raw'}.vti".lower()
                found[name] = path.read_bytes()
    rgba = np.zeros((*VALUES.shape, 4), np.uint8)
    rgba[..., 1] = VALUES % 256
    write_volume(folder / "shaded.vti", rgba, volume)
    return found | {"shaded.vti": (folder / "shaded.vti").read_bytes()}
