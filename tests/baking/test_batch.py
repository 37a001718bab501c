"""Baking files: what is written, under which name, and what is never overwritten."""

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import meshdepict as md
from meshdepict import samples, threads
from meshdepict.baking import batch
from meshdepict.drawing.picture_files import read_picture_provenance
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.shading import METHODS, declaration


def colors(path):
    vertex = read_mesh(path).attributes["vertex"]
    return np.stack([vertex[name] for name in ("red", "green", "blue")], axis=1)


# --- results --------------------------------------------------------------------------------------


def test_bake_writes_the_colors_of_the_library(run, ball_ply):
    status, _, err = run("bake", "ball.ply")
    assert (status, err) == (0, [])
    baked = md.bake(ball_ply)
    assert np.array_equal(colors("ball-exaggerated.ply"), baked.colors)
    assert read_provenance("ball-exaggerated.ply") == baked.comments


def test_the_closing_line_is_a_caption(run, ball_ply):
    _, (line,), _ = run("bake", "ball.ply", "--width", "0.1")
    assert line.startswith("ball-exaggerated.ply: exaggerated, light northwest, ")
    assert "9 widths 0.1 to 1.6, " in line
    assert float(line.removesuffix(" s").rpartition(" ")[2]) >= 0


def test_the_closing_line_without_scales_has_no_widths(run, ball_ply):
    _, (line,), _ = run("bake", "ball.ply", "-m", "lambert", "--light", "300,20")
    caption = "ball-lambert.ply: lambert, light azimuth 300 elevation 20, "
    assert line.startswith(caption)
    assert line.removeprefix(caption).endswith(" s")
    assert "width" not in line


@pytest.mark.parametrize(
    ("words", "arguments"),
    [
        (("-m", "half_lambert"), {"method": "half_lambert"}),
        (("--method", "lambert", "--light", "east"), {"method": "lambert", "light": "east"}),
        (("--light", "-1,1,1"), {"light": (-1, 1, 1)}),
        (("--light=-1,.5,1e0",), {"light": (-1, 0.5, 1)}),
        (("--light", "-30,-20"), {"light": (-30, -20)}),
        (("--view", "left"), {"view": "left"}),
        (("--up", "z"), {"up": "z"}),
        (("--scales", "3"), {"scales": 3}),
        (("--width", "0.07"), {"width": 0.07}),
        (("--width", "3%"), {"width": "3%"}),
        (("--ratio", "1.7"), {"ratio": 1.7}),
        (("--facing", "0", "--width", "0.3"), {"facing": 0, "width": 0.3}),
        (("--tolerance", "1e-2"), {"tolerance": 1e-2}),
        (("--colormap", "sepia"), {"colormap": "sepia"}),
        (("--refine", "4"), {"refine": 4.0}),
        (
            ("--set", "exaggeration=40", "--set", "emphasis=-1"),
            {"exaggeration": 40.0, "emphasis": -1.0},
        ),
    ],
)
def test_every_option_of_bake_reaches_the_library(run, ball_ply, words, arguments):
    status, _, err = run("bake", "ball.ply", "-o", "out.ply", "--quiet", *words)
    assert (status, err) == (0, [])
    expected = md.bake(ball_ply, **arguments)
    assert np.array_equal(colors("out.ply"), expected.colors)
    assert read_provenance("out.ply") == expected.comments


@pytest.fixture
def small_golf_ball(monkeypatch):
    mesh = samples.golf_ball(400, dimples=12)
    monkeypatch.setattr(samples, "golf_ball", lambda: mesh)
    return mesh


def test_without_input_a_golf_ball_is_baked(run, folder, small_golf_ball):
    status, (line,), err = run("bake", "--quiet")
    assert (status, err) == (0, [])
    assert line.startswith("golf-ball-exaggerated.ply: exaggerated, ")
    assert np.array_equal(colors("golf-ball-exaggerated.ply"), md.bake(small_golf_ball).colors)


