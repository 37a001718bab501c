"""Movies: the turn as geometry, frames that are pictures, files that play and say their origin."""

import subprocess

import numpy as np
import pytest
from PIL import Image, ImageSequence

import meshdepict as md
from meshdepict import MeshdepictError, samples
from meshdepict.drawing import encoding
from meshdepict.drawing.encoding import (
    gif_speed,
    read_movie_provenance,
    write_gif,
    write_mp4,
)
from meshdepict.drawing.figure import Figure
from meshdepict.drawing.motion import circling, rotation, turned, turned_light
from meshdepict.drawing.movie import check_movie, save_movie
from meshdepict.scene.light import Lights
from meshdepict.viewer.session import Session

SMALL = Figure(size=(60, 50))
FRONT = md.View((0, 0, 9), (0, 0, 0), (0, 1, 0), parallel_scale=1.1)


@pytest.fixture
def session():
    ball = samples.golf_ball(400, dimples=12)
    return Session(md.Mesh(ball.vertices * (2, 1, 1), ball.faces), "half_lambert")


def decoded(path, size):
    """Frames of an MP4, (frames, height, width, 3)."""
    command = [encoding.require_encoder(), "-v", "error", "-i", str(path)]
    command += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, size[1], size[0], 3)


# --- geometry -------------------------------------------------------------------------------------


def test_a_rotation_turns_about_its_axis_by_its_angle(rng):
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    matrix = rotation(axis, 50)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(matrix @ axis, axis, atol=1e-14)
    assert np.trace(matrix) == pytest.approx(1 + 2 * np.cos(np.radians(50)))
    np.testing.assert_allclose(rotation((0, 0, 1), 90) @ (1, 0, 0), (0, 1, 0), atol=1e-15)


def test_the_eye_goes_to_the_right_and_comes_back():
    np.testing.assert_allclose(turned(FRONT, 90).towards_eye, (1, 0, 0), atol=1e-15)
    np.testing.assert_allclose(turned(FRONT, 360).position, FRONT.position, atol=1e-13)
    assert turned(FRONT, 90).parallel_scale == FRONT.parallel_scale
    perspective = md.View((0, 1, 9), (0, 1, 0), (0, 1, 0), field_of_view=20.0)
    assert turned(perspective, 45).field_of_view == 20.0


def test_a_light_that_goes_with_the_eye_stays_where_the_eye_sees_it():
    for angle in (30, 200):
        view = turned(FRONT, angle)
        light = turned_light(md.Light((-1, 2, 3), "mine", (1, 0.5, 0)), FRONT, angle)
        np.testing.assert_allclose(view.frame @ light.direction, np.array((-1, 2, 3)) / 14**0.5)
        assert (light.name, *light.color) == ("mine", 1, 0.5, 0)
        several = turned_light(Lights([light, light]), FRONT, -angle)
        np.testing.assert_allclose(several[1].direction, np.array((-1, 2, 3)) / 14**0.5)


def test_a_circling_light_goes_clockwise_and_keeps_its_elevation():
    light = md.Light((0, 1, 1))  # from above
    for angle, (x, y) in ((0, (0, 1)), (90, (1, 0)), (180, (0, -1)), (270, (-1, 0))):
        found = circling(light, FRONT, angle).direction * 2**0.5
        np.testing.assert_allclose(found, (x, y, 1), atol=1e-14)


# --- frames ---------------------------------------------------------------------------------------


