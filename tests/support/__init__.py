"""What tests of several folders share: where the project lies, and how a command refuses."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"


def refused(capsys, command, *words):
    """Error output of a command, called in process, that ends with exit status 2.

    Parameters
    ----------
    capsys
        Of pytest.
    command : callable
        Of a list of words, to an exit status.
    *words
        Arguments of the command.

    Returns
    -------
    str
    """
    capsys.readouterr()
    assert command([str(word) for word in words]) == 2
    said = capsys.readouterr().err
    assert said and "Traceback" not in said
    return said
