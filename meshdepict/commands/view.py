"""``meshdepict view``: look at a mesh, terrain or a volume under a light that moves."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from meshdepict.commands import parameters
from meshdepict.commands.parameters import FILES, Everywhere, LookWords, takes_words
from meshdepict.console import complain, notes, progress_bar
from meshdepict.errors import MeshdepictError

if TYPE_CHECKING:
    from meshdepict.baking.look import Look
    from meshdepict.viewer.session import Session

__all__ = ["view"]


@takes_words(without=("colormap2d", "blend", "tint", "albedo", "refine", "ground", "budget"))
def view(
    input_: Annotated[Path | None, Parameter(name="INPUT")] = None,
    /,
    *,
    browser: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    port: Annotated[int, Parameter(group=FILES)] = 0,
    no_open: Annotated[bool, Parameter(group=FILES, show_default=False)] = False,
    recipe: Annotated[str | None, Parameter(group=FILES)] = None,
    frames: Annotated[int | None, Parameter(show=False)] = None,
    look: LookWords,
    everywhere: Everywhere,
    given: Annotated[frozenset[str], Parameter(parse=False)] = frozenset(),
) -> int:
    """Look at a mesh, terrain or CT under a light that moves.

    Without INPUT: the built-in golf ball. Drag turns the object, right drag the light.

    h shows the keys.

    Parameters
    ----------
    input_
        Mesh: PLY, OBJ, OFF, STL, GLB, glTF or VTP, gzipped or not; terrain: GeoTIFF, .dem, .asc; or
        CT: see volume.
    browser
        Show it in a browser instead of a window.
    port
        Of the page; any free one unless given.
    no_open
        Say where the page is, and open no browser.
    recipe
        Take method, light, view, scales, … from a file; what else is said here comes first.
    frames
        Draw so many frames off screen and end.
    """
    from meshdepict.baking.batch import stem
    from meshdepict.viewer.session import refuse_unshown

    everywhere.obey()
    if not browser:
        for word, so in (("--port", "port" in given), ("--no-open", no_open)):
            if so:
                raise MeshdepictError(f"{word} is about a page: give --browser, too")
    wanted = parameters.said_look(look, recipe)
    refuse_unshown(wanted, f"{recipe}: ")
    quiet = everywhere.quiet
    from meshdepict.io.heightfields import is_heightfield_path
    from meshdepict.io.volumes import is_volume_path, volume_stem

    terrain = input_ is not None and is_heightfield_path(input_)
    volume = input_ is not None and not terrain and is_volume_path(input_)
    if volume and browser:
        raise MeshdepictError(f"{input_} is a volume: the browser shows surfaces alone so far")
    if not browser and frames is None:
        from meshdepict.drawing.display import check_display

        check_display()
    if not browser:
        # A second's work, done before the bake: then the window is up at once after it.
        for module in ("pyvista.plotting", "meshdepict.viewer.windows.showing"):
            import_module(module)
    name = volume_stem(input_) if volume and input_ is not None else stem(input_)
    with notes(input_, quiet=quiet):
        session = _session(input_, wanted, name, volume=volume, quiet=quiet)
        if browser:
            from meshdepict.viewer.browser import serve

            serve(session, port=port, open_browser=not no_open, title=name)
            return 0
        from meshdepict.viewer.windows.keys import WELCOME
        from meshdepict.viewer.windows.showing import window_on

        window = window_on(session, name=name, off_screen=frames is not None)
        if not quiet:
            complain(WELCOME)
        window.run(frames=frames)
    return 0


def _session(source: Path | None, look: Look, name: str, *, volume: bool, quiet: bool) -> Session:
    """Read and bake, with a progress bar."""
    from meshdepict import samples
    from meshdepict.baking.surfaces import as_solid
    from meshdepict.viewer.session import Session
    from meshdepict.viewer.windows.volume_session import VolumeSession

    with progress_bar(name, quiet=quiet) as progress:
        kind: type[Session] = VolumeSession if volume else Session
        shape: object = source
        if not volume:
            shape = samples.golf_ball() if source is None else as_solid(source)
        session = kind(shape, look.method, progress=progress, **look.words())
        session.baked()
    session.progress = None
    return session
