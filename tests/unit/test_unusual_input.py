"""Unusual input: empty names, bytes that are no text, devices, numbers out of range."""

import pytest
from support.made_results import make_result

from ehlpetsc.__main__ import main
from ehlpetsc.analysis import ensemble
from ehlpetsc.case.loading import load, members
from ehlpetsc.errors import CaseError
from ehlpetsc.run.explain import explain

STRIBECK = "cases/stribeck.toml"
NO_TEXT = "a\udcffb"  # a byte that is no UTF-8, as the command line hands it on


@pytest.fixture(autouse=True)
def at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


@pytest.mark.parametrize(
    "words",
    [
        [""],
        ["explain", ""],
        ["cases/dry_hertz.toml", "-ehl_set", f"title={NO_TEXT}"],
        ["cases/dry_hertz.toml", "-ehl_output", f"{NO_TEXT}.h5"],
        ["cases/dry_hertz.toml", "-ksp_type", NO_TEXT],
        ["explain", "/dev/zero"],
        ["explain", "cases"],
    ],
)
def test_unusual_input_is_refused_in_one_line(capfd, words):
    assert main(words) == 2
    message = capfd.readouterr().err
    assert message.count("\n") == 1 and ": " in message


@pytest.mark.parametrize(
    "words",
    [["--resamples", "0"], ["--resamples", "-1"], ["--resamples", "1e3"], ["--seed", "-1"], ["--seed", ""]],
)
def test_bootstrap_numbers_have_ranges(tmp_path, capsys, words):
    with pytest.raises(SystemExit) as ended:
        ensemble.main([str(make_result(tmp_path / "one.h5")), *words])
    assert ended.value.code == 2 and words[0] in capsys.readouterr().err


@pytest.mark.parametrize("title", ["\ud800", NO_TEXT])
def test_non_text_title_is_refused(title):
    with pytest.raises(CaseError, match=": title = "):
        load("cases/dry_hertz.toml", {"title": title})


def test_film_bound_belongs_to_direct_contact():
    assert load("cases/ridge.toml", {"contact.minimum_film": 1e-9}).contact.minimum_film == 1e-9
    with pytest.raises(CaseError, match=r'contact\.minimum_film = 1e-09: .*contact\.model = "direct"'):
        load("cases/running_in.toml", {"contact.minimum_film": 1e-9})


def test_series_has_at_most_ten_thousand_members():
    with pytest.raises(CaseError, match="series: 10001 members; .* 10000$"):
        load(STRIBECK, {"series.values": [0.1 + 1e-4 * k for k in range(10_001)]})


def test_members_of_a_long_series_have_texts_of_their_own():
    case = load(STRIBECK, {"series.values": [round(0.1 + 1e-3 * k, 3) for k in range(200)]})
    assert "A series" in explain(case)
    text = members(case)[-1][1].text
    assert "entrainment_speed = 0.299" in text and "[series]" not in text


def test_hint_never_repeats_the_given_value(tmp_path):
    (tmp_path / "dent.toml").mkdir()
    with pytest.raises(CaseError) as refused:
        load(tmp_path / "dent.toml")
    assert "did you mean" not in str(refused.value)