def test_the_frames_of_a_turning_object_are_its_pictures(session, tmp_path):
    path = save_movie(session, tmp_path / "turn.gif", seconds=0.4, fps=10, figure=SMALL)
    with Image.open(path) as movie:
        assert movie.info["loop"] == 0
        frames = [np.array(frame.convert("RGB")) for frame in ImageSequence.Iterator(movie)]
        assert movie.info["duration"] == 100
    assert len(frames) == 4
    for frame, name in zip(frames, ("front", "right", "back", "left"), strict=True):
        view = md.View.fitted(name, session.shape)
        width = np.ptp(np.flatnonzero((frame < 250).any(axis=(0, 2)))) + 1
        expected = {"front": 2, "right": 1, "back": 2, "left": 1}[name] * 60 / 2.1
        assert width == pytest.approx(expected, abs=1.5)
        seen = session.shape.normals @ view.towards_eye > 0.2
        colors = md.bake(session.shape, "half_lambert", view=view).colors[seen]
        shown = frame[(frame < 250).any(axis=2)]
        assert shown.mean() == pytest.approx(colors.mean(), abs=12)  # the light went along


def test_a_light_fixed_to_the_object_leaves_its_colors(session, tmp_path, monkeypatch):
    shone = []
    monkeypatch.setattr(session, "shine", shone.append)
    light = session.light
    save_movie(session, tmp_path / "a.gif", light_fixed="object", seconds=0.4, fps=10, figure=SMALL)
    assert shone == [light]  # put back at the end; once in all


def test_a_light_turn_shades_anew_with_one_scale_space(tmp_path):
    session = Session(samples.golf_ball(400, dimples=12), scales=2)
    path = save_movie(session, tmp_path / "l.gif", turn="light", seconds=0.4, fps=10, figure=SMALL)
    assert len(session._spaces) == 1
    with Image.open(path) as movie:
        frames = [np.array(f.convert("L"), float) for f in ImageSequence.Iterator(movie)]
    assert len(frames) == 4
    halves = [frame[:25].mean() > frame[25:].mean() for frame in frames]
    assert halves == [True, True, False, False]  # from northwest, northeast, southeast, southwest
    for one, other in zip(frames, frames[1:] + frames[:1], strict=True):
        assert (one != other).any()  # nor is the last frame the first


def test_a_movie_has_its_caption_below_in_every_frame(session, tmp_path):
    figure = Figure(size=(300, 200), caption="auto")
    path = save_movie(session, tmp_path / "m.gif", seconds=0.2, fps=10, figure=figure)
    with Image.open(path) as movie:
        for index in range(movie.n_frames):
            movie.seek(index)
            strip = np.asarray(movie.convert("L"))[-20:]
            assert (strip < 128).sum() > 50


@pytest.mark.parametrize("turn", ["light", "object"])
def test_a_session_is_left_as_it_was(session, tmp_path, turn):
    view, light, colors = session.view, session.light, session.colors.copy()
    save_movie(session, tmp_path / "m.gif", turn=turn, seconds=0.2, fps=10, figure=SMALL)
    assert (session.view, session.light) == (view, light)
    np.testing.assert_array_equal(session.colors, colors)


def test_methods_that_follow_the_view_are_shaded_for_every_frame(tmp_path, monkeypatch):
    session = Session(samples.golf_ball(400, dimples=12), "gooch")
    seen = []
    look = session.look
    monkeypatch.setattr(session, "look", lambda view: (seen.append(view), look(view)))
    save_movie(session, tmp_path / "m.gif", light_fixed="object", seconds=0.3, fps=10, figure=SMALL)
    directions = {tuple(np.round(view.towards_eye, 9)) for view in seen}
    assert len(directions) == 3


# --- files ----------------------------------------------------------------------------------------


def test_an_mp4_has_even_sides_its_length_and_its_provenance(session, tmp_path):
    lines = session.baked().comments
    steps = []
    path = save_movie(
        session, tmp_path / "m.mp4", seconds=0.5, fps=12, figure=Figure(size=(61, 51)),
        progress=lambda *step: steps.append(step),
    )  # fmt: skip
    assert steps == [(i, 6) for i in range(1, 7)]
    assert decoded(path, (62, 52)).shape[0] == 6
    assert read_movie_provenance(path) == [*lines, "meshdepict turn: object in 6 frames"]
    assert [file.name for file in tmp_path.iterdir()] == ["m.mp4"]


