"""Corrupted case files: faults in words, never another exception.

EHL_FUZZ=10000 in the environment draws that many; EHL_FUZZ_SEED another series of them.
"""

import random
import re
from functools import partial

import pytest
from support import CASES
from support.fuzzing import SEED, draws, faults_of

from ehlpetsc.case.loading import load

DRAWS = draws(400)
KEYS = """contact.radius | fluid | surface.2.synthetic | series.values | petsc.x | x | . | time.travel | title
surface.1.file | contact.radius.x | output.fields | contact.youngs_modulus | mesh..inlet |"""
VALUES = r"""nan | -inf | 0 | -1 | 1e400 | -1e-300 | -0.0 | 5e-324 | 1_000 | +1 | 0b1 | 1. | _ | true | ""
"\u0000" | "a" | # x | [] | [[]] | [1, 'x'] | {} | {a = {b = []}} | 1979-05-27T07:32:00Z | 07:32:00
{ kind = 'ridge' } | { kind = [] } | { kind = 'ground', ra = nan, seed = -1 } | '../' | '/dev/zero'"""
KEYS, VALUES = (re.split(r" ?\| ?|\n", text.strip()) for text in (KEYS, VALUES))
VALUES += ["10" * 60, "0x" + "f" * 5000, "9" * 5000, "[" * 2000, "'''\n'''", "\t"]


def corrupted(text, rng):
    """One to three random faults: bytes, lines, values, keys, tables."""
    for _ in range(rng.randint(1, 3)):
        corrupt = rng.choice((_bytes, _value, _value, _value, _key, _line_away, _line_twice, _table, _cut))
        text = corrupt(text, rng)
    return text


def _bytes(text, rng):
    raw = bytearray(text.encode("utf-8", "surrogateescape"))
    for _ in range(rng.randint(1, 5)):
        if raw:
            raw[rng.randrange(len(raw))] = rng.randrange(256)
    return raw.decode("utf-8", "surrogateescape")


def _lines(text, rng, change):
    lines = text.split("\n")
    rows = [n for n, line in enumerate(lines) if "=" in line and not line.startswith("#")]
    if rows:
        n = rng.choice(rows)
        lines[n : n + 1] = change(lines[n])
    return "\n".join(lines)


def _value(text, rng):
    return _lines(text, rng, lambda line: [line.split("=")[0] + "= " + rng.choice(VALUES)])


def _key(text, rng):
    names = ("x", "radius.x", "lambda_", "__root__", "a.b.c.d", '""', "key", "'\\u00e9'", "file", "-", "self")
    name = rng.choice(names)
    return _lines(text, rng, lambda line: [name + " =" + line.partition("=")[2]])


def _line_away(text, rng):
    return _lines(text, rng, lambda line: [])


def _line_twice(text, rng):
    return _lines(text, rng, lambda line: [line, line])


def _table(text, rng):
    old = ("contact", "fluid", "motion", "mesh", "surface.1", "surface.2", "time", "output", "series")
    new = ("contact", "petsc", "surface", "[fluid]", "surface.1.synthetic", "", "time", "series", "x.y")
    return text.replace(f"[{rng.choice(old)}]", f"[{rng.choice(new)}]")


def _cut(text, rng):
    start = rng.randrange(len(text) + 1)
    return text[:start] + text[start + rng.randrange(200) :]


@pytest.mark.filterwarnings("error")
def test_corrupted_files_raise_case_errors(tmp_path):
    rng = random.Random(SEED)
    texts = [path.read_text() for path in sorted(CASES.glob("*.toml"))]
    (tmp_path / "profiles").symlink_to(CASES / "profiles")
    path, refused = tmp_path / "case.toml", 0
    for _ in range(DRAWS):
        text = corrupted(rng.choice(texts), rng)
        path.write_bytes(text.encode("utf-8", "surrogateescape"))
        overrides = rng.choice(((), ["mesh.near_field=9"]))
        faults = faults_of(partial(load, path, overrides), partial(str, text))
        assert all(line.startswith(str(path)) for line in faults)
        refused += bool(faults)
    assert refused > 0.7 * DRAWS


def test_corrupted_overrides_raise_case_errors():
    rng = random.Random(SEED)
    refused = 0
    for _ in range(DRAWS):
        words = [
            rng.choice(KEYS) + rng.choice(("=", "=", "=", "", " = ")) + rng.choice(VALUES)
            for _ in range(rng.randint(1, 3))
        ]
        refused += bool(faults_of(partial(load, CASES / "table1_rough.toml", words), partial(str, words)))
    assert refused > 0.7 * DRAWS
