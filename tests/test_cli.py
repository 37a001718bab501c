"""The command line: what it writes, what it refuses to overwrite, and one line per error."""

import io
import os
import signal
import subprocess
import sys
import warnings

import numpy as np
import pytest

import meshdepict as md
from meshdepict import batch, console, report, samples, threads
from meshdepict.cli import main
from meshdepict.io import read_mesh, read_provenance, write_mesh
from meshdepict.options import options_of
from meshdepict.shading import METHODS, declaration


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """An empty current folder; a setting of one test is not the next one's."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    yield tmp_path
    threads.limit(None)


@pytest.fixture
def ball(folder):
    """A small mesh in ball.ply."""
    mesh = samples.golf_ball(400, dimples=12)
    write_mesh("ball.ply", mesh)
    return mesh


@pytest.fixture
def run(capsys):
    """Run a command line; return its status and the lines on stdout and stderr."""

    def run(*words):
        status = main([str(word) for word in words])
        out, err = capsys.readouterr()
        assert "\x1b" not in out + err
        assert "Traceback" not in err
        return status, out.splitlines(), err.splitlines()

    return run


def colors(path):
    vertex = read_mesh(path).attributes["vertex"]
    return np.stack([vertex[name] for name in ("red", "green", "blue")], axis=1)


# --- help ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("words", [(), ("--help",), ("-h",)])
def test_help_names_every_command(run, words):
    status, out, err = run(*words)
    assert (status, err) == (0, [])
    for command in ("bake", "methods", "info"):
        assert any(command in line.split() for line in out)


def test_help_of_a_command_explains_every_option(run):
    status, out, _ = run("bake", "--help")
    text = " ".join(out)
    assert status == 0
    for option in (
        "--method", "-m", "--output", "-o", "--light", "--view", "--up", "--scales", "--width",
        "--ratio", "--facing", "--tolerance", "--set", "--colormap", "--albedo", "--picture",
        "--size", "--winding", "--fix-winding", "--force", "--quiet", "--threads",
    ):  # fmt: skip
        assert f" {option} " in text


@pytest.mark.parametrize("words", [("--version",), ("bake", "--version")])
def test_version(run, words):
    assert run(*words) == (0, [md.__version__], [])


# --- methods ------------------------------------------------------------------------------------


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
    assert "no options" in report.method("flat")


# --- bake: results ------------------------------------------------------------------------------


def test_bake_writes_the_colors_of_the_library(run, ball):
    status, _, err = run("bake", "ball.ply")
    assert (status, err) == (0, [])
    baked = md.bake(ball)
    assert np.array_equal(colors("ball-exaggerated.ply"), baked.colors)
    assert read_provenance("ball-exaggerated.ply") == baked.comments


def test_the_closing_line_is_a_caption(run, ball):
    _, (line,), _ = run("bake", "ball.ply", "--width", "0.1")
    assert line.startswith("ball-exaggerated.ply: exaggerated, light northwest, ")
    assert "9 widths 0.1 to 1.6, " in line
    assert float(line.removesuffix(" s").rpartition(" ")[2]) >= 0


def test_the_closing_line_without_scales_has_no_widths(run, ball):
    _, (line,), _ = run("bake", "ball.ply", "-m", "lambert", "--light", "300,20")
    caption = "ball-lambert.ply: lambert, light azimuth 300° elevation 20°, "
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
        (
            ("--set", "exaggeration=40", "--set", "emphasis=-1"),
            {"exaggeration": 40.0, "emphasis": -1.0},
        ),
    ],
)
def test_every_option_of_bake_reaches_the_library(run, ball, words, arguments):
    status, _, err = run("bake", "ball.ply", "-o", "out.ply", *words)
    assert (status, err) == (0, [])
    expected = md.bake(ball, **arguments)
    assert np.array_equal(colors("out.ply"), expected.colors)
    assert read_provenance("out.ply") == expected.comments


def test_without_input_a_golf_ball_is_baked(run, folder, monkeypatch):
    mesh = samples.golf_ball(400, dimples=12)
    monkeypatch.setattr(samples, "golf_ball", lambda: mesh)
    status, (line,), err = run("bake")
    assert (status, err) == (0, [])
    assert line.startswith("golf-ball-exaggerated.ply: exaggerated, ")
    assert np.array_equal(colors("golf-ball-exaggerated.ply"), md.bake(mesh).colors)


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


def test_input_elsewhere_is_baked_into_the_current_folder(run, ball, folder):
    (folder / "sub").mkdir()
    os.rename("ball.ply", "sub/ball.ply")
    assert run("bake", "sub/ball.ply")[0] == 0
    assert [path.name for path in (folder / "sub").iterdir()] == ["ball.ply"]
    assert (folder / "ball-exaggerated.ply").is_file()


@pytest.mark.parametrize("given", ["sub", "sub/", "sub/other.obj"])
def test_output_is_a_file_or_a_folder(run, ball, folder, given):
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


def test_threads_are_limited_for_one_run_only(run, ball, monkeypatch):
    seen = []
    monkeypatch.setattr(batch.Batch, "run", lambda self: seen.append(threads.thread_count()) or 0)
    for words in (("--threads", "1"), (), ("--threads", "3")):
        assert run("bake", "ball.ply", *words)[0] == 0
    threads.limit(None)
    assert seen == [1, threads.thread_count(), 3]


# --- bake: what may be replaced -----------------------------------------------------------------


def test_own_results_are_replaced(run, ball):
    assert run("bake", "ball.ply", "-o", "out.ply", "--light", "east")[0] == 0
    first = colors("out.ply")
    assert run("bake", "ball.ply", "-o", "out.ply", "--light", "west")[0] == 0
    assert not np.array_equal(colors("out.ply"), first)


@pytest.mark.parametrize("content", [b"ply\nsomething", b"", b"words"])
def test_the_files_of_others_are_not_replaced_unless_forced(run, ball, folder, content):
    (folder / "out.ply").write_bytes(content)
    status, out, (line,) = run("bake", "ball.ply", "-o", "out.ply")
    assert (status, out) == (2, [])
    assert line.startswith("meshdepict: out.ply exists and was not written by meshdepict: ")
    assert "--force" in line
    assert (folder / "out.ply").read_bytes() == content
    assert run("bake", "ball.ply", "-o", "out.ply", "--force")[0] == 0
    assert read_provenance("out.ply")


@pytest.mark.parametrize("name", ["out.obj", "out.off", "out.glb", "out.ply.gz"])
def test_own_results_are_known_in_every_format(run, ball, name):
    for light in ("east", "west"):
        assert run("bake", "ball.ply", "-o", name, "--light", light)[0] == 0


def test_an_input_is_not_replaced_unless_forced(run, ball, folder):
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


def test_names_are_checked_before_anything_is_read(run, ball, folder, monkeypatch):
    (folder / "out.ply").write_text("mine")
    monkeypatch.setattr(batch, "read_mesh", lambda *_, **__: pytest.fail("read too early"))
    for words in (("-o", "out.ply"), ("-o", "x.stl"), ("--picture", "x.jpg")):
        assert run("bake", "ball.ply", *words)[0] == 2


# --- bake: several ------------------------------------------------------------------------------


def test_one_failed_file_does_not_stop_the_rest(run, ball, folder):
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


def test_several_are_baked_into_a_folder(run, ball, folder):
    (folder / "out").mkdir()
    write_mesh("second.ply", samples.sphere(42))
    status, out, err = run("bake", "ball.ply", "second.ply", "-o", "out", "--quiet")
    assert (status, len(out), err) == (0, 2, [])
    assert {path.stem for path in (folder / "out").iterdir()} == {
        "ball-exaggerated",
        "second-exaggerated",
    }


def test_two_inputs_never_share_an_output(run, ball, folder):
    write_mesh("ball.obj", samples.sphere(42))
    status, out, err = run("bake", "ball.ply", "ball.obj")
    assert status == 2
    assert len(out) == 1
    assert err == [
        "meshdepict: ball.obj would become ball-exaggerated.ply as ball.ply does: bake it alone",
        "meshdepict: 1 of 2 baked",
    ]
    assert np.array_equal(read_mesh("ball-exaggerated.ply").vertices, ball.vertices)


def test_running_out_of_memory_is_one_file_s_fault(run, ball, folder, monkeypatch):
    write_mesh("second.ply", samples.sphere(42))

    def read(path, **_):
        if path.name == "ball.ply":
            raise MemoryError
        return read_mesh(path)

    monkeypatch.setattr(batch, "read_mesh", read)
    status, out, err = run("bake", "ball.ply", "second.ply")
    assert (status, len(out)) == (2, 1)
    assert err[0].startswith("meshdepict: ball.ply: out of memory")


# --- errors -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("bak", 'unknown command "bak". Did you mean "bake"?'),
        ("ball.ply", "no command is called 'ball.ply'; did you mean: meshdepict bake ball.ply"),
        ("--quiet bake", "unknown option --quiet: options follow the command"),
        ("bake ball.ply --ligth north", "Did you mean"),
        ("bake ball.ply --light", "requires an argument (see meshdepict bake --help)"),
        ("bake ball.ply --scales 2 --scales 3", "specified multiple times"),
        ("bake ball.ply --scales 1.5", "'1.5' is not a whole number"),
        ("bake ball.ply --scales 100", "scales=100 is not a whole number from 0 to 64"),
        ("bake ball.ply --scales 0", "needs at least one scale"),
        ("bake ball.ply --ratio 1,7", "'1,7' is not a number"),
        ("bake ball.ply --ratio 1", "ratio=1.0 is not"),
        ("bake ball.ply --tolerance nan", "tolerance=nan is not"),
        ("bake ball.ply --width -1", "width='-1' is not a positive length"),
        ("bake ball.ply --width wide", "width='wide' is not a positive length"),
        ("bake ball.ply --facing 2", "--facing"),
        ("bake ball.ply --up x", "--up"),
        ("bake ball.ply --albedo maybe", "--albedo"),
        ("bake ball.ply --winding fix", "--winding"),
        ("bake ball.ply --light nroth", "no light is called 'nroth'; did you mean 'north'?"),
        ("bake ball.ply --light 1,2,3,4", "--light 1,2,3,4 is neither a name"),
        ("bake ball.ply --light 1,x", "--light 1,x is neither a name"),
        ("bake ball.ply --light 0,0,0", "not all zero"),
        ("bake ball.ply --view fornt", "did you mean 'front'?"),
        ("bake ball.ply --colormap seppia", "did you mean 'sepia'?"),
        ("bake ball.ply -m exagerated", "did you mean 'exaggerated'?"),
        ("bake ball.ply --set exaggeration", "--set wants name=value, not 'exaggeration'"),
        ("bake ball.ply --set exageration=4", "did you mean 'exaggeration'?"),
        ("bake ball.ply --set exaggeration=-4", "exaggeration='-4' is not a number in its range"),
        ("bake ball.ply --set light=north", "exaggerated has no option 'light'"),
        ("bake ball.ply --albedo keep", "ball.ply: albedo='keep' needs the object's own"),
        ("bake ball.ply --threads 0", "threads=0 makes no sense"),
        ("bake ball.ply --threads two", "'two' is not a whole number"),
        ("bake ball.ply --fix-winding --winding keep", "give one of them"),
        ("bake ball.ply -o out.stl", "out.stl: colours are saved as .ply, "),
        ("bake ball.ply -o out", "not as a file without suffix"),
        ("bake ball.ply -o new/", "-o new/: there is no such folder; make it first"),
        ("bake ball.ply -o new/out.ply", "there is no folder new"),
        ("bake ball.ply --picture out.jpg", "end the name with .png"),
        ("bake ball.ply --picture new/", "--picture new/: there is no such folder"),
        ("bake ball.ply --picture new/out.png", "there is no folder new"),
        ("bake ball.ply --picture out.png --size 300", "--size 300 is not WIDTHxHEIGHT"),
        ("bake ball.ply --picture out.png --size 0x10", "a picture of 0x10 pixels"),
        ("bake ball.ply ball.ply -o out.ply", "-o out.ply is no existing folder"),
        ("bake ball.ply ball.ply --picture p.png", "--picture p.png is no existing folder"),
        ("bake gone.ply", "gone.ply: there is no such file"),
        ("bake .", ". is a folder, not a file"),
        ("methods exagerated", "did you mean 'exaggerated'?"),
        ("info", "info needs a mesh file"),
        ("info gone.ply", "gone.ply: there is no such file"),
    ],
)
def test_wrong_input_is_one_line_and_status_2(run, ball, folder, words, sentence):
    before = sorted(folder.iterdir())
    status, out, err = run(*words.split())
    assert (status, out) == (2, [])
    (line,) = err
    assert line.startswith("meshdepict: ")
    assert sentence in line
    assert sorted(folder.iterdir()) == before


def test_a_former_bake_s_colors_are_no_albedo(run, ball):
    run("bake", "ball.ply", "-o", "baked.ply")
    status, _, (line,) = run("bake", "baked.ply", "--albedo", "keep", "-o", "again.ply")
    assert status == 2
    assert "the mesh has only those of a former bake" in line


def test_a_forbidden_folder_is_refused_before_the_work(run, ball, monkeypatch):
    monkeypatch.setattr(batch.os, "access", lambda *_: False)
    status, _, (line,) = run("bake", "ball.ply")
    assert status == 2
    assert line == "meshdepict: ball-exaggerated.ply can't be written: . may not be written to"


def test_the_system_s_errors_are_one_line_too(run, monkeypatch):
    def refuse():
        raise PermissionError(13, "Permission denied", "/etc/secret")

    monkeypatch.setattr(report, "methods", refuse)
    assert run("methods") == (2, [], ["meshdepict: /etc/secret: Permission denied"])


def test_out_of_memory_anywhere_is_one_line(run, monkeypatch):
    def exhaust():
        raise MemoryError

    monkeypatch.setattr(report, "methods", exhaust)
    assert run("methods") == (2, [], ["meshdepict: out of memory"])


# --- interruptions ------------------------------------------------------------------------------


def test_ctrl_c_leaves_the_earlier_file_whole(run, ball, folder, monkeypatch):
    assert run("bake", "ball.ply", "-o", "out.ply")[0] == 0
    before = (folder / "out.ply").read_bytes()

    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(md.baking.Baked, "comments", property(interrupt))  # while it is written
    status, out, (line,) = run("bake", "ball.ply", "-o", "out.ply", "--light", "east")
    assert (status, out) == (130, [])
    assert line == "meshdepict: interrupted; no file was left half-written"
    assert (folder / "out.ply").read_bytes() == before
    assert sorted(path.name for path in folder.iterdir()) == ["ball.ply", "out.ply"]


def environment():
    return {name: value for name, value in os.environ.items() if name != "DISPLAY"}


def start(*words, **streams):
    command = [sys.executable, "-m", "meshdepict", *words]
    return subprocess.Popen(command, env=environment(), stderr=subprocess.PIPE, **streams)


def test_a_closed_pipe_is_silent():
    process = start("methods", stdout=subprocess.PIPE)
    process.stdout.close()
    assert process.communicate(timeout=60)[1] == b""
    assert process.returncode == 128 + signal.SIGPIPE


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full on this system")
def test_a_full_disk_behind_stdout_is_one_line():
    with open("/dev/full", "w") as full:
        process = start("methods", stdout=full)
        (line,) = process.communicate(timeout=60)[1].splitlines()
    assert process.returncode == 2
    assert line.startswith(b"meshdepict: the output: ")


# --- messages -----------------------------------------------------------------------------------


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("quiet", [True, False])
def test_long_work_shows_a_bar_on_a_terminal(ball, monkeypatch, capsys, quiet):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(console, "_PATIENCE", 0.0)
    monkeypatch.setattr(batch, "read_mesh", lambda *_, **__: pause(ball))
    assert main(["bake", "ball.ply", *["--quiet"] * quiet]) == 0
    assert ("ball.ply" in terminal.getvalue()) is not quiet
    assert capsys.readouterr().out.startswith("ball-exaggerated.ply: ")


def pause(mesh):
    """Give the bar's thread the time to appear."""
    import time

    time.sleep(0.2)
    return mesh


