"""Frames as files: MP4 that every player knows, GIF with one palette; both say their origin."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshdepict.errors import MeshdepictError
from meshdepict.files.mark import MARK

if TYPE_CHECKING:
    from PIL.Image import Image
    from scipy.spatial import KDTree

__all__ = ["gif_speed", "read_movie_provenance", "require_encoder", "write_gif", "write_mp4"]

_QUALITY = "16"  # of x264's 0 … 51: fine texture stays, a file is a few megabytes
# Where a comment lies in an MP4: the atom ©cmt, in it the atom data, its type and its language.
_COMMENT = b"\xa9cmt"


def require_encoder() -> str:
    """Return the path of ffmpeg, as imageio-ffmpeg brings or finds it.

    Raises
    ------
    MeshdepictError
        Where it is missing, with the way to install it.
    """
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise MeshdepictError(
            "movies in .mp4 need ffmpeg: pip install 'meshdepict[movie]', or write a .gif"
        ) from None


def write_mp4(
    path: str | Path, frames: Iterable[Image], *, fps: float, lines: Sequence[str] = ()
) -> None:
    """Encode images as H.264 into a file.

    Sides of odd length grow by a pixel: half the colour resolution, which players ask for, needs
    even ones.

    Parameters
    ----------
    path : path
    frames : iterable of PIL.Image
        All of one size.
    fps : float
    lines : sequence of str
        What the file's comment says.

    Raises
    ------
    MeshdepictError
        Where the encoder fails.
    """
    process: subprocess.Popen[bytes] | None = None
    with tempfile.TemporaryFile() as said:
        try:
            for image in frames:
                pixels = _even(np.asarray(image.convert("RGB")))
                if process is None:
                    command = _command(path, pixels.shape[1::-1], fps, lines)
                    process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said)
                assert process.stdin is not None
                process.stdin.write(pixels.tobytes())
            if process is not None:
                process.communicate()
        except BrokenPipeError:  # ffmpeg gave up: what it said comes below
            assert process is not None
            process.wait()
        except BaseException:
            if process is not None:
                process.kill()
                process.communicate()
            raise
        if process is None or process.returncode:
            said.seek(0)
            reason = said.read().decode(errors="replace").strip().splitlines()[-1:] or ["no frames"]
            raise MeshdepictError(f"ffmpeg could not encode the movie: {reason[0]}")


def write_gif(
    stream: BinaryIO,
    frames: Iterable[Image],
    samples: Sequence[Image],
    *,
    fps: float,
    lines: Sequence[str] = (),
) -> None:
    """Write images as an endless GIF.

    Parameters
    ----------
    stream : binary file
    frames : iterable of PIL.Image
    samples : sequence of PIL.Image
        A few of them, from which the palette is made: one for all frames, without dithering, so
        that nothing flickers.
    fps : float
        Becomes the nearest of `gif_speed`.
    lines : sequence of str
        What the file's comment says.
    """
    from scipy.spatial import KDTree

    palette = KDTree(_palette(samples))
    paletted = (_paletted(image, palette) for image in frames)
    first = next(paletted)
    first.save(
        stream, format="GIF", save_all=True, append_images=paletted, loop=0,
        duration=round(1000 / gif_speed(fps)), comment="\n".join(lines).encode(), optimize=False,
    )  # fmt: skip


def gif_speed(fps: float) -> float:
    """Return the nearest speed that a GIF can have: whole hundredths of a second, at least two."""
    return 100 / max(2, round(100 / fps))


def read_movie_provenance(path: str | Path) -> list[str] | None:
    """Return the lines that this program wrote into a movie, None where there are none."""
    from PIL import Image

    try:
        if Path(path).suffix.lower() == ".gif":
            with Image.open(path) as image:
                text = bytes(image.info.get("comment", b""))
        else:
            _, found, behind = Path(path).read_bytes().partition(_COMMENT)
            length = int.from_bytes(behind[:4], "big") if found else 0
            text = behind[16:length]
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return None
    said = text.decode(errors="replace").splitlines()
    return [line for line in said if line.startswith(MARK)] or None


def _palette(samples: Sequence[Image]) -> NDArray[np.uint8]:
    """Return the 256 colours (256, 3) that serve all: exact greys, or an exact ground."""
    from PIL import Image

    wall = np.concatenate([np.asarray(image.convert("RGB")) for image in samples])
    if (wall == wall[..., :1]).all():
        return np.arange(256, dtype=np.uint8)[:, None].repeat(3, axis=1)
    found = Image.fromarray(wall).quantize(255, method=Image.Quantize.MEDIANCUT).getpalette()
    colors = np.resize(np.array(found, np.uint8), (256, 3))
    colors[-1] = wall[0, 0]  # averages would tint it
    return colors


def _paletted(image: Image, palette: KDTree) -> Image:
    """Return an image in the nearest colours of a palette; Pillow's own search is a rough one."""
    from PIL import Image

    pixels = np.asarray(image.convert("RGB"))
    packed = pixels @ np.array((1 << 16, 1 << 8, 1))
    found, place = np.unique(packed, return_inverse=True)
    colors = np.stack((found >> 16, found >> 8 & 255, found & 255), axis=1)
    index = np.asarray(palette.query(colors)[1], np.uint8)
    out = Image.fromarray(index[place].reshape(packed.shape))
    out.putpalette(np.asarray(palette.data, np.uint8).tobytes())
    return out


def _command(
    path: str | Path, size: tuple[int, ...], fps: float, lines: Sequence[str]
) -> list[str]:
    return [
        require_encoder(), "-y", "-v", "error",
        "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{fps:.9g}",
        "-i", "-", "-an", "-c:v", "libx264", "-crf", _QUALITY, "-pix_fmt", "yuv420p",
        # The colours of high-definition television, and said so: players guess otherwise.
        "-vf", "scale=out_color_matrix=bt709:out_range=tv",
        "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
        "-movflags", "+faststart", "-metadata", "comment=" + "\n".join(lines),
        "-f", "mp4", str(path),
    ]  # fmt: skip


def _even(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    height, width = pixels.shape[:2]
    return np.pad(pixels, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
