"""PETSc on the path, the marker of tests under mpirun, their order, and signals as a terminal has them."""

import gc
import signal
from pathlib import Path

import pytest

from ehlpetsc.base import environment

environment.prepare()
MPI_TESTS = Path(__file__).parent / "mpi"
# files of two seconds of processor time and more, longest first; the first three compile post-processing, the
# solver, and nothing
DEAREST = """
test_post_run test_compliant test_run_script test_cases test_stops test_heat test_asperities test_operation
test_passes test_figures test_series test_post_criteria test_lives_with_effects test_yielding test_options
test_plot_series test_lives_killed test_sweep test_wear_against_fatigue test_film_shear test_heat_with_effects
test_outputs test_batch test_fuzz test_waviness test_extremes test_heat_runs test_packaging
test_body_point_temperatures test_mixed test_python test_gears test_interruptions test_heat_order test_starts
test_heat_state test_readme test_notebook test_case_fuzz test_compliant_runs test_output test_elasticity
test_effects test_derived_files test_life_outputs test_stored_figures test_roughness test_ridge test_rough
""".split()
# what a shell starts in the background ignores Ctrl-C, nohup a hangup, and every process would inherit that
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
TAKEN = signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGPIPE  # by commands, for good


@pytest.fixture(autouse=True)
def signals_as_before():
    """Restore signal handlers that a command called in a test has set; later processes would inherit them."""
    before = {number: signal.getsignal(number) for number in TAKEN}
    yield
    for number, handler in before.items():
        if signal.getsignal(number) is not handler:
            signal.signal(number, handler)


@pytest.fixture(scope="module")
def coarse_pictures():
    """Pictures of post-processing of few dots and in one format, but where a test asks for both."""
    from ehlpetsc.pictures import damage as gallery
    from ehlpetsc.pictures import style

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "DPI", 20)
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
    """Give the longest files to the processes of ``--dist loadfile`` first, so that all end together."""
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
    """Index of a file in `DEAREST`; other files come after, in their order."""
    name = Path(path).stem
    return DEAREST.index(name) if name in DEAREST else len(DEAREST)
