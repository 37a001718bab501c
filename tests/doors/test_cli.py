"""The command line: help, one line per error, and interruptions that leave nothing behind."""

import os
import subprocess
import sys

import pytest
from conftest import PATIENCE

import meshdepict as md
from meshdepict.baking import batch, method_list

# --- help -----------------------------------------------------------------------------------------


COMMANDS = ("bake", "batch", "view", "compare", "volume", "plate", "movie", "info", "methods")


@pytest.mark.parametrize("words", [(), ("--help",), ("-h",), ("help",)])
def test_help_says_a_line_of_every_command(run, words):
    status, out, err = run(*words)
    assert (status, err) == (0, [])
    lines = [line.strip("│ ").split(maxsplit=1) for line in out]
    said = [line for line in lines if line and line[0] in COMMANDS]
    assert [name for name, _ in said] == list(COMMANDS)
    for _, line in said:
        assert line.endswith(".")  # whole, not cut at the frame


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_by_either_word(run, command):
    assert run("help", command) == run(command, "--help")
    assert f"Usage: meshdepict {command} " in run("help", command)[1][0]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_learn_the_commands(tmp_path, shell):
    place = {"HOME": str(tmp_path), "SHELL": f"/bin/{shell}", "PATH": os.environ["PATH"]}
    command = [sys.executable, "-m", "meshdepict", "--install-completion"]
    done = subprocess.run(
        command, env=place, capture_output=True, text=True, timeout=PATIENCE, check=True
    )
    assert "Traceback" not in done.stderr
    written = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert any("volume" in path.read_text() for path in written)


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


@pytest.mark.parametrize("words", [("--version",), ("-V",), ("bake", "--version")])
def test_version(run, words):
    assert run(*words) == (0, [md.__version__], [])


# --- light paths ----------------------------------------------------------------------------------

HEAVY = {"pyvista", "vtkmodules", "igl", "trimesh", "matplotlib"}


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        ("--version", HEAVY | {"scipy", "numba"}),
        ("methods", HEAVY | {"scipy", "numba", "rich"}),
        ("bake ball.ply", HEAVY | {"rich", "PIL"}),
    ],
)
def test_light_commands_load_no_heavy_modules(ball_ply, words, heavy):
    code = (
        "import sys; from meshdepict.cli import main; "
        f"assert main({words.split()!r}) == 0; print(*{heavy!r} & {{*sys.modules}})"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    assert done.stdout.splitlines()[-1] == ""


# --- errors ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("bak", 'unknown command "bak". Did you mean "bake"?'),
        ("ball.ply", "no command is called 'ball.ply'; did you mean: meshdepict bake ball.ply"),
        ("--quiet bake", "unknown option --quiet: options follow the command"),
        ("bake ball.ply --ligth north", "Did you mean"),
        (
            "bake ball.ply --exageration 25",
            "Did you mean --set exaggeration=?",
        ),
        ("bake ball.ply -m light_alignment --sharpnes=2", "Did you mean --set sharpness=?"),
        ("bake ball.ply -m nonsense --sharpnes=2", "unknown option: --sharpnes"),
        (
            "bake ball.ply --strenght 1",
            "Did you mean --set strength=, which light_alignment has? (s",
        ),
        ("bake ball.ply --scale 4", "Did you mean --scales?"),
        ("plate ball.ply -m light_warping -m lambert --magntude 4", "mean --set magnitude=? (see"),
        ("bkae ball.ply", 'unknown command "bkae". Did you mean "bake"? (see meshdepict --help)'),
        ("bake ball.ply --gamma 4", "unknown option: --gamma"),
        ("bake ball.ply --qqqq 1", "unknown option: --qqqq (see meshdepict bake --help)"),
        ("info ball.ply --exageration 25", "unknown option: --exageration"),
        ("info ball.ply --explain toon --sharpnes 2", "Did you mean --set sharpness=? (see"),
        ("bake ball.ply --light 30,120", "a light's elevation is from -90"),
        ("bake ball.ply --picture out.png --unit parsec", "unit='parsec' is no length"),
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
        ("bake ball.ply --up w", "--up"),
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
        ("bake ball.ply ball.ply -o out", "end the name with / and it is made"),
        ("bake ball.ply -o out", "a folder ends with /"),
        ("bake ball.ply -o out.png", "a picture of them beside that: --picture out.png"),
        ("bake ball.ply -o out.PDF", "a picture of them beside that: --picture out.PDF"),
        ("bake ball.ply -o ball.ply/", "-o ball.ply/: the folder can't be made"),
        ("bake ball.ply -o new/out.ply", "there is no folder new"),
        ("bake ball.ply --picture out.tif", "end the name with .png"),
        ("bake ball.ply --picture new/out.png", "there is no folder new"),
        ("bake ball.ply --picture out.png --size 300", "size '300' is not WIDTHxHEIGHT"),
        ("bake ball.ply --picture out.png --size 0x10", "a picture of 0x10 pixels"),
        ("bake ball.ply ball.ply -o out.ply", "-o out.ply is no existing folder"),
        ("bake ball.ply ball.ply --picture p.png", "--picture p.png is no existing folder"),
        ("bake gone.ply", "gone.ply: there is no such file"),
        ("bake .", ". is a folder, not a file; did you mean ball.ply?"),
        ("bake ..", ".. is a folder, not a file; there is no mesh in it"),
        ("methods exagerated", "did you mean 'exaggerated'?"),
        ("info", "info needs a mesh file"),
        ("info gone.ply", "gone.ply: there is no such file"),
    ],
)
def test_wrong_input_is_one_line_and_status_2(run, ball_ply, folder, words, sentence):
    before = sorted(folder.iterdir())
    status, out, err = run(*words.split())
    assert (status, out) == (2, [])
    (line,) = err
    assert line.startswith("meshdepict: ")
    assert sentence in line
    assert sorted(folder.iterdir()) == before


