"""Damaged restart files: bytes and cuts, or content changed under a right checksum and gone on with."""

import shutil
from pathlib import Path

import numpy as np
from sandbox import process, word_of

from ehlpetsc.case.loading import load
from ehlpetsc.errors import NotConverged, OutputError
from ehlpetsc.results.restart_file import load_restart, save_restart
from ehlpetsc.run.outputs.recorder import Recorder
from ehlpetsc.run.restart import checkpoint
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).resolve().parents[2] / "cases" / "table1_rough.toml"
MESH = {"mesh.inlet": -1.3, "mesh.outlet": 1.3, "mesh.points_per_half_width": 15, "time.travel": 0.5}
LIMIT = 240  # s
NUMBERS = (np.nan, np.inf, -1.0, 0.0, 1.0, 1e300, -1e-300, 1e-9, 3, -(2**40), True, "text", 1j)


class Draw:
    """One damaged file after the other, by turns of bytes and of content."""

    def __init__(self, folder):
        self.folder, self.number = folder, 0
        self.case = load(CASE, MESH)
        simulation = Simulation(self.case)
        with Recorder(simulation, folder / "sound.h5") as recorder:
            for _ in range(4):
                recorder.write(simulation.advance())
            recorder.checkpoint()
        self.sound, self.path = folder / "sound.restart.h5", folder / "run.restart.h5"
        self.state = self._load(self.sound)

    def __call__(self, rng):
        """Outcome and what was done."""
        forged = self.number % 2 == 1
        self.number += 1
        what = self._forge(rng) if forged else self._damage(rng)
        shutil.copy(self.folder / "sound.h5", self.folder / "run.h5")
        before = [path.read_bytes() for path in (self.path, self.folder / "run.h5")]
        status, report = process(lambda: self._go_on(forged), self.folder / "report", LIMIT)
        word = "different" if "DIFFERENT STATE" in report else word_of(status, report)
        after = [path.read_bytes() for path in (self.path, self.folder / "run.h5")]
        if (word == "refused" and after != before) or list(self.folder.glob(".*.tmp")):
            word = "changed"
        return word, f"{what}: {status} {report[-1500:]}"

    def keep(self, place):
        """Copy the file of the last draw."""
        shutil.copy(self.path, place.with_suffix(".restart.h5"))

    def _load(self, path):
        simulation = Simulation(self.case)
        model = simulation.stepper.problem.model
        found, _ = checkpoint.load(path, self.case, simulation.scales, model)
        state = found.state
        parts = (state.q, state.w, state.h00, state.m, state.time, *found.baseline, found.contact_count)
        content = [np.asarray(part).tobytes() for part in (*parts, state.travelled)]
        return simulation, (state, found.baseline, found.positions), repr(content) + repr(found.totals)

    def _go_on(self, forged):
        """Load it and take a step, as a run does."""
        try:
            simulation, resumed, state = self._load(self.path)
            if not forged and state != self.state[2]:
                print("DIFFERENT STATE")
            if not forged:
                return 0
            with Recorder(simulation, self.folder / "run.h5") as recorder:
                recorder.lock_output(self.path)
                recorder.resume(self.path)
                if not simulation.finished:
                    recorder.write(simulation.advance())
            return 0
        except OutputError as error:
            print(f"ehlpetsc: {error}")
            return 2
        except NotConverged as error:
            print(f"ehlpetsc: {error}")
            return 3

    def _damage(self, rng):
        whole = bytearray(self.sound.read_bytes())
        how = int(rng.integers(4))
        place = int(rng.integers(len(whole)))
        if how == 0:
            whole = whole[:place]
        elif how == 1:
            whole += bytes(rng.integers(0, 256, 1 + place % 100, dtype=np.uint8))
        elif how == 2:
            whole[place] ^= 1 << int(rng.integers(8))
        else:
            length = int(rng.integers(1, 64))
            whole[place : place + length] = bytes(rng.integers(0, 256, length, dtype=np.uint8))
        self.path.write_bytes(whole)
        return f"bytes {how} at {place}"

    def _forge(self, rng):
        arrays, numbers = load_restart(self.sound)
        changes = []
        for _ in range(1 + int(rng.integers(2))):
            if rng.random() < 0.5:
                changes.append(self._other_array(rng, arrays))
            else:
                changes.append(self._other_number(rng, numbers))
        try:
            save_restart(self.path, arrays, numbers)
        except (TypeError, ValueError, OSError, OverflowError):  # not to be stored
            shutil.copy(self.sound, self.path)
        return ", ".join(changes)

    @staticmethod
    def _other_array(rng, arrays):
        name = str(rng.choice(sorted(arrays)))
        how = int(rng.integers(9))
        if not np.size(arrays[name]) or not np.ndim(arrays[name]):
            return "nothing"
        values = arrays.pop(name)
        changed = values.copy()
        with np.errstate(all="ignore"):
            changed.flat[int(rng.integers(changed.size))] = np.array(
                rng.choice([np.nan, np.inf, -1.0, 1e9, 0.0, -1e-9])
            ).astype(values.dtype)
            ways = (
                lambda: changed,
                lambda: values[..., :-1],
                lambda: values[..., ::-1],
                lambda: values.astype("f4"),
                lambda: values.astype("S4"),
                lambda: values * 1e3,
                lambda: values[None],
                lambda: np.zeros(0),
                lambda: None,
            )
            new = ways[how]()
        if new is not None:
            arrays[name] = new
        return f"{name}: {how}"

    @staticmethod
    def _other_number(rng, numbers):
        name = str(rng.choice(sorted(numbers)))
        if rng.random() < 0.2:
            del numbers[name]
            return f"without {name}"
        value = NUMBERS[int(rng.integers(len(NUMBERS)))]
        if name == "case":
            text = numbers[name]
            place = int(rng.integers(len(text)))
            value = text[:place] + str(rng.choice(list('"[]={}x\n'))) + text[place + 1 :]
        numbers[name] = value
        return f"{name} = {value!r}"[:80]
