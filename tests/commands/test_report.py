"""What `methods` and `info` print: everything, and nothing that isn't so."""

import numpy as np
import pytest

import meshdepict as md
from meshdepict import samples, threads
from meshdepict.commands import report
from meshdepict.io import write_mesh
from meshdepict.options import options_of
from meshdepict.shading import METHODS, declaration

# --- methods --------------------------------------------------------------------------------------


def test_methods_lists_name_summary_and_paper_of_each(run):
    status, out, err = run("methods")
    assert (status, err) == (0, [])
    text = "\n".join(out)
    for name, function in METHODS.items():
        summary = function.__doc__.splitlines()[0]
        assert any(line.split() == [name, *summary.split()] for line in out)
        assert declaration(function).source in text


@pytest.mark.parametrize("name", METHODS)
def test_methods_describes_the_options_of_one(run, name):
    status, out, _ = run("methods", name)
    assert status == 0
    declared = declaration(METHODS[name])
    assert any(declared.source in line for line in out)
    assert any((f"{declared.scales} scales" if declared.scales else "no scales") in x for x in out)
    assert any(("linear" if declared.linear else "display") in line for line in out)
    for option in options_of(METHODS[name]).values():
        (line,) = [line for line in out if line.split()[:1] == [option.name]]
        assert str(option.accepts) in line
        assert line.endswith(option.help)


def test_methods_of_several_names(run):
    status, out, _ = run("methods", "lambert", "exaggerated")
    assert status == 0
    heads = [line.split(":")[0] for line in out if line.partition(":")[0] in METHODS]
    assert heads == ["lambert", "exaggerated"]


def test_a_method_without_options_says_so(monkeypatch):
    def flat(space, light):
        """Shade nothing."""

    flat.declaration = declaration(METHODS["lambert"])
    monkeypatch.setitem(METHODS, "flat", flat)
    assert "no options" in repr(md.methods("flat"))
    assert md.methods("flat")._repr_html_().count("<table>") == 1


# --- info -----------------------------------------------------------------------------------------


def rows(lines):
    """Read the report's columns back: label → texts."""
    found, label = {}, ""
    for line in lines[1:]:
        label = line[2:14].strip() or label
        found.setdefault(label, []).append(line[16:].strip())
    return found


def test_info_counts_a_clean_mesh(run, ball_ply):
    status, out, err = run("info", "ball.ply")
    assert (status, err) == (0, [])
    assert out[0] == "ball.ply"
    found = rows(out)
    assert found["vertices"] == [f"{len(ball_ply.vertices):,}"]
    assert found["faces"] == [f"{len(ball_ply.faces):,} triangles"]
    assert found["parts"] == ["1"]
    assert found["defects"] == ["none"]
    assert found["diagonal"] == [f"{ball_ply.diagonal:.4g}"]
    assert found["edge length"] == [f"{ball_ply.edge_length:.4g} (median)"]
    assert found["default bake"][0].startswith("about ")
    assert not {"vertex data", "face data", "baked", "length unit"} & set(found)


def test_info_says_the_unit_of_length_where_the_format_has_one(run, ball_ply):
    write_mesh("ball.glb", ball_ply)
    _, out, _ = run("info", "ball.glb")
    assert rows(out)["length unit"] == ["m"]


def test_info_of_a_dirty_mesh(run, folder):
    vertices = [*np.eye(4, 3), (0, 0, 0), (5, 5, 5)]  # 3 and 4 coincide, 5 is not used
    faces = [[0, 1, 2], [0, 1, 3], [1, 0, 4], [2, 2, 1]]
    (folder / "dirty.obj").write_text(
        "".join("v {} {} {}\n".format(*v) for v in vertices)
        + "".join("f {} {} {}\n".format(*(i + 1 for i in face)) for face in faces)
    )
    status, out, _ = run("info", "dirty.obj")
    assert status == 0
    assert rows(out)["defects"][:6] == [
        "1 unreferenced vertex",
        "1 coincident vertex",
        "1 degenerate face",
        "1 duplicate face",
        "2 border edges",
        "1 non-manifold edge",
    ]


def test_info_of_polygons_colors_and_turned_faces(run, folder):
    corners = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), -1).reshape(-1, 3)
    quads = [[0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3], [0, 1, 3, 2], [4, 6, 7, 5]]
    inwards = [quad[::-1] for quad in quads]
    cube = md.Mesh(
        corners, inwards, attributes={"face": {"quality": np.arange(6.0)}}, winding="keep"
    )
    write_mesh("cube.ply", cube, colors=np.zeros((8, 3), np.uint8))
    status, out, err = run("info", "cube.ply")
    assert (status, err) == (0, [])  # what is turned is a row, not a note
    found = rows(out)
    assert found["faces"] == ["6 polygons (12 triangles)"]
    assert found["vertex data"] == ["red, green, blue"]
    assert found["face data"] == ["quality"]
    assert found["defects"] == ["winding of 12 faces was turned: the mesh was inside out"]
    assert found["box"] == ["x 0 … 1  y 0 … 1  z 0 … 1"]


