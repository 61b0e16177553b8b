"""PETSc and its MPI, the marker of tests under mpirun, their order, and signals as a terminal has them."""

import contextlib
import gc
import os
import signal
import sys
from pathlib import Path

import pytest

from ehlpetsc.base import environment

if not environment.prepare():
    environment.load_mpi()
PACKAGES = str(Path(__file__).parents[1] / ".test-packages")  # optional ones that .ci/run has fetched
with contextlib.suppress(ImportError):  # SurfaceTopography needs a newer one than Debian's
    sys.path.insert(0, PACKAGES)
    import typing_extensions  # noqa: F401
sys.path.remove(PACKAGES)
sys.path.append(PACKAGES)
os.environ.setdefault("MPLBACKEND", "Agg")  # no windows
os.environ["EHLPETSC_CACHE"] = os.devnull  # no folder: neither reads speeds of earlier runs nor keeps any
MPI_TESTS = Path(__file__).parent / "mpi"
# Files of two seconds of processor time and more, about longest first. The first two compile post-processing
# and the solver, those up to test_report_page nothing, those up to test_stops but the first one nothing with
# heat: processes would compile the same at the same time.
DEAREST = """
test_post_run test_compliant test_plot_series test_plane_pictures test_case_fuzz test_packaging
test_output test_readme test_run_script test_derived_files test_report_page test_post_planes
test_measured_gears test_wear_against_fatigue test_figures test_series test_stops test_two_minutes
test_cases test_operation test_effects test_starts test_waves test_passes test_measured test_options
test_programs test_interruptions test_gears test_outputs test_plane_operation test_extremes test_yielding
test_heat test_collisions test_python test_order test_lost_outputs test_plane_cases test_linear_cost
test_plane_results test_domain test_areal_parameters test_surface_parameters test_deflection
test_subcommands test_notebook test_batch test_waviness test_life test_strips test_lives_killed
test_heat_state test_points test_plot test_body_point_temperatures test_lives_with_effects
test_heat_with_effects test_heat_runs test_sweep test_plane_heat test_thermal_reduction test_heat_order
test_film_shear test_fuzz test_newton test_ridge test_roughness test_post_criteria test_compliant_runs
test_rheology test_post_histories test_dry test_stored_figures test_mixed
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
    from ehlpetsc.pictures import damage_maps as gallery
    from ehlpetsc.pictures import style

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "DPI", 20)
        patch.setitem(style.save.__kwdefaults__, "dpi", 20)
        patch.setattr(gallery, "FORMATS", ("png",))
        yield


@pytest.fixture
def drawn(monkeypatch):
    """Figures that a command would have written to files."""
    from matplotlib.figure import Figure

    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    return figures


@pytest.fixture
def uncompiled(monkeypatch):
    """Flow laws as Python code, for the complex step: no run needs them compiled for complex numbers.

    The branches of the switch over the laws have no Python form: the switch is compiled.
    """
    from ehlpetsc.effects.heat import film_shear
    from ehlpetsc.physics.oil import rheology

    for module in (film_shear, rheology):
        for name, function in list(vars(module).items()):
            if hasattr(function, "py_func") and name != "_shear_stress":
                monkeypatch.setattr(module, name, function.py_func)


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