def test_a_first_bake_shows_before_and_after_and_how_to_go_on(run, folder, small_golf_ball):
    status, (line,), err = run("bake", "-o", "first.ply")
    assert status == 0
    assert "picture first.png" in line
    assert err[-1].startswith("meshdepict: next: meshdepict bake YOUR.ply")
    with Image.open("first.png") as image:
        page = np.asarray(image.convert("RGB")).astype(int)
    height, width = page.shape[:2]
    before, after = page[:, : width // 2], page[:, width // 2 :]
    assert width == 2 * 600 < 2 * height
    assert (before < 10).all(axis=2).any()  # plain light leaves a side black
    assert np.abs(before - after).max() > 50
    assert read_picture_provenance("first.png")


def test_a_mesh_without_an_area_is_said(run, folder):
    Path("flat.off").write_text("OFF\n3 1 0\n1 1 1\n1 1 1\n2 2 2\n3 0 1 2\n")
    status, _, (line,) = run("bake", "flat.off")
    assert status == 0
    assert line.endswith("flat.off: none of its triangles has an area: there is no shape to see")


def test_a_first_bake_where_nothing_can_be_drawn_goes_on(run, folder, small_golf_ball, monkeypatch):
    def fail(*_):
        raise ImportError("libGL.so.1 is missing")

    monkeypatch.setattr("meshdepict.drawing.before_after.before_after", fail)
    status, (line,), err = run("bake", "-o", "first.ply")
    assert (status, "picture" in line) == (0, False)
    assert "no picture could be drawn (libGL.so.1 is missing)" in err[0]
    assert [path.name for path in folder.iterdir()] == ["first.ply"]


@pytest.mark.parametrize(
    ("name", "output"),
    [
        ("ball.ply", "ball-lambert.ply"),
        ("scan.v2.ply", "scan.v2-lambert.ply"),
        ("ball.ply.gz", "ball-lambert.ply"),
        ("BALL.OBJ", "BALL-lambert.ply"),
        ("find 7 [a].off", "find 7 [a]-lambert.ply"),
        ("ball.bin", "ball.bin-lambert.ply"),
    ],
)
def test_the_output_is_named_after_input_and_method(run, folder, name, output):
    written = "temporary.ply" if name.endswith(".bin") else name
    write_mesh(written, samples.sphere(42))
    os.rename(written, name)
    assert run("bake", name, "-m", "lambert")[0] == 0
    assert (folder / output).is_file()


def test_input_elsewhere_is_baked_into_the_current_folder(run, ball_ply, folder):
    (folder / "sub").mkdir()
    os.rename("ball.ply", "sub/ball.ply")
    assert run("bake", "sub/ball.ply")[0] == 0
    assert [path.name for path in (folder / "sub").iterdir()] == ["ball.ply"]
    assert (folder / "ball-exaggerated.ply").is_file()


@pytest.mark.parametrize("given", ["sub", "sub/", "sub/other.obj"])
def test_output_is_a_file_or_a_folder(run, ball_ply, folder, given):
    (folder / "sub").mkdir()
    assert run("bake", "ball.ply", "-o", given)[0] == 0
    (found,) = (folder / "sub").iterdir()
    assert found.name == ("other.obj" if "other" in given else "ball-exaggerated.ply")


def test_albedo_keep_multiplies_the_own_colors(run, folder):
    mesh = samples.sphere(42)
    write_mesh("red.ply", mesh, colors=np.full((42, 3), (255, 128, 0), np.uint8))
    assert run("bake", "red.ply", "-m", "half_lambert", "-o", "plain.ply")[0] == 0
    assert (
        run("bake", "red.ply", "-m", "half_lambert", "--albedo", "keep", "-o", "kept.ply")[0] == 0
    )
    plain, kept = colors("plain.ply"), colors("kept.ply")
    assert np.array_equal(kept[:, 0], plain[:, 0])  # times one
    assert (kept[:, 1] <= plain[:, 1]).all()
    assert (kept[:, 1] < plain[:, 1]).any()
    assert not kept[:, 2].any()
    vertex = read_mesh("kept.ply").attributes["vertex"]
    assert (vertex["original_green"] == 128).all()


def test_rebaking_keeps_the_own_colors_for_albedo(run, folder):
    write_mesh("red.ply", samples.sphere(42), colors=np.full((42, 3), (200, 100, 50), np.uint8))
    assert run("bake", "red.ply", "-o", "one.ply")[0] == 0
    for source in ("red.ply", "one.ply"):
        assert run("bake", source, "--albedo", "keep", "-o", f"{source}-two.ply")[0] == 0
    assert np.array_equal(colors("red.ply-two.ply"), colors("one.ply-two.ply"))


def test_winding_keep_believes_the_file(run, folder):
    mesh = samples.sphere(162)
    write_mesh("inside.ply", md.Mesh(mesh.vertices, mesh.faces[:, ::-1], winding="keep"))
    light = ("-m", "half_lambert", "--light", "0,0,1")
    status, _, (note,) = run("bake", "inside.ply", *light)
    assert status == 0
    assert note.startswith("meshdepict: note: inside.ply: winding of 320 faces was turned")
    assert run("bake", "inside.ply", *light, "--winding", "keep", "-o", "kept.ply")[2] == []
    assert run("bake", "inside.ply", *light, "--quiet", "-o", "quiet.ply")[2] == []
    turned, kept = colors("inside-half_lambert.ply"), colors("kept.ply")
    assert np.array_equal(colors("quiet.ply"), turned)
    top = mesh.vertices[:, 2].argmax()
    assert turned[top].min() > 250
    assert kept[top].max() < 5


def test_fix_winding_writes_the_turned_faces(run, folder):
    mesh = samples.sphere(162)
    write_mesh("inside.ply", md.Mesh(mesh.vertices, mesh.faces[:, ::-1], winding="keep"))
    assert run("bake", "inside.ply", "--fix-winding", "-o", "fixed.ply")[0] == 0
    fixed = read_mesh("fixed.ply")
    assert fixed.orientation.message is None
    assert (np.sort(fixed.faces) == np.sort(mesh.faces)).all()
    assert np.array_equal(colors("fixed.ply"), md.bake(mesh).colors)


def test_threads_are_limited_for_one_run_only(run, ball_ply, monkeypatch):
    seen = []
    monkeypatch.setattr(batch.Batch, "run", lambda self: seen.append(threads.thread_count()) or 0)
    for words in (("--threads", "1"), (), ("--threads", "3")):
        assert run("bake", "ball.ply", *words)[0] == 0
    threads.limit(None)
    assert seen == [1, threads.thread_count(), 3]


# --- what may be replaced -------------------------------------------------------------------------


def test_own_results_are_replaced(run, ball_ply):
    assert run("bake", "ball.ply", "-o", "out.ply", "--light", "east")[0] == 0
    first = colors("out.ply")
    assert run("bake", "ball.ply", "-o", "out.ply", "--light", "west")[0] == 0
    assert not np.array_equal(colors("out.ply"), first)


@pytest.mark.parametrize("content", [b"ply\nsomething", b"", b"words"])
def test_the_files_of_others_are_not_replaced_unless_forced(run, ball_ply, folder, content):
    (folder / "out.ply").write_bytes(content)
    status, out, (line,) = run("bake", "ball.ply", "-o", "out.ply")
    assert (status, out) == (2, [])
    assert line.startswith("meshdepict: out.ply exists and was not written by meshdepict: ")
    assert "--force" in line
    assert (folder / "out.ply").read_bytes() == content
    assert run("bake", "ball.ply", "-o", "out.ply", "--force")[0] == 0
    assert read_provenance("out.ply")


@pytest.mark.parametrize("name", ["out.obj", "out.off", "out.glb", "out.ply.gz"])
def test_own_results_are_known_in_every_format(run, ball_ply, name):
    for light in ("east", "west"):
        assert run("bake", "ball.ply", "-o", name, "--light", light)[0] == 0


def test_an_input_is_not_replaced_unless_forced(run, ball_ply, folder):
    run("bake", "ball.ply", "-o", "baked.ply")  # ours, but an input all the same
    before = (folder / "baked.ply").read_bytes()
    os.symlink("baked.ply", "link.ply")
    for output in ("baked.ply", "./baked.ply", "link.ply"):
        status, _, (line,) = run("bake", "baked.ply", "-o", output, "-m", "lambert")
        assert status == 2
        assert line.startswith(f"meshdepict: {md_path(output)} is an input: ")
        assert (folder / "baked.ply").read_bytes() == before
    assert run("bake", "baked.ply", "-o", "baked.ply", "-m", "lambert", "--force")[0] == 0
    assert "meshdepict method: lambert" in read_provenance("baked.ply")


def md_path(text):
    return text.removeprefix("./")


def test_names_are_checked_before_anything_is_read(run, ball_ply, folder, monkeypatch):
    (folder / "out.ply").write_text("mine")
    monkeypatch.setattr(batch, "as_solid", lambda *_, **__: pytest.fail("read too early"))
    for words in (("-o", "out.ply"), ("-o", "x.stl"), ("--picture", "x.tif")):
        assert run("bake", "ball.ply", *words)[0] == 2


# --- several --------------------------------------------------------------------------------------


def test_one_failed_file_does_not_stop_the_rest(run, ball_ply, folder):
    (folder / "bad.ply").write_text("nothing of the kind")
    write_mesh("second.off", samples.sphere(42))
    status, out, err = run("bake", "ball.ply", "bad.ply", "gone.ply", "second.off")
    assert status == 2
    assert [line.split(":")[0] for line in out] == [
        "ball-exaggerated.ply",
        "second-exaggerated.ply",
    ]
    assert err[0] == "meshdepict: gone.ply: there is no such file"
    assert err[1].startswith("meshdepict: bad.ply")
    assert err[2:] == ["meshdepict: 2 of 4 baked"]


def test_several_are_baked_into_a_folder(run, ball_ply, folder):
    (folder / "out").mkdir()
    write_mesh("second.ply", samples.sphere(42))
    status, out, err = run("bake", "ball.ply", "second.ply", "-o", "out", "--quiet")
    assert (status, len(out), err) == (0, 2, [])
    assert {path.stem for path in (folder / "out").iterdir()} == {
        "ball-exaggerated",
        "second-exaggerated",
    }


def test_two_inputs_never_share_an_output(run, ball_ply, folder):
    write_mesh("ball.obj", samples.sphere(42))
    status, out, err = run("bake", "ball.ply", "ball.obj")
    assert status == 2
    assert len(out) == 1
    assert err == [
        "meshdepict: ball.obj would become ball-exaggerated.ply as ball.ply does: "
        "name its output with -o",
        "meshdepict: 1 of 2 baked",
    ]
    assert np.array_equal(read_mesh("ball-exaggerated.ply").vertices, ball_ply.vertices)


def test_running_out_of_memory_is_one_file_s_fault(run, ball_ply, folder, monkeypatch):
    write_mesh("second.ply", samples.sphere(42))

    def read(path, **_):
        if path.name == "ball.ply":
            raise MemoryError
        return read_mesh(path)

    monkeypatch.setattr(batch, "as_solid", read)
    status, out, err = run("bake", "ball.ply", "second.ply")
    assert (status, len(out)) == (2, 1)
    assert err[0].startswith("meshdepict: ball.ply: out of memory")


def test_a_folder_named_with_a_slash_is_made(run, ball_ply, folder):
    code, lines, errors = run("bake", "ball.ply", "-m", "gooch", "-o", "new/deep/")
    assert (code, errors) == (0, [])
    assert lines[0].startswith("new/deep/ball-gooch.ply: ")
    assert (folder / "new/deep/ball-gooch.ply").exists()


def test_several_lights_are_parted_by_semicolons(run, ball_ply):
    code, lines, _ = run("bake", "ball.ply", "-m", "phong", "--light", "north; 120,30; 1,0,0")
    assert code == 0
    assert "phong" in lines[0]


def test_one_scale_has_one_width(run, ball_ply):
    _, (line,), _ = run("bake", "ball.ply", "--scales", "1", "--width", "0.1")
    assert ", 1 width 0.1, " in line


def test_angles_survive_as_plain_text_in_pictures_and_headers(run, ball_ply, folder):
    code, _, errors = run("bake", "ball.ply", "--light", "0,90", "--picture", "p.png")
    assert (code, errors) == (0, [])
    head = (folder / "ball-exaggerated.ply").read_bytes().partition(b"end_header")[0]
    assert head.isascii()
    assert b"light: azimuth 0 elevation 90" in head


def test_a_fault_of_the_program_s_own_is_one_line_and_the_rest_goes_on(run, ball_ply, monkeypatch):
    def broken(*arguments, **options):
        raise RuntimeError("that should not happen")

    from meshdepict.baking.baked import Baked

    monkeypatch.setattr(Baked, "save", broken)
    code, lines, errors = run("bake", "ball.ply", "-m", "lambert")
    assert (code, lines) == (2, [])
    assert errors == [
        "meshdepict: ball.ply: an unexpected fault, please report it "
        "(RuntimeError: that should not happen)"
    ]


# --- pictures -------------------------------------------------------------------------------------


def picture(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGBA")), image.info


def test_every_option_of_a_figure_reaches_the_picture(run, ball_ply):
    words = ("--size", "2x1cm", "--dpi", "127", "--background", "transparent", "--scale-bar")
    assert run("bake", "ball.ply", "--picture", "a.png", *words, "--unit", "µm")[0] == 0
    md.bake(ball_ply).picture(
        "b.png", size="2x1cm", dpi=127, background="transparent", scale_bar=True, unit="µm"
    )
    (found, info), (expected, _) = picture("a.png"), picture("b.png")
    np.testing.assert_array_equal(found, expected)
    assert found.shape == (50, 100, 4)
    assert info["dpi"] == pytest.approx((127, 127), abs=0.02)


def test_hundreds_of_finds_are_seen_alike(run, folder):
    """One view, one light, one scale, wherever the finds lie and however large they are."""
    (folder / "look.toml").write_text(
        'method = "half_lambert"\nlight = [1, 2, 3]\n'
        "view = { position = [5, 5, 5], focus = [0, 0, 0], up = [0, 1, 0], parallel_scale = 3 }\n"
    )
    ball = samples.sphere(642)
    for radius, away in ((1, 0), (2, 70)):
        mesh = md.Mesh(ball.vertices * radius + (away, 0, 0), ball.faces)
        write_mesh(f"find{radius}.ply", mesh)
    words = ("--recipe", "look.toml", "--picture", "plates/", "--pixels-per-unit", "20")
    status, lines, _ = run("bake", "find1.ply", "find2.ply", *words, "-o", "out/")
    assert (status, len(lines)) == (0, 2)
    small, _ = picture("plates/find1-half_lambert.png")
    large, _ = picture("plates/find2-half_lambert.png")
    widths = [np.ptp(np.flatnonzero((p[..., 0] < 250).any(axis=0))) + 1 for p in (small, large)]
    assert widths == pytest.approx([40, 80], abs=2)
    middles = [p[len(p) // 2, p.shape[1] // 2, 0] for p in (small, large)]
    assert abs(int(middles[0]) - int(middles[1])) <= 2


def test_a_find_too_large_for_the_plate_is_refused_before_its_bake(run, ball_ply, monkeypatch):
    monkeypatch.setattr(batch, "check_look", lambda look: None)
    monkeypatch.setattr(batch, "bake_surface", lambda *_, **__: pytest.fail("baked in vain"))
    words = ("--picture", "p.png", "--pixels-per-unit", "100", "--size", "60x60")
    status, out, (line,) = run("bake", "ball.ply", *words)
    assert (status, out) == (2, [])
    assert line.startswith("meshdepict: ball.ply: at 100 pixels per unit the object takes ")


def test_figures_are_refused_before_anything_is_read(run, ball_ply, folder, monkeypatch):
    monkeypatch.setattr(batch, "as_solid", lambda *_, **__: pytest.fail("read too early"))
    (folder / "look.toml").write_text(
        "view = { position = [0, 0, 9], focus = [0, 0, 0], up = [0, 1, 0] }\n"
    )
    for words, sentence in (
        (("--size", "big"), "size 'big' is not WIDTHxHEIGHT"),
        (("--background", "blu"), "background='blu' is none of"),
        (("--recipe", "look.toml", "--scale-bar"), "a scale bar needs a parallel view"),
        (("--recipe", "look.toml", "--pixels-per-unit", "3"), "a fixed scale needs a parallel"),
    ):
        status, _, (line,) = run("bake", "ball.ply", "--picture", "p.png", *words)
        assert status == 2
        assert sentence in line


def test_colours_that_are_off_between_vertices_are_said_so_until_refined(run, ball_ply):
    status, _, (note,) = run("bake", "ball.ply", "-m", "lambert")
    error = md.bake(ball_ply, "lambert").edge_error
    assert status == 0
    assert f"off by {error.rms:.0f} of 255 grey levels (rms), at {error.share:.0%}" in note
    status, _, err = run("bake", "ball.ply", "-m", "lambert", "--refine", "2")
    assert (status, err) == (0, [])


def test_refining_is_not_recommended_where_it_shows_no_more_of_the_surface(run, data, folder):
    beetle = str(data / "mesh" / "beetle_2k.ply")
    status, _, (note,) = run("bake", beetle, "-m", "lambert", "--winding", "keep")
    assert status == 0
    assert "large triangles meet at sharp edges there, a finer mesh is needed" in note
    assert "--refine" not in note


def test_a_page_that_turns_is_a_format_like_others(run, ball_ply, folder):
    words = ["bake", "ball.ply", "-m", "gooch", "-o", "ball.html"]
    assert run(*words)[0] == 0
    assert "<canvas" in (folder / "ball.html").read_text()
    assert run(*words)[0] == 0  # its own file
    (folder / "ball.html").write_text("<html>mine")
    status, _, err = run(*words)
    assert (status, len(err)) == (2, 1)
    assert (folder / "ball.html").read_text() == "<html>mine"


@pytest.mark.parametrize("word", ["--size 30x40", "--scale-bar", "--unit mm", "--dpi 100"])
def test_words_about_a_picture_want_one(run, ball_ply, word):
    status, out, (sentence,) = run("bake", "ball.ply", *word.split())
    assert (status, out) == (2, [])
    assert f"{word.split()[0]} is about a picture: give --picture, too" in sentence


# --- triangles ----------------------------------------------------------------------------------

STRIPS = """ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z
element tristrips 1
property list int int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
1 1 0.3
0 2 0
5 0 1 2 3 4
"""


def test_strips_stay_strips_unless_triangles_are_asked_for(run, folder):
    Path("strips.ply").write_text(STRIPS)
    status, _, messages = run("bake", "strips.ply", "-o", "kept.ply", "-m", "lambert")
    assert status == 0
    assert len(messages) == 1
    assert messages[0].startswith("meshdepict: note: strips.ply: ")
    assert "its triangle strips stay strips" in messages[0]
    assert b"element tristrips 1" in Path("kept.ply").read_bytes()
    status, _, messages = run(
        "bake", "strips.ply", "-o", "faces.ply", "-m", "lambert", "--triangles"
    )
    assert (status, [m for m in messages if "strips" in m.split(": ", 3)[-1]]) == (0, [])
    kept, faces = read_mesh("kept.ply"), read_mesh("faces.ply")
    assert b"element face 3" in Path("faces.ply").read_bytes()
    np.testing.assert_array_equal(faces.faces, kept.faces)
    for name, values in kept.attributes["vertex"].items():
        np.testing.assert_array_equal(faces.attributes["vertex"][name], values)


def test_polygons_become_triangles_with_their_data(run, folder):
    attributes = {"face": {"part": np.array([7, 8])}}
    house = md.Mesh(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]],
        [[0, 1, 2, 3], [0, 1, 4]],
        attributes=attributes,
    )
    write_mesh("house.ply", house)
    status, _, _ = run("bake", "house.ply", "-o", "faces.ply", "--triangles", "-m", "lambert")
    assert status == 0
    baked = read_mesh("faces.ply")
    assert baked.polygons is None
    assert baked.attributes["face"]["part"].tolist() == [7, 7, 8]


@pytest.mark.parametrize(
    "name", [name for name in METHODS if "heights" in declaration(METHODS[name]).needs]
)
def test_methods_of_terrain_bake_terrain_and_refuse_meshes(run, folder, name):
    rows = "\n".join(" ".join(str((i * j) % 7) for j in range(12)) for i in range(12))
    (folder / "hill.asc").write_text(
        f"ncols 12\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 1\n{rows}\n"
    )
    write_mesh("ball.ply", samples.sphere(100))
    status, out, err = run("bake", "hill.asc", "ball.ply", "-m", name)
    assert status == 2
    assert len(out) == 1
    assert out[0].startswith(f"hill-{name}.ply: {name}")
    assert any("ball.ply: heights on a raster are needed" in line for line in err)
    laid = run("bake", "hill.asc", "--blend", f"{name}:multiply:0.5,lambert", "-o", "laid.ply")
    assert laid[0] == 0
