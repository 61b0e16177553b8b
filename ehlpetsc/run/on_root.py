"""Actions of rank 0, whose errors are raised on every rank."""

from ehlpetsc.errors import OutputError


def on_root(comm, action, *arguments):
    """Result of `action` on rank 0, None on the others; its OutputError is raised on every rank."""
    answer = fault = None
    if comm.rank == 0:
        try:
            answer = action(*arguments)
        except OutputError as error:
            fault = str(error)
    fault = comm.bcast(fault)
    if fault:
        raise OutputError(fault)
    return answer