def test_info_shows_how_a_file_was_baked(run, ball_ply):
    run("bake", "ball.ply", "-m", "lambert", "--light", "east")
    _, out, _ = run("info", "ball-lambert.ply")
    assert "method: lambert" in rows(out)["baked"]
    assert any(line.startswith("light: east") for line in rows(out)["baked"])


def test_info_of_several_goes_on_after_a_failure(run, ball_ply):
    status, out, err = run("info", "gone.ply", "ball.ply", "ball.ply")
    assert (status, err) == (2, ["meshdepict: gone.ply: there is no such file"])
    assert [line for line in out if line[:1].strip()] == ["ball.ply", "ball.ply"]


def test_info_passes_on_notes_about_a_file(run, ball_ply, folder):
    (folder / "more.ply").write_bytes((folder / "ball.ply").read_bytes() + b"something else")
    status, _, (note,) = run("info", "more.ply")
    assert status == 0
    assert note.startswith("meshdepict: note: more.ply goes on after")
    assert run("info", "more.ply", "--quiet")[2] == []


def test_predictions_grow_with_the_mesh_and_shrink_with_threads():
    small, large = samples.sphere(100), samples.sphere(10_000)
    threads.limit(1)
    (seconds, size), (more_seconds, more_size) = report.predicted(small), report.predicted(large)
    assert seconds < more_seconds
    assert size < more_size
    threads.limit(2)
    assert report.predicted(large)[0] < more_seconds


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.52, "0.5 s"), (42.4, "42 s"), (119.0, "119 s"), (600.0, "10 min")]
)
def test_durations_read_well(seconds, text):
    assert report._duration(seconds) == text


@pytest.mark.parametrize(("size", "text"), [(160e6, "160 MB"), (2.34e9, "2.3 GB")])
def test_sizes_read_well(size, text):
    assert report._bytes(size) == text


def test_info_of_real_scans(run, data):
    """Counts as measured independently, in the data's own manifest."""
    status, out, _ = run("info", data / "mesh" / "dragon_203k.ply")
    found = rows(out)
    assert status == 0
    assert found["vertices"] == ["100,250"]
    assert found["faces"] == ["202,520 triangles"]
    assert found["parts"] == ["7"]
    assert found["defects"][:3] == [
        "43 unreferenced vertices",
        "1,489 duplicate faces",
        "2,534 non-manifold edges",
    ]


def test_info_explains_what_a_method_computes(run, ball_ply):
    status, out, err = run("info", "ball.ply", "--explain", "normal_enhancement")
    assert (status, err) == (0, [])
    assert out[0] == "normal_enhancement of ball.ply"
    assert out[1].split() == ["seconds", "of", "a", "core", "memory"]
    normals = [line for line in out if line.startswith("  normals")]
    assert len(normals) == 5
    assert [line.count("on the way") for line in normals] == [1, 1, 1, 1, 0]
    assert f"{ball_ply.edge_length:.4g}" in normals[0]
    assert any(line.startswith("  together") for line in out)
    assert not any("left out" in line for line in out)


def test_info_explains_what_is_left_out(run, ball_ply):
    _, out, _ = run("info", "ball.ply", "--explain", "unsharp_masking")
    assert not any(line.startswith("  normals") for line in out)
    assert sum(line.startswith("  mean") for line in out) == 1
    assert out[-1] == "  left out: normals of scales 1, 2, 3, 4, 5, which nobody reads"
    words = ("light_alignment", "--set", "strength=.5,.5,0", "--scales", 3)
    _, out, _ = run("info", "ball.ply", "--explain", *words)
    assert out[-1] == "  left out: normals of scale 3, which nobody reads"


def test_info_explains_a_volume(run, folder):
    np.save("ct.npy", samples.ct_phantom((8, 9, 10)).values)
    status, out, _ = run("info", "ct.npy", "--explain", "light_warping", "--transfer", "bone")
    assert status == 0
    assert any("720 voxels" in line for line in out)
    assert sum(line.startswith("  normals") for line in out) == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--explain", "lambrt"], "no method is called 'lambrt'; did you mean 'lambert'?"),
        (["--explain", "exaggerated", "--set", "exageration=3"], "exaggerated has no option"),
        (["--explain", "light_warping", "--set", "scale=3"], "scale=3 is not one of the scale"),
        (["--scales", "3"], "--scales is about a bake: say which method to explain, --explain"),
        (["--set", "amount=3"], "--set is about a bake: say which method to explain, --explain"),
    ],
)
def test_info_refuses_what_it_can_t_explain(run, ball_ply, words, message):
    status, out, (line,) = run("info", "ball.ply", *words)
    assert (status, out) == (2, [])
    assert message in line
