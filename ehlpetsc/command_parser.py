"""Common parser, name in help texts and exit status of all commands except the run."""

import argparse
import re
import sys
from pathlib import Path

from ehlpetsc.errors import (
    CaseError,
    ExitStatus,
    NotConverged,
    OutputError,
    PostError,
    Stopped,
    UsageError,
    not_written,
)


class CommandParser(argparse.ArgumentParser):
    """Argument parser whose errors are one line without the usage, with exit status 2.

    Parameters
    ----------
    module : str
        See :func:`program`.
    description : str
        Description of the command; line breaks are kept.
    """

    def __init__(self, module, description):
        keeps = "\n" in description
        formatter = argparse.RawDescriptionHelpFormatter if keeps else argparse.HelpFormatter
        super().__init__(prog=program(module), description=description, formatter_class=formatter)

    def error(self, message):
        """End the command with the fault and a hint to the list of options."""
        name = self.prog.removeprefix("python3 -m ")
        self.exit(2, f"{name}: {message}; {self.prog} -h lists the options\n")


def program(module):
    """Name of a command in its help, as it was called: a subcommand, the name of pip, or a module.

    Parameters
    ----------
    module : str
        As in ``ehlpetsc.post``.

    Returns
    -------
    str
        ``ehlpetsc post``, ``ehlpetsc-post`` or ``python3 -m ehlpetsc.post``.
    """
    name = module.replace(".", "-")
    if re.fullmatch(r"(python3 -m )?ehlpetsc \w+", sys.argv[0]):  # a subcommand
        return sys.argv[0]
    return name if Path(sys.argv[0]).name == name else f"python3 -m {module}"


def exit_status(name, action, faults=(), output=None):
    """Exit status of a command; the message of a failure goes to standard error.

    Parameters
    ----------
    name : str
        Name of the command's module, as ``ehlpetsc.post``, for the message.
    action : callable
        Function of the command, which returns the status; None: done.
    faults : tuple of type
        Further exceptions that mean bad input.
    output : path-like, optional
        Output file, for errors of writing without a file name.
    """
    try:
        status = action()
    except Stopped:
        print(f"{name}: stopped; the same command continues")
        return ExitStatus.STOPPED
    except NotConverged as error:
        print(f"{name}: not converged: {error}", file=sys.stderr)
        return ExitStatus.NOT_CONVERGED
    except CaseError as error:
        print("\n".join(error.faults), file=sys.stderr)
    except OSError as error:
        print(f"{name}: {not_written(error, error.filename or output)}", file=sys.stderr)
    except (OutputError, PostError, UsageError, *faults) as error:
        print(f"{name}: {error}", file=sys.stderr)
    else:
        return ExitStatus.DONE if status is None else status
    return ExitStatus.BAD_INPUT
