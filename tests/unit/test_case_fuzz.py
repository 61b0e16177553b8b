"""Corrupted case files and profiles give faults or values that a run can use, never another exception.

EHL_FUZZ=10000 in the environment draws that many; EHL_FUZZ_SEED another series of them.
"""

import copy
import random
import re
import tomllib
from functools import partial

import numpy as np
import pytest
from support import CASES
from support.fuzzing import SEED, draws
from support.maps import MAPS

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.case.tables import CASE
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.surfaces.motion.roughness import Roughness

DRAWS, PROFILE_DRAWS, KEY_DRAWS = draws(400), draws(300) // 2, draws(320) // 12
LARGE = 5000  # nodes of a mesh beyond which nothing is worked out on it
KEYS = """contact.radius | fluid | surface.2.synthetic | series.values | petsc.x | x | . | time.travel | title
surface.1.file | contact.radius.x | output.fields | contact.youngs_modulus | mesh..inlet |"""
VALUES = r"""nan | -inf | 0 | -1 | 1e400 | -1e-300 | -0.0 | 5e-324 | 1_000 | +1 | 0b1 | 1. | _ | true | ""
"\u0000" | "a" | # x | [] | [[]] | [1, 'x'] | {} | {a = {b = []}} | 1979-05-27T07:32:00Z | 07:32:00
{ kind = 'ridge' } | { kind = [] } | { kind = 'ground', ra = nan, seed = -1 } | '../' | '/dev/zero'"""
KEYS, VALUES = (re.split(r" ?\| ?|\n", text.strip()) for text in (KEYS, VALUES))
VALUES += ["10" * 60, "0x" + "f" * 5000, "9" * 5000, "[" * 2000, "'''\n'''", "\t"]


def faults_of(load, about):
    """Fault messages of a case, none if a run can use it. Any other exception fails the test."""
    try:
        _used(load())
    except CaseError as error:
        assert error.faults and not any("\n" in line for line in error.faults)
        return error.faults
    except Exception as error:
        pytest.fail(f"{type(error).__name__}: {error}\n{about()}")
    return []


def _used(case):
    """Use a case as a run does before its first solve: no accepted value may raise."""
    scales = Scales.of(case)
    if case.mesh.nodes < LARGE:
        rough = Roughness.of(case, scales)
        x, half = scales.x * scales.a, 0.5 * (scales.duration or 0.0)
        for cell in (None, scales.spacing) if rough else ():
            assert np.isfinite(rough.phi_after(x, (half * scales.u1, half * scales.u2), cell)).all()
        assert explain(case)
    tomllib.loads(case.text)


def corrupted(text, rng):
    """One to three random faults: bytes, lines, values, keys, tables."""
    for _ in range(rng.randint(1, 3)):
        corrupt = rng.choice((_bytes, _value, _value, _value, _key, AWAY, TWICE, _table, _cut))
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


AWAY, TWICE = partial(_lines, change=lambda line: []), partial(_lines, change=lambda line: [line, line])


def _value(text, rng):
    return _lines(text, rng, lambda line: [line.split("=")[0] + "= " + rng.choice(VALUES)])


def _key(text, rng):
    names = ("x", "radius.x", "lambda_", "__root__", "a.b.c.d", '""', "key", "'\\u00e9'", "file", "-", "self")
    name = rng.choice(names)
    return _lines(text, rng, lambda line: [name + " =" + line.partition("=")[2]])


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


def keys_in(table, where=""):
    """Places and keys of a table of the case and of all tables in it."""
    for name, key in table.keys.items():
        yield where + name, key
        for inner in [key.table] if key.table else (key.variants or {}).values():
            yield from keys_in(inner, f"{where}{name}.")


