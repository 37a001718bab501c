import sys

import pytest

from meshdepict.baking.recipe import save_recipe
from meshdepict.io.volumes import write_volume
from meshdepict.samples.phantom import ct_phantom

pytest.importorskip("pyvista")


@pytest.fixture
def no_display(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)


@pytest.fixture
def pages(monkeypatch):
    """Sessions that would have been served to a browser."""
    from meshdepict.viewer import browser

    served = []
    for place in (browser, browser.server):  # wherever the command looks: a real one never ends
        monkeypatch.setattr(place, "serve", lambda session, **how: served.append((session, how)))
    return served


def test_a_window_opens_and_ends(run, ball_ply):
    status, out, err = run("view", "ball.ply", "-m", "lambert", "--frames", 2)
    assert (status, out) == (0, [])
    assert err[-1] == "meshdepict: h shows the keys, q closes the window"
    assert run("view", "ball.ply", "-m", "lambert", "--frames", 1, "--quiet") == (0, [], [])


def test_a_volume_opens_the_same_window(run, folder):
    write_volume("head.nrrd", (head := ct_phantom((16, 18, 14))).values, head)
    words = ("view", "head.nrrd", "-m", "lambert", "--frames", 1)
    status, out, err = run(*words)
    assert (status, out) == (0, [])
    assert err[-1] == "meshdepict: h shows the keys, q closes the window"
    assert not [line for line in run(*words, "--quiet")[2] if "keys" in line]
    save_recipe("look.toml", {"method": "phong", "transfer": "skin", "light": "east"})
    assert run("view", "head.nrrd", "--recipe", "look.toml", "--frames", 1)[0] == 0
    assert "the browser shows surfaces alone so far" in wrong(run, "head.nrrd", "--browser")


def test_without_a_file_it_is_the_golf_ball(run, pages):
    assert run("view", "-m", "lambert", "--browser")[0] == 0
    session, how = pages[0]
    assert how["title"] == "golf-ball"
    assert len(session.shape.vertices) > 10_000


def test_a_page_gets_the_look_of_the_command_line(run, ball_ply, pages):
    status, *_ = run(
        "view", "ball.ply", "--browser", "--port", 8123, "--no-open", "-m", "light_alignment",
        "--set", "strength=0.5", "--light", "30,40", "--view", "top", "--up", "z", "--scales", 2,
        "--colormap", "sepia",
    )  # fmt: skip
    assert status == 0
    session, how = pages[0]
    assert how == {"port": 8123, "open_browser": False, "title": "ball"}
    assert session.method == "light_alignment"
    assert session.options == {"strength": 0.5}
    assert session.view.name == "top"
    assert (session.up, session.colormap) == ("z", "sepia")
    assert len(session.space.widths) == 3


def test_a_recipe_is_taken_and_what_is_said_comes_first(run, ball_ply, pages):
    save_recipe("look.toml", {"method": "exaggerated", "exaggeration": 31, "scales": 2})
    assert run("view", "ball.ply", "--browser", "--recipe", "look.toml", "--light", "east")[0] == 0
    session, _ = pages[0]
    assert session.options["exaggeration"] == 31
    assert session.light.name == "east"
    assert len(session.space.widths) == 3


def wrong(run, *words):
    status, out, err = run("view", *words)
    assert status == 2
    assert out == []
    assert len(err) == 1
    return err[0]


def test_without_a_display_one_sentence_says_what_to_do(run, ball_ply, no_display):
    sentence = wrong(run, "ball.ply")
    for word in ("DISPLAY is not set", "--browser", "--picture", "apt install xvfb"):
        assert word in sentence


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("nothing.ply",), "nothing.ply"),
        (("ball.ply", "-m", "exagerated"), "did you mean 'exaggerated'"),
        (("ball.ply", "--set", "exageration=3"), "did you mean 'exaggeration'"),
        (("ball.ply", "--light", "nrth"), "did you mean 'north'"),
        (("ball.ply", "--port", "80"), "--port is about a page: give --browser, too"),
        (("ball.ply", "--no-open"), "--no-open is about a page"),
        (("points.ply", "-m", "lambert"), "face"),
    ],
)
def test_wrong_words_are_one_sentence(run, ball_ply, words, sentence):
    with open("points.ply", "w") as stream:
        stream.write(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
        )
    assert sentence in wrong(run, *words, "--frames", 1)


@pytest.mark.parametrize("setting", [{"albedo": "keep"}, {"colormap2d": "dusk"}])
def test_a_recipe_with_what_the_viewer_has_not_is_refused(run, ball_ply, setting):
    save_recipe("look.toml", {"method": "lambert", **setting})
    sentence = wrong(run, "ball.ply", "--recipe", "look.toml", "--frames", 1)
    assert f"look.toml: views and movies have no {next(iter(setting))}" in sentence
