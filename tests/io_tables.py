"""What every format keeps of a shape, found by writing one and reading it back.

``PYTHONPATH=tests python tests/io_tables.py`` prints the tables of docs/formats.md.
"""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path

import numpy as np
from terrain_tables import height_table, relief_table

import meshdepict as md
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.io.source import FORMATS, WRITABLE
from meshdepict.io.volumes import WRITABLE_VOLUMES, write_volume

LINE = "meshdepict method: lambert"
YES, NO = "kept", "–"
_MARKS = (b"lambert", b'Name="meshdepict"')  # in plain, or packed by VTK


def mesh_table(folder: Path) -> list[str]:
    """Return the table of mesh formats as lines of Markdown."""
    heading = (
        "| format | written | polygons | coordinates | own colours beside the bake's | "
        "other vertex data | face data | provenance | length unit |"
    )
    lines = [heading, "| --- " * 9 + "|"]
    points = md.samples.golf_ball(60, dimples=12).vertices[:12] / 3
    colors = {name: np.arange(12, dtype=np.uint8) + i for i, name in enumerate(("red", "green"))}
    mesh = md.Mesh(
        points, [[0, 1, 2, 3], [4, 5, 6], [7, 8, 9, 10, 11]],
        attributes={
            "vertex": {**colors, "blue": colors["red"], "quality": np.linspace(0, 1, 12)},
            "face": {"heat": np.arange(3.0)},
        },
        winding="keep",
    )  # fmt: skip
    baked = np.full((12, 3), 100, np.uint8)
    for suffix in FORMATS:
        if suffix not in WRITABLE:
            lines.append(f"| {suffix} | {NO} | triangles | as in the file " + f"| {NO} " * 5 + "|")
            continue
        path = folder / f"probe{suffix}"
        write_mesh(path, mesh, colors=baked, comments=(LINE,))
        back = read_mesh(path, winding="keep")
        same = len(back.vertices) == 12
        exact = same and np.array_equal(back.vertices, mesh.vertices)
        vertex, face = back.attributes["vertex"], back.attributes["face"]
        lines.append(
            f"| {suffix} | with colours "
            f"| {YES if back.polygons is not None else 'triangles'} "
            f"| {'double precision' if exact else 'single precision'} "
            f"| {YES if 'original_red' in vertex else NO} | {YES if 'quality' in vertex else NO} "
            f"| {YES if 'heat' in face else NO} "
            f"| {YES if LINE in (read_provenance(path) or []) else NO} "
            f"| {back.length_unit or NO} |"
        )
    return lines


def volume_table(folder: Path) -> list[str]:
    """Return the table of volume formats that shaded voxels are written as."""
    lines = ["| format | shaded voxels | place | provenance |", "| --- | --- | --- | --- |"]
    values = np.arange(60, dtype=np.int16).reshape(3, 4, 5)
    turned = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    volume = md.Volume(values, spacing=(1, 2, 3), origin=(4, 5, 6), direction=turned)
    rgba = np.random.default_rng(1).integers(0, 256, (3, 4, 5, 4), dtype=np.uint8)
    for suffix in WRITABLE_VOLUMES:
        path = folder / f"probe{suffix}"
        write_volume(path, rgba, volume, comments=(LINE,))
        back, place = _rgba(path)
        data = (path / ".zattrs" if path.is_dir() else path).read_bytes()
        lines.append(
            f"| {suffix} | {'RGBA, 8 bit' if np.array_equal(back, rgba) else NO} "
            f"| {'kept' if place else NO} | {YES if any(m in data for m in _MARKS) else NO} |"
        )
    return lines


def _rgba(path: Path) -> tuple[np.ndarray, bool]:
    """Return the voxels of a written file, by another program, and whether their place is right."""
    if path.suffix == ".vti":
        import pyvista as pv

        image = pv.read(path)
        where = np.allclose(image.origin, (4, 5, 6)) and np.allclose(image.spacing, (1, 2, 3))
        return image.point_data["RGBA"].reshape(3, 4, 5, 4), bool(where)
    if path.suffix == ".zarr":
        import zarr

        group = zarr.open_group(path, mode="r")
        steps = group.attrs["multiscales"][0]["datasets"][0]["coordinateTransformations"]
        where = [step[step["type"]][1:] for step in steps] == [[3, 2, 1], [6, 5, 4]]
        return np.moveaxis(group["0"][...], 0, -1), where
    import SimpleITK as sitk

    image = sitk.ReadImage(str(path))
    where = np.allclose(image.GetOrigin(), (4, 5, 6)) and np.allclose(image.GetSpacing(), (1, 2, 3))
    return sitk.GetArrayFromImage(image), bool(where)


def tables() -> list[str]:
    """Return all tables."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a format can't hold is said, here it is the answer
        home = Path(folder)
        found = [mesh_table(home), volume_table(home), height_table(home), relief_table(home)]
        return [line for table in found for line in (*table, "")]


if __name__ == "__main__":
    print("\n".join(tables()))  # noqa: T201