def test_mp4_keeps_colors_as_well_as_its_bytes_can(tmp_path):
    colors = [(226, 221, 209), (250, 20, 10), (0, 128, 60), (128, 128, 128)]
    image = Image.fromarray(np.repeat(np.uint8(colors), 32, axis=0)[None].repeat(64, axis=0))
    write_mp4(tmp_path / "c.mp4", [image] * 3, fps=5, lines=["meshdepict ü"])
    frame = decoded(tmp_path / "c.mp4", (128, 64))[1].astype(int)
    assert np.abs(frame[32, 16::32] - colors).max() <= 4  # 219 levels, rounded twice
    assert read_movie_provenance(tmp_path / "c.mp4") == ["meshdepict ü"]


def test_a_gif_of_greys_is_exact(tmp_path, rng):
    frames = [Image.fromarray(rng.integers(0, 256, (20, 30), np.uint8)) for _ in range(3)]
    with (tmp_path / "g.gif").open("wb") as stream:
        write_gif(stream, iter(frames), frames[:1], fps=10, lines=["meshdepict a", "other"])
    with Image.open(tmp_path / "g.gif") as movie:
        for frame, before in zip(ImageSequence.Iterator(movie), frames, strict=True):
            np.testing.assert_array_equal(np.array(frame.convert("L")), np.array(before))
    assert read_movie_provenance(tmp_path / "g.gif") == ["meshdepict a"]


def test_a_gif_keeps_the_ground_exactly_and_colors_nearly(tmp_path, rng):
    ramp = np.linspace(0, 1, 200)
    wheel = np.stack([ramp, ramp**2, 1 - ramp], axis=1) * 255
    image = np.uint8(wheel)[None].repeat(20, axis=0)
    image[:5] = (226, 221, 209)
    image[5] = rng.integers(0, 256, (200, 3))  # more than 256 colours
    with (tmp_path / "g.gif").open("wb") as stream:
        write_gif(stream, iter([Image.fromarray(image)]), [Image.fromarray(image)], fps=10)
    with Image.open(tmp_path / "g.gif") as movie:
        found = np.array(movie.convert("RGB")).astype(int)
    assert (found[:5] == (226, 221, 209)).all()
    assert np.abs(found[6:] - image[6:]).mean() < 6  # a palette of 256 for 200 hues and noise


@pytest.mark.parametrize(("asked", "had"), [(25, 25), (24, 25), (30, 100 / 3), (60, 50), (1, 1)])
def test_gif_speeds_are_hundredths_of_a_second(asked, had):
    assert gif_speed(asked) == pytest.approx(had)


def test_other_files_have_no_provenance(tmp_path):
    (tmp_path / "a.mp4").write_bytes(b"nothing \xa9cmt\x00\x00\x00\xff short")
    (tmp_path / "a.gif").write_bytes(b"GIF89a")
    Image.new("L", (4, 4)).save(tmp_path / "b.gif")
    for name in ("a.mp4", "a.gif", "b.gif", "missing.mp4", "missing.gif"):
        assert read_movie_provenance(tmp_path / name) is None


@pytest.mark.parametrize("name", ["m.mp4", "m.gif"])
def test_an_interruption_leaves_the_earlier_file_whole(session, tmp_path, name):
    (tmp_path / name).write_text("earlier")

    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    view = session.view
    with pytest.raises(KeyboardInterrupt):
        save_movie(session, tmp_path / name, seconds=1, fps=10, figure=SMALL, progress=stop)
    assert [file.name for file in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "earlier"
    assert session.view is view


def test_what_ffmpeg_can_t_encode_is_one_sentence(tmp_path):
    image = Image.new("RGB", (8, 8))
    with pytest.raises(MeshdepictError, match=r"ffmpeg could not encode the movie: .*No such file"):
        write_mp4(tmp_path / "missing" / "m.mp4", [image] * 3, fps=5)
    with pytest.raises(MeshdepictError, match="no frames"):
        write_mp4(tmp_path / "m.mp4", [], fps=5)


def test_without_ffmpeg_the_way_to_it_is_said(monkeypatch, tmp_path):
    import sys

    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MeshdepictError, match=r"pip install 'meshdepict\[movie\]'"):
        check_movie(tmp_path / "m.mp4")
    assert check_movie(tmp_path / "m.gif", seconds=2, fps=10) == 20