def allowed_value(key, rng):
    """A value within the bounds of a key, as TOML, or any other one."""
    if key.kind not in (int, float, str, bool) or rng.random() < 0.15:
        return rng.choice(VALUES)
    if key.choices:
        one = f'"{rng.choice(list(key.choices))}"'
    elif key.kind in (str, bool):
        return rng.choice(("true", "false") if key.kind is bool else ("'x'", "'../x'", "'losses'", "'1 um'"))
    else:
        low = next((bound for bound in (key.ge, key.gt) if bound is not None), -1e300)
        high = next((bound for bound in (key.le, key.lt) if bound is not None), 1e300)
        share = rng.choice((0.0, 0.01, 0.3, 1.0, rng.random()))
        ratio = low > 0.0 and rng.random() < 0.7
        value = low * (high / low) ** share if ratio else (1.0 - share) * low + share * high
        one = str(round(value)) if key.kind is int else repr(value)
    return f"[{', '.join([one] * rng.randint(1, 3))}]" if key.many and rng.random() < 0.8 else one


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("seed", range(SEED, SEED + 3))
def test_any_key_with_any_value_raises_case_errors_alone(seed):
    rng, refused = random.Random(seed), 0
    cases, keys = sorted(CASES.glob("*.toml")), list(keys_in(CASE))
    for _ in range(KEY_DRAWS):
        words = [f"{rng.choice(KEYS)}{rng.choice(('', '=', ' = '))}{rng.choice(VALUES)}"]
        words = words if rng.random() < 0.2 else []
        for place, key in rng.choices(keys, k=rng.randint(1, 2)):
            words.append(f"{place}={allowed_value(key, rng)}")
        case = rng.choice(cases)
        refused += bool(faults_of(partial(load, case, words), partial(str, (case.name, words))))
    assert refused > 0.2 * KEY_DRAWS


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("seed", range(SEED, SEED + 3))
def test_any_key_of_points_and_strips_with_maps_raises_case_errors_alone(seed):
    rng, refused = random.Random(seed), 0
    tables, keys = [tomllib.loads(text) for text in MAPS.values()], list(keys_in(CASE))
    for _ in range(KEY_DRAWS):
        words = [f"{place}={allowed_value(key, rng)}" for place, key in rng.choices(keys, k=2)]
        table = copy.deepcopy(rng.choice(tables))
        if rng.random() < 0.3:  # a table or a key of it left out
            name = rng.choice(list(table))
            inner = table[name] if isinstance(table[name], dict) and rng.random() < 0.7 else table
            inner.pop(name if inner is table else rng.choice(list(inner)))
        refused += bool(faults_of(partial(load, table, words), partial(str, (words, table))))
    assert refused > 0.2 * KEY_DRAWS


WORDS = [*"nan -inf 1e308 1e-320 x 1_0 1,5 1.000,5 1;2 -- é".split(), "", "\0"]
PROFILE_KEYS = """unit='um' | spacing=1e-6 | columns=[1] | columns=[2, 1] | columns=[9] | decimal=','
header_lines=3 | header_lines=99999 | fill_gaps=1 | bridge_spikes=true | level=true
cutoff=80e-6 | short_cutoff=5e-6 | scale=0"""
PROFILE_KEYS = re.split(r" \| |\n", PROFILE_KEYS)


def corrupted_profile(lines, rng):
    """Up to three random faults, and a byte: numbers, lines, separators."""
    for _ in range(rng.randint(0, 3)):
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
    for draw in range(PROFILE_DRAWS):
        (tmp_path / "p.csv").write_bytes(corrupted_profile(list(lines), rng))
        keys = [f"surface.1.{key}" for key in rng.sample(PROFILE_KEYS, rng.choice((0, 0, 1, 2)))]
        words = ["mesh.points_per_half_width=20", *keys]
        drawn = partial("draw {}: {}\n{}".format, draw, keys, (tmp_path / "p.csv").read_bytes()[:300])
        faults = faults_of(partial(load, case, words), drawn)
        assert all(line.startswith(str(case)) for line in faults)
        refused += bool(faults)
    assert 0.3 * PROFILE_DRAWS < refused < PROFILE_DRAWS
