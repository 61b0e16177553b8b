"""Case files: read as text, parsed as TOML, with validation messages."""

import contextlib
import difflib
import os
import re
import tomllib
from pathlib import Path

from ehlpetsc.errors import CaseError

MAX_PARTS = 50  # of a dotted key: more than any case has
MAX_BYTES = 2**26  # of a case file: far more than any profile written out in it
LONG_KEY = re.compile(rf"""(?<![\w"'.-])(?:[\w"'-]++[ \t]*+\.[ \t]*+){{{MAX_PARTS}}}""")


def read_text(path):
    """Text of a case file.

    Raises
    ------
    CaseError
    """
    if not isinstance(path, str | os.PathLike):  # open takes a number for a file that is open already
        raise CaseError([f"{path!r}: allowed: the name of a TOML file, or a dict of its tables"])
    try:
        if not str(path):
            raise CaseError(["'': no name of a case file; allowed: a TOML file"])
        with open(path, "rb") as file:  # a device has no size, and no end
            whole = file.read(MAX_BYTES + 1)
        if len(whole) > MAX_BYTES:
            raise CaseError([f"{path}: larger than {MAX_BYTES >> 20} MB; allowed: a TOML file of a case"])
        return whole.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CaseError([f"{path}: not UTF-8 text (byte {error.start}); allowed: a TOML file"]) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise CaseError([f"{path}: cannot be read: {reason}{_meant(path)}"]) from None


def _meant(path):
    """Hint at a case file of nearly that name in the same folder."""
    with contextlib.suppress(OSError, ValueError):
        beside = [p.stem for p in Path(path).parent.glob("*.toml") if p.name != Path(path).name]
        close = difflib.get_close_matches(Path(path).stem, beside, n=1)
        if close:
            return f"; did you mean {Path(path).with_name(close[0] + '.toml')}?"
    return ""


def parse_toml(path, text):
    """Tables of a TOML text; `path` names it in faults.

    Raises
    ------
    CaseError
    """
    found = LONG_KEY.search(text)
    if found:  # tomllib takes the square of their number in time
        line = text.count("\n", 0, found.start()) + 1
        raise CaseError([f"{path}: line {line}: a key of more than {MAX_PARTS} parts; allowed: table.key"])
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # tomllib lets some of its number conversions through
        raise CaseError([f"{path}: not valid TOML: {error}{_comma(text, str(error))}"]) from None


def _comma(text, error):
    """Hint at a decimal comma in the line that TOML refuses."""
    line = re.search(r"at line (\d+)", error)
    typed = text.splitlines()[int(line[1]) - 1] if line else ""
    found = re.search(r"=\s*([+-]?\d+),(\d+)", typed)
    return f"; a decimal point, as in {found[1]}.{found[2]}?" if found else ""
