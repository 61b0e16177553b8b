"""PETSc on the path, the marker of tests under mpirun, their order, and signals as a terminal has them."""

import gc
import signal
from pathlib import Path

import pytest

from ehlpetsc import environment

environment.prepare()
MPI_TESTS = Path(__file__).parent / "mpi"
DEAREST = (  # files of two seconds and more by the processor time they take
    "test_post_run",  # these three compile what others load: post-processing, the solver, and nothing
    "test_compliant",
    "test_run_script",
    "test_wear_against_fatigue",
    "test_passes",
    "test_fuzz",
    "test_options",
    "test_interruptions",
    "test_stops",
    "test_series",
    "test_post_outputs",
    "test_cases",
    "test_extremes",
    "test_batch",
    "test_operation",
    "test_packaging",
    "test_lives_with_effects",
    "test_derived_of_gears_and_life",
    "test_plot",
    "test_figures",
    "test_outputs",
    "test_heat",
    "test_yielding",
    "test_lives_killed",
    "test_asperities",
    "test_sweep",
    "test_output",
    "test_body_point_temperatures",
    "test_waviness",
    "test_heat_with_effects",
    "test_derived_files",
    "test_starts",
    "test_case_fuzz",
    "test_post_histories",
    "test_docs",
    "test_notebook",
    "test_post_inputs",
    "test_life_regimes",
    "test_rough",
    "test_case_text",
    "test_ensemble",
    "test_collisions",
    "test_stored_figures",
    "test_study",
    "test_wear",
    "test_python",
    "test_order",
    "test_bad_input",
    "test_ridge",
    "test_compliant_runs",
    "test_mixed",
    "test_dense_profiles",
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


@pytest.fixture(scope="module")
def coarse_pictures():
    """Pictures of post-processing of few dots and in one format, but where a test asks for both."""
    from ehlpetsc.post.pictures import gallery

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(gallery, "DPI", 20)
        patch.setattr(gallery, "FORMATS", ("png",))
        yield


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
