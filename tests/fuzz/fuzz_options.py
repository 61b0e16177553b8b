"""The door of the command line: a small case run with options drawn from lists of good and bad ones."""

import os

import numpy as np
from sandbox import process, word_of
from support import CASES

import ehlpetsc.discretisation.ehl_problem
import ehlpetsc.physics.rheology  # noqa: F401
from ehlpetsc.__main__ import main
from ehlpetsc.results.reader import read_result

MESH = ["mesh.inlet=-1.3", "mesh.outlet=1.3", "mesh.points_per_half_width=15", "output.checkpoint=1e-4"]
SCENES = (
    ["table1_smooth.toml", "contact.model='mixed'"],
    ["table1_rough.toml", "time.travel=0.14", "fluid.viscosity=0.003"],
    ["dry_hertz.toml"],
)
LIMIT = 300  # s
SAME = 1e-5  # relative, of minimum film and maximum pressure
NUMBERS = (*"0 1 -1 2 7 100 1e-3 1e-9 1e300 nan -inf abc 1e-400".split(), "")
NUMERIC = (
    "snes_atol snes_rtol snes_stol snes_max_it snes_max_funcs snes_lag_jacobian snes_divergence_tolerance "
    "ksp_rtol ksp_atol ksp_max_it ksp_gmres_restart snes_linesearch_damping ehl_time_limit"
)
WORDS_OF = {
    "ksp_type": "gmres fgmres cg preonly nosuch none",
    "pc_type": "lu ilu jacobi none mg python shell nosuch",
    "snes_type": "newtonls newtontr vinewtonrsls qn ksponly x",
    "snes_linesearch_type": "basic bt l2 cp x",
    "snes_convergence_test": "default skip correct_pressure x",
    "snes_monitor": "ascii:/no/such/f nosuch:x 5",
    "ehl_scheme": "newton sweep x",
    "ehl_output": "o.h5 / no/o.h5 case.toml",
    "ehl_set": "fluid.viscosity=0.004 mesh.inlet=0 x=1 time={} petsc.snes_rtol='nan'",
    "ehl_restart": "none.h5 case.toml",
}
VALUES = {name: NUMBERS for name in NUMERIC.split()} | {k: (*v.split(), "") for k, v in WORDS_OF.items()}
FLAGS = (
    "snes_monitor snes_view snes_mf snes_fd log_view snes_check_jacobian help snes_test_jacobian "
    "ksp_error_if_not_converged ehl_overwrite options_view ehl_overwrit -overwrite -nosuch"
).split()
ANOTHER = ("ehl_set", "looser than", "ehl_scheme")  # another answer is right, or announced


class Draw:
    """One run after the other."""

    def __init__(self, folder):
        self.folder, self.answers = folder, []
        for scene in SCENES:
            status, report = self._run(scene, ["-ehl_time_limit", "10"])  # the first compiles
            assert status == 0, (scene, report)
            self.answers.append(self._answer())

    def __call__(self, rng):
        """Outcome and what was done."""
        number, words = int(rng.integers(len(SCENES))), []
        for _ in range(1 + int(rng.integers(4))):
            if rng.random() < 0.25:
                words.append(f"-{rng.choice(FLAGS)}")
                continue
            name = str(rng.choice(list(VALUES)))
            words += [f"-{name}", *filter(None, [str(rng.choice(VALUES[name]))])]
        status, report = self._run(SCENES[number], words)
        word = word_of(status, report)
        if word == "done" and not any(marker in " ".join((report, *words)) for marker in ANOTHER):
            answer = self._answer()
            if answer is not None and not np.allclose(answer, self.answers[number], rtol=SAME, atol=0.0):
                word = "different"
        return word, f"{SCENES[number]} {' '.join(words)}: {status} {report[-1500:]}"

    def _run(self, scene, words):
        name, *settings = scene
        for left in self.folder.glob("*.h5"):
            left.unlink()
        sets = [word for setting in (*MESH, *settings) for word in ("-ehl_set", setting)]
        limit = [] if "-ehl_time_limit" in words else ["-ehl_time_limit", "0.15"]

        def work():
            os.chdir(self.folder)
            return int(main([str(CASES / name), *sets, *limit, *words]))

        return process(work, self.folder / "report", LIMIT)

    def _answer(self):
        """Minimum film and maximum pressure of the run, None without a result."""
        for path in self.folder.glob("*.h5"):
            if "restart" not in path.name:
                with read_result(path) as result:
                    return result.steps("h_min").min() + 1e-12, result.steps("p_max").max()
        return None