@pytest.mark.parametrize(
    ("name", "words", "sentence"),
    [
        ("m.avi", {}, r"written as \.mp4 or \.gif"),
        ("m", {}, r"written as \.mp4 or \.gif"),
        ("m.gif", {"turn": "eye"}, "turn='eye' is neither"),
        ("m.gif", {"light_fixed": "sun"}, "light_fixed='sun' is neither"),
        ("m.gif", {"seconds": 0}, "seconds=0 is not a positive number"),
        ("m.gif", {"fps": float("inf")}, "fps=inf is not a positive number"),
        ("m.gif", {"seconds": 0.01}, "are 0 frames: 2 to 10000"),
        ("m.gif", {"seconds": 1e9}, "2 to 10000"),
        ("m.gif", {"figure": Figure(background="transparent")}, "no transparency"),
    ],
)
def test_what_can_t_be_a_movie_is_refused(session, tmp_path, name, words, sentence):
    with pytest.raises(MeshdepictError, match=sentence):
        save_movie(session, tmp_path / name, **words)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("light", "words", "sentence"),
    [
        ("front", {"turn": "light"}, "along the line of sight"),
        (["north", "east"], {"turn": "light"}, "one light circles, not several"),
    ],
)
def test_lights_that_can_t_turn_are_refused(tmp_path, light, words, sentence):
    session = Session(samples.sphere(42), "phong", light=light)
    with pytest.raises(MeshdepictError, match=sentence):
        save_movie(session, tmp_path / "m.gif", **words)
    assert not list(tmp_path.iterdir())


def test_an_environment_stays_with_the_object():
    sky = md.Environment(np.ones((4, 8, 3)))
    with pytest.raises(MeshdepictError, match="give light_fixed='object'"):
        turned_light(sky, FRONT, 10)


# --- the command ----------------------------------------------------------------------------------


def test_the_command_writes_a_movie_and_replaces_only_its_own(run, ball_ply, folder):
    words = ["movie", "ball.ply", "-o", "m.gif", "--size", "40x40", "--seconds", "0.3", "--fps", 10]
    status, (line,), err = run(*words, "--turn", "light", "--scales", 2)
    assert (status, err) == (0, [])
    assert line.startswith("m.gif: exaggerated, light turning, 3 frames, ")
    assert any("scales: 2" in text for text in read_movie_provenance("m.gif"))
    assert run(*words, "-m", "lambert", "--scale-bar", "--background", "paper")[0] == 0
    (folder / "m.gif").write_text("of others")
    status, _, (line,) = run(*words)
    assert status == 2
    assert "exists and was not written by meshdepict" in line
    assert run(*words, "-m", "lambert", "--force")[0] == 0
    status, _, (line,) = run("movie", "gone.ply", "-o", "n.gif")
    assert (status, line) == (2, "meshdepict: gone.ply: there is no such file")


def test_the_command_takes_a_recipe_and_a_scale(run, ball_ply, folder):
    (folder / "look.toml").write_text('method = "lambert"\nlight = "east"\nview = "top"\n')
    words = ["movie", "ball.ply", "-o", "m.gif", "--seconds", "0.2", "--fps", 10]
    assert run(*words, "--recipe", "look.toml", "--pixels-per-unit", 20)[0] == 0
    said = read_movie_provenance("m.gif")
    assert "meshdepict method: lambert" in said
    assert any("light: east" in text for text in said)
    with Image.open("m.gif") as movie:
        assert movie.size == pytest.approx((44, 44), abs=2)
    (folder / "kept.toml").write_text('method = "lambert"\nalbedo = "keep"\n')
    status, _, (line,) = run(*words, "--recipe", "kept.toml")
    assert status == 2
    assert "kept.toml: views and movies have no albedo" in line
