"""Case files with mutations, in this process."""

import random
import signal

import pytest
from support import CASES
from support.fuzzing import faults_of
from test_case_fuzz import corrupted

from ehlpetsc.case.loading import load

LIMIT = 60  # s


class Draw:
    """One mutated case file after the other."""

    def __init__(self, folder):
        self.path = folder / "case.toml"
        self.texts = [path.read_text() for path in sorted(CASES.glob("*.toml"))]
        (folder / "profiles").symlink_to(CASES / "profiles")
        signal.signal(signal.SIGALRM, self._late)

    def __call__(self, rng):
        """Outcome and what was done."""
        draw = random.Random(int(rng.integers(2**62)))
        text = corrupted(draw.choice(self.texts), draw).encode("utf-8", "surrogateescape")
        self.path.write_bytes(text)
        signal.alarm(LIMIT)
        try:
            faults = faults_of(lambda: load(self.path), lambda: "")
        except TimeoutError:
            return "hang", text
        except (pytest.fail.Exception, Exception) as fault:
            return "traceback", f"{fault}\n{text}"
        finally:
            signal.alarm(0)
        if self.path.read_bytes() != text:
            return "changed", text
        if any(not line.startswith(str(self.path)) for line in faults):
            return "traceback", f"no name of the file in {faults}"
        return ("refused" if faults else "done"), ""

    def keep(self, place):
        """Copy the file of the last draw."""
        place.with_suffix(".toml").write_bytes(self.path.read_bytes())

    @staticmethod
    def _late(*_):
        raise TimeoutError
