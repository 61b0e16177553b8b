"""A small case with random options: a documented exit status, and no other answer without a note.

EHL_FUZZ=500 in the environment draws that many; EHL_FUZZ_SEED another series of them.
"""

import random

import pytest
from support import CASES
from support.fuzzing import SEED, draws
from support.running import run, settings

from ehlpetsc.results.reader import read_result

DRAWS = draws(6)
MESH = ["mesh.inlet=-1.3", "mesh.outlet=1.3", "mesh.points_per_half_width=15", "output.checkpoint=1e-4"]
SCENES = {
    "table1_smooth.toml": ["contact.model='mixed'"],
    "table1_rough.toml": ["time.travel=0.14", "fluid.viscosity=0.003"],
    "dry_hertz.toml": [],
    "ball.toml": ["mesh.inlet=-1.6", "mesh.points_per_half_width=4", "time.travel=0.6"],
}
NUMBERS = (*"0 1 -1 2 7 100 1e-3 1e-9 1e300 nan -inf abc 1e-400".split(), "")
NUMERIC = """snes_atol snes_rtol snes_stol snes_max_it snes_max_funcs snes_lag_jacobian
snes_divergence_tolerance ksp_rtol ksp_atol ksp_max_it ksp_gmres_restart snes_linesearch_damping
ehl_time_limit"""
WORDS_OF = {
    "ksp_type": "gmres fgmres cg preonly nosuch none",
    "pc_type": "lu ilu jacobi none mg python shell nosuch",
    "snes_type": "newtonls newtontr vinewtonrsls qn ksponly x",
    "snes_linesearch_type": "basic bt l2 cp x",
    "snes_convergence_test": "default skip correct_pressure x",
    "snes_monitor": "ascii:/no/such/f nosuch:x 5",
    "ehl_output": "o.h5 / no/o.h5 case.toml",
    "ehl_set": "fluid.viscosity=0.004 mesh.inlet=0 x=1 time={} petsc.snes_rtol='nan'",
    "ehl_restart": "none.h5 case.toml",
}
VALUES = {name: NUMBERS for name in NUMERIC.split()} | {k: (*v.split(), "") for k, v in WORDS_OF.items()}
FLAGS = """snes_monitor snes_view snes_mf snes_fd log_view snes_check_jacobian help snes_test_jacobian
options_view ksp_error_if_not_converged ehl_overwrite ehl_overwrit -overwrite -nosuch""".split()
ANOTHER = ("ehl_set", "looser than")  # another answer is right, or announced
STATUSES = 0, 2, 3, 4  # done, refused, not converged, stopped


def outcome(folder, name, words):
    """Exit status and output; minimum film and maximum pressure, None without a result."""
    for left in folder.glob("*.h5"):
        left.unlink()
    done, answer = run(CASES / name, *settings(*MESH, *SCENES[name]), *words, cwd=folder), None
    for path in folder.glob("*.h5"):
        if "restart" not in path.name:
            with read_result(path) as result:
                answer = result.steps("h_min").min() + 1e-12, result.steps("p_max").max()
    return done.returncode, done.stdout + done.stderr, answer


@pytest.mark.slow
def test_random_options_end_with_a_documented_status(tmp_path):
    rng, answers, statuses = random.Random(SEED), {}, []
    for _ in range(DRAWS):
        name, words = rng.choice(list(SCENES)), []
        answers[name] = answers.get(name) or outcome(tmp_path, name, [])[2]
        for _ in range(rng.randint(1, 4)):
            option = rng.choice(list(VALUES))
            value = [f"-{option}", *filter(None, [rng.choice(VALUES[option])])]
            words += value if rng.random() < 0.75 else [f"-{rng.choice(FLAGS)}"]
        limit = [] if "-ehl_time_limit" in words else ["-ehl_time_limit", "0.15"]
        status, report, answer = outcome(tmp_path, name, [*limit, *words])
        about = f"{name} {' '.join(words)}: {status} {report[-1500:]}"
        assert status in STATUSES and "Traceback (most" not in report, about
        assert status != 2 or any(": " in line for line in report.splitlines()), about
        if status == 0 and answer and not any(marker in " ".join((report, *words)) for marker in ANOTHER):
            assert answer == pytest.approx(answers[name], rel=1e-5), about
        statuses.append(status)
    assert 2 in statuses
