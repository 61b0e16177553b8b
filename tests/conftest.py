"""PETSc on the path, the marker of tests under mpirun, their order, and signals as a terminal has them."""

import gc
import signal
from pathlib import Path

import pytest

from ehlpetsc import environment

environment.prepare()
MPI_TESTS = Path(__file__).parent / "mpi"
DEAREST = (  # files of about five seconds and more by the time they take, those with mpirun beside others
    "test_post_run",
    "test_stops",
    "test_extremes",
    "test_interruptions",
    "test_figures",
    "test_options",
    "test_post_criteria",
    "test_series",
    "test_plot",
    "test_run_script",
    "test_cases",
    "test_packaging",
    "test_post_outputs",
    "test_yielding",
    "test_fuzz",
    "test_notebook",
    "test_outputs",
    "test_output",
    "test_passes",
    "test_waviness",
    "test_sweep",
    "test_post_between",
    "test_mixed",
    "test_starts",
    "test_post_inputs",
    "test_batch",
    "test_bad_input",
    "test_rough",
    "test_case_text",
    "test_post_histories",
    "test_collisions",
    "test_stored_figures",
    "test_order",
    "test_study",
    "test_ensemble",
    "test_python",
)
# what a shell starts in the background ignores Ctrl-C, nohup a hangup, and every process would inherit that
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
TAKEN = signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGPIPE  # by commands, for good


@pytest.fixture(autouse=True)
def signals_as_before():
    """A command called in a test keeps its hold on signals; processes of later tests would inherit it."""
    before = {number: signal.getsignal(number) for number in TAKEN}
    yield
    for number, handler in before.items():
        if signal.getsignal(number) is not handler:
            signal.signal(number, handler)


def pytest_collection_modifyitems(items):
    """Every test in tests/mpi runs under mpirun, and no other does."""
    for item in items:
        if MPI_TESTS in item.path.parents:
            item.add_marker(pytest.mark.mpi)


def pytest_collection_finish():
    """Modules and tests stay until the end: the garbage collector need not look at them again and again."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Files go whole to the processes of ``--dist loadfile``, dearest first: all end at about one time."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class DearestFirst(LoadFileScheduling):
        def _assign_work_unit(self, node):
            dearest = min(self.workqueue, key=rank)
            self.workqueue.move_to_end(dearest, last=False)
            super()._assign_work_unit(node)

    return DearestFirst(config, log)


def rank(path):
    """Place of a file in `DEAREST`; all others, in their order, come after."""
    name = Path(path).stem
    return DEAREST.index(name) if name in DEAREST else len(DEAREST)
