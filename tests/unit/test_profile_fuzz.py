"""Corrupted profile files: a fault in words or heights that a run can use, never another exception.

EHL_FUZZ=10000 in the environment draws that many; EHL_FUZZ_SEED another series of them.
"""

import random
from functools import partial

import pytest
from support import CASES
from support.fuzzing import SEED, draws, faults_of

from ehlpetsc.case.loading import load

DRAWS = draws(300) // 2
WORDS = [*"nan -inf 1e308 1e-320 x 1_0 1,5 1.000,5 1;2 -- é".split(), "", "\0"]
KEYS = """unit='um' | spacing=1e-6 | columns=[1] | columns=[2, 1] | columns=[9] | decimal=',' | header_lines=3
header_lines=99999 | fill_gaps=1 | level=true | cutoff=80e-6 | short_cutoff=5e-6 | scale=0""".replace(
    "\n", " | "
).split(" | ")


def corrupted(lines, rng):
    """One to four faults in words, lines, separators and bytes."""
    for _ in range(rng.randint(1, 4)):
        n, kind = rng.randrange(len(lines)), rng.randrange(5)
        if kind == 0:
            lines[n] = rng.choice(["", lines[n].split(",")[0] + ","]) + rng.choice(WORDS)
        elif kind == 1:
            lines = [*lines[:n], rng.choice(("", "# c", "text", "1", "1,2,3", lines[n])), *lines[n:]]
        elif kind == 2:
            lines = [line.replace(",", rng.choice(";;\t ")) for line in lines]
        elif kind == 3:
            lines = lines[::-1] if rng.random() < 0.5 else lines[: rng.randrange(1, 12)]
        else:
            lines = [line.replace(".", ",") for line in lines]
    raw = bytearray("\n".join(lines).encode(rng.choice(("utf-8", "utf-16", "latin-1")), "replace"))
    raw[rng.randrange(len(raw))] = rng.choice((raw[0], rng.randrange(256)))
    return bytes(raw)


@pytest.mark.filterwarnings("error")
def test_corrupted_profiles_are_refused_or_finite(tmp_path):
    rng = random.Random(SEED)
    lines = (CASES / "profiles" / "alicona_meander_profile.csv").read_text().splitlines()[1:401]
    text = (CASES / "table1_rough.toml").read_text().replace("profiles/alicona_meander_profile.csv", "p.csv")
    case, refused = tmp_path / "c.toml", 0
    case.write_text(text)
    for draw in range(DRAWS):
        (tmp_path / "p.csv").write_bytes(corrupted(lines, rng))
        keys = [f"surface.1.{key}" for key in rng.sample(KEYS, rng.choice((0, 0, 1, 2)))]
        words = ["mesh.points_per_half_width=20", *keys]
        drawn = partial("draw {}: {}\n{}".format, draw, keys, (tmp_path / "p.csv").read_bytes()[:300])
        faults = faults_of(partial(load, case, words), drawn)
        assert all(line.startswith(str(case)) for line in faults)
        refused += bool(faults)
    assert 0.3 * DRAWS < refused < DRAWS
