"""Interruptions: passes, a series and a run stopped, killed or robbed of a file, and the same command again.

In the end every result must be that of a run left alone, or the command must say why it refuses; files of
others in the folder stay as they are.
"""

import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
from sandbox import word_of
from support import ROOT

from ehlpetsc.results.reader import read_result

COARSE = ("mesh.points_per_half_width=20", "output.every=1")
SCENES = {
    "running_in.toml": (*COARSE, "time.travel=0.8", "time.passes=3", "contact.yield_pressure=0.95e9"),
    "stribeck.toml": (*COARSE, "time.travel=0.8", "series.values=[10.0,5.0,2.0]"),
    "ridge.toml": (*COARSE, "time.travel=2.5"),
}
STOPS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
FOREIGN = {"notes.txt": b"mine", "other.h5": b"\x89HDF\r\n\x1a\nmine", "other.restart.h5": b"mine"}
LIMIT = 120  # s
SAME = 1e-9
ROBBED = ("*.passes.json", "*.series.json", "*.pass1.restart.h5", "*.restart.h5", "*.pass2.h5", "*_5.0.h5")


class Draw:
    """One accident after the other."""

    def __init__(self, folder):
        self.folder, self.seconds = folder / "run", {}

    def __call__(self, rng):
        """Outcome and what was done."""
        name = str(rng.choice(list(SCENES)))
        whole = self.folder.with_name(name)
        if name not in self.seconds:
            whole.mkdir()
            begun = time.monotonic()
            status, report = self._run(name, whole)
            assert status == 0, report
            self.seconds[name] = time.monotonic() - begun
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir()
        for other, content in FOREIGN.items():
            (self.folder / other).write_bytes(content)
        actions, often = [name], ("output.checkpoint=1e-5",) if rng.random() < 0.5 else ()
        for _ in range(int(rng.integers(1, 4))):
            after, stop = self.seconds[name] * rng.random(), STOPS[int(rng.integers(len(STOPS)))]
            status, report = self._run(name, self.folder, after, stop, often)
            actions.append(f"{stop.name} after {after:.2f} s: {status}")
            if status not in (0, 4, -stop.value):
                return word_of(status, report), f"{actions} {report[-1500:]}"
            if rng.random() < 0.25:
                pattern = str(rng.choice(ROBBED))
                for path in {*self.folder.glob(pattern)} - {self.folder / other for other in FOREIGN}:
                    path.unlink()
                actions.append(f"without {pattern}")
        status, report = self._run(name, self.folder, often=often)
        word = word_of(status, report)
        if word == "done" and not often and not self._equals(whole):
            word = "different"
        changed = any((self.folder / other).read_bytes() != content for other, content in FOREIGN.items())
        if changed or list(self.folder.glob("*.lock")):
            word = "changed"
        return word, f"{actions}: {status} {report[-1500:]}"

    def _run(self, name, folder, after=LIMIT, stop=signal.SIGKILL, often=()):
        words = [word for key in (*SCENES[name], *often) for word in ("--set", key)]
        command = [sys.executable, "-m", "ehlpetsc", str(ROOT / "cases" / name), *words]
        env = os.environ | {"PYTHONPATH": f"{ROOT}:{os.environ.get('PYTHONPATH', '')}"}
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        run = subprocess.Popen(command, cwd=folder, env=env, **pipes)
        for limit in (after, LIMIT):
            try:
                report, _ = run.communicate(timeout=limit)
                return run.returncode, report
            except subprocess.TimeoutExpired:
                run.send_signal(stop)
        run.kill()
        return None, run.communicate()[0]  # it hangs

    def _equals(self, whole):
        """Whether all results are those of a run left alone."""
        names = {path.name for path in whole.glob("*.h5") if ".restart" not in path.name}
        if not names <= {path.name for path in self.folder.iterdir()}:
            return False
        for name in names:
            with read_result(whole / name) as one, read_result(self.folder / name) as other:
                if other.attrs["status"] != "done" or list(one.step) != list(other.step):
                    return False
                if np.abs(one.pressure - other.pressure).max() > SAME * one.attrs["p0"]:
                    return False
        return True
