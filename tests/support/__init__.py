"""What tests of several folders share: paths of the project, what a message holds, how a command refuses."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"


def is_line_with(text, *parts):
    """Whether a text is one line that holds all of these keys, names and figures, in whatever words."""
    return text.strip().count("\n") == 0 and all(str(part) in text for part in parts)


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
