"""Show a CT head before and after: VTK's own shading beside Exaggerated Shading.

    python scripts/ct_before_after.py                   # docs/ct.png, of the built-in phantom
    python scripts/ct_before_after.py CT UP OUT.png CUT     # another: ct.nrrd -z head.png 1

From left to right: skin, bone, and the inside of the skull, seen from above, of which the share CUT
of the height is left.
Above VTK's shading with a light at the eye, below Exaggerated Shading with one from the northwest.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from PIL import Image

from meshdepict.baking.look import bake_volume
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.volume_picture import draw_volume
from meshdepict.io.volumes import read_volume
from meshdepict.samples import ct_phantom
from meshdepict.shapes.volume import Volume

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "ct.png"
SIDE = 288  # pixels
LOOK = {"emphasis": -0.25, "exposure": 1.15}  # steps between voxels are the finest detail there is
CUT = 0.62


def opened(head: Volume, up: str, share: float) -> Volume:
    """Return a head without the top of its skull."""
    return head.cropped(z=(1 - share, 1) if up == "-z" else (0, share))


def main(
    source: str | None = None, up: str = "z", output: str | Path = OUTPUT, cut: float = CUT
) -> None:
    """Draw the sheet."""
    head = ct_phantom((160, 160, 160)) if source is None else read_volume(source)
    sheet = Image.new("RGB", (3 * SIDE, 2 * SIDE), "white")
    figure = Figure(size=(SIDE, SIDE))
    shown = (
        (head, "skin", "front"),
        (head, "bone", "front"),
        (opened(head, up, float(cut)), "bone", "top"),
    )
    for column, (volume, transfer, view) in enumerate(shown):
        start = time.perf_counter()
        baked = bake_volume(volume, transfer=transfer, view=view, up=up, tolerance=1e-3, **LOOK)
        seconds = time.perf_counter() - start
        for row, plain in enumerate((True, False)):
            image = draw_volume(baked, figure, plain=plain)
            sheet.paste(image, (column * SIDE, row * SIDE))
        print(f"{transfer} from the {view}: {baked.shaded_share:.1%} shaded in {seconds:.1f} s")
    # 256 colours of browns on white are enough, and a quarter of the bytes.
    sheet.quantize(256, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(
        output, optimize=True
    )


if __name__ == "__main__":
    main(*sys.argv[1:5])