def test_a_former_bake_s_colors_are_no_albedo(run, ball_ply):
    run("bake", "ball.ply", "-o", "baked.ply")
    status, _, (line,) = run("bake", "baked.ply", "--albedo", "keep", "-o", "again.ply")
    assert status == 2
    assert "the mesh has only those of a former bake" in line


def test_a_forbidden_folder_is_refused_before_the_work(run, ball_ply, monkeypatch):
    monkeypatch.setattr(batch.os, "access", lambda *_: False)
    status, _, (line,) = run("bake", "ball.ply")
    assert status == 2
    assert line == "meshdepict: ball-exaggerated.ply can't be written: . may not be written to"


def test_the_system_s_errors_are_one_line_too(run, monkeypatch):
    def refuse():
        raise PermissionError(13, "Permission denied", "/etc/secret")

    monkeypatch.setattr(method_list, "methods", refuse)
    assert run("methods") == (2, [], ["meshdepict: /etc/secret: Permission denied"])


def test_out_of_memory_anywhere_is_one_line(run, monkeypatch):
    def exhaust():
        raise MemoryError

    monkeypatch.setattr(method_list, "methods", exhaust)
    assert run("methods") == (2, [], ["meshdepict: out of memory"])


# --- interruptions --------------------------------------------------------------------------------


def test_ctrl_c_leaves_the_earlier_file_whole(run, ball_ply, folder, monkeypatch):
    assert run("bake", "ball.ply", "-o", "out.ply")[0] == 0
    before = (folder / "out.ply").read_bytes()

    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(md.Baked, "comments", property(interrupt))  # while it is written
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
    assert process.communicate(timeout=PATIENCE)[1] == b""
    assert process.returncode == 128 + 13  # as shells count: SIGPIPE


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full on this system")
def test_a_full_disk_behind_stdout_is_one_line():
    with open("/dev/full", "w") as full:
        process = start("methods", stdout=full)
        (line,) = process.communicate(timeout=PATIENCE)[1].splitlines()
    assert process.returncode == 2
    assert line.startswith(b"meshdepict: the output: ")