def test_short_work_shows_no_bar(ball, monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(console, "_PATIENCE", 60.0)
    assert main(["bake", "ball.ply"]) == 0
    assert terminal.getvalue() == ""


def test_the_warnings_of_others_stay_away(run, ball, monkeypatch):
    def read(path, **_):
        warnings.warn("about\nnothing", RuntimeWarning, stacklevel=1)
        warnings.warn("about\nthe mesh", md.MeshdepictWarning, stacklevel=1)
        return read_mesh(path)

    monkeypatch.setattr(batch, "read_mesh", read)
    status, _, err = run("bake", "ball.ply")
    assert (status, err) == (0, ["meshdepict: note: ball.ply: about the mesh"])


def test_a_message_names_its_file_once():
    from pathlib import Path

    path = Path("a")
    assert console.about(path, "a is empty") == "a is empty"
    assert console.about(path, "a: no") == "a: no"
    assert console.about(path, "albedo is missing") == "a: albedo is missing"
    assert console.about(None, "no") == "no"


# --- light paths --------------------------------------------------------------------------------

HEAVY = {"pyvista", "vtkmodules", "igl", "trimesh", "matplotlib"}


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        ("--version", HEAVY | {"scipy", "numba"}),
        ("methods", HEAVY | {"scipy", "numba", "rich"}),
        ("bake ball.ply", HEAVY | {"rich", "PIL"}),
    ],
)
def test_light_commands_load_no_heavy_modules(ball, words, heavy):
    code = (
        "import sys; from meshdepict.cli import main; "
        f"assert main({words.split()!r}) == 0; print(*{heavy!r} & {{*sys.modules}})"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.splitlines()[-1] == ""


# --- info ---------------------------------------------------------------------------------------


def rows(lines):
    """Read the report's columns back: label → texts."""
    found, label = {}, ""
    for line in lines[1:]:
        label = line[2:14].strip() or label
        found.setdefault(label, []).append(line[16:].strip())
    return found


def test_info_counts_a_clean_mesh(run, ball):
    status, out, err = run("info", "ball.ply")
    assert (status, err) == (0, [])
    assert out[0] == "ball.ply"
    found = rows(out)
    assert found["vertices"] == [f"{len(ball.vertices):,}"]
    assert found["faces"] == [f"{len(ball.faces):,} triangles"]
    assert found["parts"] == ["1"]
    assert found["defects"] == ["none"]
    assert found["diagonal"] == [f"{ball.diagonal:.4g}"]
    assert found["edge length"] == [f"{ball.edge_length:.4g} (median)"]
    assert found["default bake"][0].startswith("about ")
    assert not {"vertex data", "face data", "baked"} & set(found)


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


def test_info_shows_how_a_file_was_baked(run, ball):
    run("bake", "ball.ply", "-m", "lambert", "--light", "east")
    _, out, _ = run("info", "ball-lambert.ply")
    assert "method: lambert" in rows(out)["baked"]
    assert any(line.startswith("light: east") for line in rows(out)["baked"])


def test_info_of_several_goes_on_after_a_failure(run, ball):
    status, out, err = run("info", "gone.ply", "ball.ply", "ball.ply")
    assert (status, err) == (2, ["meshdepict: gone.ply: there is no such file"])
    assert [line for line in out if line[:1].strip()] == ["ball.ply", "ball.ply"]


def test_info_passes_on_notes_about_a_file(run, ball, folder):
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
