"""Bad command lines of post, plot, study, compare and analysis end in one sentence and status 2."""

import importlib

import pytest

from ehlpetsc.errors import ExitStatus, not_written

COMMANDS = {
    "ehlpetsc.post": "ehlpetsc.post.command",
    "ehlpetsc.plot": "ehlpetsc.plot.__main__",
    "ehlpetsc.study": "ehlpetsc.study.__main__",
    "ehlpetsc.compare": "ehlpetsc.analysis.compare",
    "ehlpetsc.analysis.ensemble": "ehlpetsc.analysis.ensemble",
    "ehlpetsc.analysis.collisions": "ehlpetsc.analysis.collisions",
}


def message_of(name, words, capsys):
    """What a command line that argparse refuses prints; it prints nothing else."""
    with pytest.raises(SystemExit) as end:
        importlib.import_module(COMMANDS[name]).main(words)
    assert end.value.code == ExitStatus.BAD_INPUT
    message = capsys.readouterr()
    assert not message.out
    return message.err


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_mistyped_option_is_refused_in_one_line(name, capsys):
    files = ["case.toml"] if name == "ehlpetsc.study" else ["a.h5", "b.h5"]
    assert message_of(name, [*files, "--deph"], capsys) == (
        f"{name}: unrecognized arguments: --deph; python3 -m {name} -h lists the options\n"
    )


@pytest.mark.parametrize(
    ("name", "words", "what"),
    [
        ("ehlpetsc.post", ["a.h5", "--count", "all"], "argument --count: invalid choice: 'all'"),
        ("ehlpetsc.post", ["a.h5", "--within", "-1"], "--within -1: must be 0 or more"),
        ("ehlpetsc.post", [], "the following arguments are required: RESULT.h5"),
        ("ehlpetsc.plot", ["a.h5", "--step", "one"], "argument --step: invalid int value: 'one'"),
        ("ehlpetsc.plot", ["a.h5", "--map", "--movie"], "argument --movie: not allowed with argument --map"),
        ("ehlpetsc.study", [], "which case? CASE.toml, --extremes or --random N"),
        ("ehlpetsc.compare", ["a.h5"], "the following arguments are required: B.h5"),
        ("ehlpetsc.compare", ["a.h5", "b.h5", "--rtol", "-1"], "argument --rtol: -1 is not a number >= 0"),
    ],
)
def test_command_line_fault_is_named(name, words, what, capsys):
    message = message_of(name, words, capsys)
    assert message.startswith(f"{name}: {what}")
    assert message.count("\n") == 1 and message.endswith("lists the options\n")


def test_failed_write_names_its_file():
    full = "No space left on device"
    assert not_written(OSError(28, full, "a.png")) == f"a.png: not written, {full}"
    assert not_written(OSError(28, full), "a.h5") == f"a.h5: not written, {full}"
    assert not_written(OSError("no room"), "a.h5") == "a.h5: not written, no room"
    assert not_written(OSError("no room")) == "no room"
