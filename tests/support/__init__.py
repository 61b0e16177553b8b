"""Paths of the project, and checks of messages and refused commands."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
COARSE_LIFE = ROOT / "tests" / "data" / "coarse_life.toml"


def is_line_with(text, *parts):
    """Whether a text is one line that contains all these keys, names and figures."""
    return text.strip().count("\n") == 0 and all(str(part) in text for part in parts)


def roelands_oil(viscosity, pressure_viscosity, **more):
    """Keys of an oil by Roelands, with the density of Dowson and Higginson."""
    laws = {"law": "roelands", "density": "dowson-higginson"}
    return laws | {"viscosity": viscosity, "pressure_viscosity": pressure_viscosity} | more


def self_affine(sq, roll_off, short_cutoff):
    """Keys of a synthetic surface of Hurst exponent 0.8, by the first seed."""
    waves = {"sq": sq, "roll_off": roll_off, "short_cutoff": short_cutoff}
    return {"kind": "self-affine", "hurst": 0.8, "seed": 1} | waves


def optional(name):
    """A package of PyPI that single tests compare with; without it they are skipped."""
    import pytest  # of which benchmarks have no need

    return pytest.importorskip(name, reason=f"{name} of PyPI is not installed; .ci/run fetches it")


def one_fault(call, *arguments):
    """The one fault, a line, of a case that a call refuses."""
    import pytest

    from ehlpetsc.base.errors import CaseError

    with pytest.raises(CaseError) as refusal:
        call(*arguments)
    (fault,) = refusal.value.faults
    assert "\n" not in fault
    return fault


def refused(capsys, command, *words):
    """Error output of a command called in process that must end with exit status 2."""
    capsys.readouterr()
    assert command([str(word) for word in words]) == 2
    message = capsys.readouterr().err
    assert message and "Traceback" not in message
    return message
