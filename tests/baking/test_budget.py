"""A budget takes the best accuracy that is predicted to fit, and says what it predicted."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pytest

import meshdepict as md
from meshdepict import samples
from meshdepict.baking import budget, machine
from meshdepict.baking.accuracy import ACCURACIES
from meshdepict.baking.budget import predicted_steps, predicted_time, within_budget
from meshdepict.baking.time_limits import as_seconds
from meshdepict.errors import MeshdepictError, MeshdepictWarning

BALL = samples.golf_ball(600)
RANK = {name: place for place, name in enumerate(ACCURACIES)}


@pytest.mark.parametrize(
    ("given", "seconds"),
    [("2s", 2), ("500ms", 0.5), ("1min", 60), ("1.5 s", 1.5), (3, 3), (0.25, 0.25), ("4", 4)],
)
def test_times_in_words(given, seconds):
    assert as_seconds(given) == pytest.approx(seconds)


@pytest.mark.parametrize(
    "given", ["soon", "2 days", "-1s", "0", "", "1.2.3s", 0, -1, float("nan"), float("inf"), [2]]
)
def test_what_is_no_time_is_refused(given):
    with pytest.raises(MeshdepictError, match="is no time"):
        md.Look(budget=given)


def chosen(seconds, look, shape=BALL):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshdepictWarning)
        return within_budget(look.replace(budget=seconds), shape)


@pytest.mark.parametrize("method", ["exaggerated", "sky_view", "ambient_occlusion", "lambert"])
def test_a_larger_budget_is_never_less_accurate(method):
    look = md.Look(method)
    ranks = [RANK[chosen(s, look)[1].accuracy] for s in np.geomspace(1e-6, 1e6, 40)]
    assert ranks == sorted(ranks)
    assert (ranks[0], ranks[-1]) == (RANK["draft"], RANK["reference"])


def test_what_fits_is_within_the_budget_and_what_is_better_is_not():
    look = md.Look("sky_view")
    times = {a: predicted_time(predicted_steps(BALL, look.replace(accuracy=a))) for a in ACCURACIES}
    assert times["draft"] < times["normal"] < times["reference"]
    for accuracy, seconds in times.items():
        found, said = chosen(seconds * (1 + 1e-9), look)
        assert said.accuracy == found.accuracy == accuracy
        assert said.seconds <= said.allowed


def test_spent_seconds_count():
    look = md.Look("sky_view", budget=100)
    assert within_budget(look, BALL, spent=0)[1].accuracy == "reference"
    with pytest.warns(MeshdepictWarning, match="even draft .* 1e\\+02 s are gone already"):
        assert within_budget(look, BALL, spent=101)[1].accuracy == "draft"


def test_a_bake_is_that_of_the_accuracy_and_says_so():
    baked = md.bake(BALL, "sky_view", budget="1h")
    same = md.bake(BALL, "sky_view", accuracy="reference")
    assert np.array_equal(baked.colors, same.colors)
    assert baked.look.accuracy == "reference"
    assert baked.look.budget is None
    assert "predicted of 3.6e+03 s" in baked.provenance["budget"]
    assert baked.look.options == same.look.options


def test_what_is_said_wins_over_a_budget():
    baked = md.bake(BALL, "sky_view", budget="1h", rays=7, tolerance=1e-4)
    assert baked.look.options["rays"] == 7
    assert baked.look.tolerance == 1e-4


@pytest.mark.parametrize(
    ("method", "help_"), [("sky_view", "fewer rays"), ("exaggerated", "scales"), ("lambert", "")]
)
def test_where_even_draft_does_not_fit_it_is_taken_and_said(method, help_, monkeypatch):
    monkeypatch.setattr(budget.costs, "loading_seconds", lambda *_, **__: 0.0)
    tones = {"base": 1.0, "exaggeration": 15.0, "contrast": 1.0}
    look = md.Look(method, budget=1e-9, **(tones if method == "exaggerated" else {}))
    with pytest.warns(MeshdepictWarning, match=f"even draft is predicted to take .*{help_}"):
        assert within_budget(look, BALL)[0].accuracy == "draft"


def test_a_budget_and_an_accuracy_exclude_each_other():
    with pytest.raises(MeshdepictError, match="give one of them"):
        md.Look(budget=2, accuracy="draft")


def test_every_kind_of_shape_has_a_budget(tmp_path):
    heights = md.HeightField(np.add.outer(np.arange(30.0), np.arange(40.0)))
    phantom = samples.ct_phantom((12, 12, 12))
    assert md.bake(heights, budget="1h").look.accuracy == "reference"
    assert md.bake_volume(phantom, budget="1h").look.accuracy == "reference"
    assert md.bake_texture(samples.sphere(12), size=64, budget="1h").look.accuracy == "reference"
    for baked in md.bake_together([BALL, samples.sphere(40)], "lambert", budget="1h"):
        assert baked.look.accuracy == "reference"
        assert "budget" in baked.provenance
    assert md.bake(BALL, "lambert", ground="matt", budget="1h").look.accuracy == "reference"


def test_a_budget_of_relief(tmp_path):
    from meshdepict.baking.relief import Relief

    heights = md.HeightField(np.add.outer(np.arange(30.0), np.arange(40.0)))
    relief = Relief(heights, md.Look("sky_view", budget="1h"))
    assert relief.look.options["rays"] == 4096
    assert relief.provenance["budget"].startswith("reference")


def test_what_keeps_its_scale_spaces_has_none():
    with pytest.raises(MeshdepictError, match="budget is for bakes"):
        md.plate([BALL], budget=2)


def test_a_recipe_of_a_budget_leaves_the_numbers_open(tmp_path):
    path = md.Look("sky_view", budget="1h").save(tmp_path / "look.toml")
    assert md.Look.load(path).bake(BALL).look.options["rays"] == 4096
    path = md.Look("sky_view", budget="1h", rays=256).save(tmp_path / "said.toml")
    assert md.Look.load(path).bake(BALL).look.options["rays"] == 256


def test_a_command_prints_what_it_predicted(run, tmp_path):
    status, out, _ = run("bake", "-o", str(tmp_path / "out.ply"), "--budget", "1h", "-m", "lambert")
    assert status == 0
    assert "reference, " in out[0]
    assert "s predicted of 3.6e+03 s allowed" in out[0]


def test_explanations_name_the_accuracy(run, tmp_path):
    md.bake(BALL, "lambert").save(tmp_path / "ball.ply")
    for words in (["--budget", "1h"], ["--accuracy", "draft"]):
        status, out, _ = run("info", "--explain", "sky_view", str(tmp_path / "ball.ply"), *words)
        assert status == 0
        rays = "4096" if "1h" in words else "64"
        assert any(f"{rays} of each sample" in line for line in out)


# --- the machine -----------------------------------------------------------------------------


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    machine.speed.cache_clear()
    yield
    machine.speed.cache_clear()


def test_the_machine_is_measured_once(cache, monkeypatch):
    first = machine.speed()
    machine.speed.cache_clear()
    monkeypatch.setattr(machine, "measured_seconds", lambda: 1 / 0)
    assert machine.speed() == first


@pytest.mark.parametrize("spoiled", [b"", b"nonsense", b"[1]", b'{"machine": 3}', b"\xff"])
def test_a_spoiled_measurement_is_made_again(cache, spoiled, monkeypatch):
    assert machine.keep("speed.json", spoiled)
    monkeypatch.setattr(machine, "measured_seconds", lambda: 1e-3)
    assert machine.speed() == pytest.approx(machine._REFERENCE_SECONDS / 1e-3)


def test_another_machines_measurement_is_not_taken(cache, monkeypatch):
    machine.keep("speed.json", json.dumps({"machine": "another", "seconds": 5.0}).encode())
    monkeypatch.setattr(machine, "measured_seconds", lambda: 1e-3)
    assert machine.speed() == pytest.approx(machine._REFERENCE_SECONDS / 1e-3)


def test_a_machine_twice_as_fast_halves_predictions(monkeypatch):
    steps = {}
    for times in (1.0, 2.0):
        monkeypatch.setattr("meshdepict.baking.plan.speed", lambda times=times: times)
        monkeypatch.setattr("meshdepict.baking.budget.speed", lambda times=times: times)
        steps[times] = predicted_time(predicted_steps(BALL, md.Look("sky_view"), writes=True))
    assert steps[1.0] == pytest.approx(2 * steps[2.0])


def test_the_same_bits_however_fast_the_machine_is(monkeypatch):
    usual = md.bake(BALL).colors
    monkeypatch.setattr("meshdepict.baking.plan.speed", lambda: 100.0)
    assert np.array_equal(md.bake(BALL).colors, usual)
