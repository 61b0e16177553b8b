"""Bad command lines of post, plot, compare and analysis end in one sentence and status 2."""

import pytest
from support import is_line_with

from ehlpetsc.__main__ import main
from ehlpetsc.errors import ExitStatus


def message_of(name, words, capsys):
    """What a command line that argparse refuses prints; it prints nothing else."""
    with pytest.raises(SystemExit) as end:
        main([name, *words])
    assert end.value.code == ExitStatus.BAD_INPUT
    message = capsys.readouterr()
    assert not message.out
    return message.err


@pytest.mark.parametrize("name", ["post", "plot", "summary", "compare", "ensemble", "gears", "explain"])
def test_mistyped_option_is_refused_in_one_line(name, capsys):
    message = message_of(name, ["a.h5", "b.h5", "--deph"], capsys)
    assert is_line_with(message, f"ehlpetsc {name}: ", " --deph;", f"; ehlpetsc {name} -h")


@pytest.mark.parametrize(
    ("name", "words", "what"),
    [
        ("post", ["a.h5", "--count", "all"], ["--count: ", "'all'", "'von_mises'"]),
        ("post", ["a.h5", "--within", "-1"], ["--within -1: ", " 0 "]),
        ("post", [], ["required: RESULT.h5"]),
        ("plot", ["a.h5", "--step", "one"], ["--step: ", "'one'"]),
        ("plot", ["a.h5", "--map", "--movie"], ["--movie: ", " --map;"]),
        ("compare", ["a.h5"], ["required: B.h5"]),
        ("compare", ["a.h5", "b.h5", "--rtol", "-1"], ["--rtol: -1 ", " >= 0;"]),
    ],
)
def test_command_line_fault_is_named(name, words, what, capsys):
    message = message_of(name, words, capsys)
    assert is_line_with(message, f"ehlpetsc {name}: ", *what, f"; ehlpetsc {name} -h")
