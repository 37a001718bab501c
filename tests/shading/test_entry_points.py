"""Methods of other packages: found by their entry points, loaded when asked for."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import meshdepict as md
from meshdepict.shading.entry_points import Methods
from meshdepict.shading.registry import OWN

ROOT = Path(__file__).resolve().parents[2]

STRIPES = '''
import numpy as np
import meshdepict as md


@md.method(source="a package", compared={"count": 3})
def stripes(space, light, *, count: int = 12, exposure: float = 1.0):
    """Shade by height alone: bright and dark in turn."""
    height = space.unit_points[:, 1]
    return np.clip((0.5 + 0.5 * np.sin(2 * np.pi * count * height)) * exposure, 0, 1)
'''


@pytest.fixture
def install(tmp_path):
    """Return a function that installs a package with entry points, as a wheel would be."""

    def install(package, points, code=STRIPES):
        module = package.replace("-", "_")
        (tmp_path / f"{module}.py").write_text(code, encoding="utf-8")
        about = tmp_path / f"{module}-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
        lines = "\n".join(f"{name} = {value}" for name, value in points.items())
        (about / "entry_points.txt").write_text(f"[meshdepict.methods]\n{lines}\n")
        return tmp_path

    return install


@pytest.fixture
def methods(tmp_path, monkeypatch):
    """This package's methods, and those that were installed for a test."""
    monkeypatch.syspath_prepend(str(tmp_path))
    yield Methods(OWN)
    for name in {path.stem for path in tmp_path.glob("*.py")} & set(sys.modules):
        del sys.modules[name]


def test_without_others_there_are_this_packages_alone():
    found = Methods(OWN)
    assert list(found) == list(OWN)
    assert len(found) == len(OWN)
    assert "lambert" in repr(found)


def test_a_method_of_another_package_is_there_when_asked_for(install, methods):
    install("stripy-shading", {"stripes": "stripy_shading:stripes"})
    assert methods["lambert"] is OWN["lambert"]
    assert "stripy_shading" not in sys.modules
    assert "stripes" in methods
    assert "stripy_shading" in sys.modules
    assert list(methods) == [*OWN, "stripes"]
    assert methods["stripes"].declaration.source == "a package"


def test_one_method_is_loaded_without_the_others(install, methods):
    install("stripy-shading", {"stripes": "stripy_shading:stripes", "gone": "nowhere.at:all"})
    assert methods["stripes"].__name__ == "stripes"
    with pytest.warns(md.MeshdepictWarning, match="stripy-shading: its method 'gone'"):
        assert "gone" not in methods
    assert list(methods) == [*OWN, "stripes"]  # it was said once


BROKEN = {
    "an import that fails": (
        "import no_such_package_anywhere",
        r"\(ModuleNotFoundError: No module",
    ),
    "a fault": ("raise RuntimeError('two\\nlines')", r"\(RuntimeError: two lines\)"),
    "an exit": ("import sys\nsys.exit(3)", r"\(SystemExit: 3\)"),
    "nothing of that name": ("", r"\(AttributeError: "),
    "no method": ("def stripes(space, light): ...", "no function declared with md.method"),
    "another name": (STRIPES.replace("def stripes", "def bars") + "\nstripes = bars", "one name"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_method_is_left_out_with_one_note(install, methods, name):
    code, words = BROKEN[name]
    install("odd-shading", {"stripes": "odd_shading:stripes"}, code)
    with pytest.warns(md.MeshdepictWarning, match=rf"^odd-shading: .*'stripes'.*{words}") as found:
        names = list(methods)
    assert names == list(OWN)
    assert "stripes" not in methods
    assert len(found) == 1
    assert "\n" not in str(found[0].message)


def test_a_name_that_is_taken_stays_whose_it_was(install, methods):
    install("a-shading", {"lambert": "a_shading:stripes", "stripes": "a_shading:stripes"})
    install("b-shading", {"stripes": "b_shading:stripes"})
    with pytest.warns(md.MeshdepictWarning, match="is left out") as found:
        assert list(methods) == [*OWN, "stripes"]
    assert methods["lambert"] is OWN["lambert"]
    texts = sorted(str(each.message) for each in found)
    assert len(texts) == 2
    assert "a-shading offers a method 'lambert', a name that is taken" in texts[0]
    assert "-shading offers a method 'stripes', a name that is taken" in texts[1]


def test_methods_can_be_made_known_and_forgotten_by_hand():
    found = Methods(OWN)
    found["mine"] = OWN["lambert"]
    assert list(found)[-1] == "mine"
    del found["mine"]
    assert "mine" not in found
    with pytest.raises(KeyError):
        del found["mine"]


# --- in a program of its own ---------------------------------------------------------------------


@pytest.fixture
def program(install, folder):
    """Return a function that runs Python where a package with stripes is installed."""
    where = install("stripy-shading", {"stripes": "stripy_shading:stripes"})

    def program(*words):
        path = os.pathsep.join([str(where), str(ROOT)])
        done = subprocess.run(
            [sys.executable, *words], capture_output=True, text=True, timeout=600,
            env={**os.environ, "PYTHONPATH": path},
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert "Traceback" not in done.stderr
        return done.stdout

    return program


def test_the_command_line_knows_it(program, ball_ply):
    assert "stripes" in program("-m", "meshdepict", "methods")
    told = program("-m", "meshdepict", "methods", "stripes")
    assert "paper   a package" in told
    assert "count     12       any number" in told
    words = ("bake", "ball.ply", "-m", "stripes", "--set", "count=5", "-o", "out.ply")
    assert "out.ply: stripes" in program("-m", "meshdepict", *words)
    assert "options: count=5 exposure=1" in program("-m", "meshdepict", "info", "out.ply")
    (Path("look.toml")).write_text('method = "stripes"\n[options]\ncount = 5\n')
    words = ("bake", "ball.ply", "--recipe", "look.toml", "-o", "again.ply")
    program("-m", "meshdepict", *words)
    assert Path("again.ply").read_bytes() == Path("out.ply").read_bytes()


def test_compare_session_page_and_accessor_list_it(program):
    code = """
        import pyvista
        import meshdepict as md
        from meshdepict.congruence.comparison import usual_methods
        from meshdepict.viewer.browser.desk import Desk
        from meshdepict.viewer.session import Session
        from meshdepict.viewer.windows.cycle import next_method

        assert "stripes" in usual_methods()
        ball = md.samples.golf_ball(400, dimples=12)
        found = md.compare(ball, ["lambert", "stripes"], lights=["front"], size=(40, 40), scales=1)
        assert found.options[1] == {"count": 3}
        session = Session(ball, "view_curvature")
        assert next_method(session, 1) == []
        assert session.method == "stripes"
        look = Desk(session, "ball").look()
        assert look["methods"][-1] == look["method"] == "stripes"
        assert [control["name"] for control in look["controls"]] == ["count", "exposure"]
        poly = md.bake(ball, "lambert").to_pyvista()
        assert "depict_stripes" in poly.depict.stripes(count=3).point_data
        """
    program("-c", textwrap.dedent(code))
