"""Unusual input: empty names, bytes that are no text, devices, numbers out of range."""

import pytest

from ehlpetsc.__main__ import main
from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError

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


def test_film_bound_belongs_to_direct_contact():
    assert load("cases/ridge.toml", {"contact.minimum_film": 1e-9}).contact.minimum_film == 1e-9
    with pytest.raises(CaseError, match=r'contact\.minimum_film = 1e-09: .*contact\.model = "direct"'):
        load("cases/running_in.toml", {"contact.minimum_film": 1e-9})


def test_series_has_at_most_ten_thousand_members():
    with pytest.raises(CaseError, match="series: 10001 members; .* 10000$"):
        load(STRIBECK, {"series.values": [0.1 + 1e-4 * k for k in range(10_001)]})
