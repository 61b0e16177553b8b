"""``mpirun -n N python3 -m ehlpetsc CASE.toml [options]``: run a case; ``-help`` lists the options."""

import sys
import warnings

from ehlpetsc.errors import ExitStatus


def main(argv):
    """Run the command; returns its exit status."""
    from ehlpetsc import environment
    from ehlpetsc.errors import UsageError

    missing = environment.prepare()
    if missing:
        return refuse(environment.advice(missing, argv[1:]))
    if argv[1:2] in (["--keys"], ["--template"]):
        return tell_keys(argv[1:])
    from ehlpetsc.run.command_line import parse_command_line

    try:
        command = parse_command_line(argv[1:])
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")
    if command.explain:
        return explain(command)
    import petsc4py

    petsc4py.init([argv[0], *command.petsc])
    from ehlpetsc.run.command import run

    return run(command.case, command.overrides)


def tell_keys(words):
    """Print every key of a case file, of one table, or a commented case."""
    from ehlpetsc.case import key_page
    from ehlpetsc.environment import first_rank
    from ehlpetsc.errors import UsageError

    try:
        text = key_page.template() if words[0] == "--template" else key_page.keys(*words[1:2]) + "\n"
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")
    if first_rank():
        print(text, end="")
    return ExitStatus.DONE


def explain(command):
    """Print the scene in words."""
    from ehlpetsc.case.loading import load
    from ehlpetsc.environment import first_rank
    from ehlpetsc.errors import CaseError
    from ehlpetsc.run.describe import explain as words

    try:
        text = words(load(command.case, command.overrides))
    except CaseError as error:
        return refuse("\n".join(error.faults))
    if first_rank():
        print(text)
    return ExitStatus.DONE


def refuse(text):
    """Say once, not on every rank, what is wrong; bad input."""
    from ehlpetsc.environment import first_rank

    if first_rank():
        print(text, file=sys.stderr, flush=True)
    return ExitStatus.BAD_INPUT


def guarded(argv):
    """Run `main`; an unexpected error on one rank ends all of them, with its traceback."""
    if not sys.warnoptions:  # those of numpy are for developers: python3 -W default shows them
        warnings.simplefilter("ignore")
    try:
        return main(argv)
    except SystemExit:
        raise
    except BaseException:  # any other way out would leave the other ranks waiting for ever
        import traceback

        traceback.print_exc()
        sys.stdout.flush()
        sys.stderr.flush()
        if "mpi4py.MPI" in sys.modules:
            mpi = sys.modules["mpi4py.MPI"]
            if mpi.COMM_WORLD.size > 1:
                mpi.COMM_WORLD.Abort(ExitStatus.BUG)
        return ExitStatus.BUG


if __name__ == "__main__":
    sys.exit(guarded(sys.argv))
