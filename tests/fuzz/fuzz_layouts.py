"""Shipped cases laid out otherwise in TOML, keys changed as by -ehl_set, loaded, stored, loaded again."""

import tomllib

from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError

SETS = (
    "contact.load=4e5",
    "contact.boundary_friction=0.1",
    "mesh.points_per_half_width=40",
    "mesh.inlet=-1.7",
    "output.every=3",
    "output.fields=['pressure', 'film_thickness']",
    "petsc.snes_atol='1e-9'",
    "post.depths=[0.0, 0.1]",
    "surface.2={synthetic={kind='sine',amplitude=2e-7,wavelength=1e-4}}",
    "surface.2.scale=2.0",
    "surface.1.flip=true",
    "time.travel=0.5",
    "time={travel=0.7}",
    "fluid.viscosity=0.004",
    "motion.slide_roll_ratio=-0.3",
    "title='another'",
)


class Draw:
    """One layout after the other."""

    def __init__(self, folder):
        self.path, self.stored = folder / "case.toml", folder / "stored.toml"
        self.tables = [tomllib.loads(path.read_text()) for path in sorted(CASES.glob("*.toml"))]
        (folder / "profiles").symlink_to(CASES / "profiles")

    def __call__(self, rng):
        """Outcome and what was done."""
        tables = self.tables[int(rng.integers(len(self.tables)))]
        text = laid_out(rng, tables)
        sets = [str(s) for s in rng.choice(SETS, 1 + int(rng.integers(4)), replace=False)]
        self.path.write_text(text)
        what = f"{sets}\n{text}"
        try:
            if tomllib.loads(text) != tables:
                return "traceback", f"not what was to be written\n{what}"
            case = load(self.path, sets)
        except CaseError as fault:
            return "refused", f"{fault}\n{what}"
        except Exception as error:
            return "traceback", f"{error!r}\n{what}"
        try:
            self.stored.write_text(case.text)
            again = load(self.stored)
        except Exception as error:
            return "different", f"{error!r}\n{what}\n---\n{case.text}"
        if again.as_dict() != case.as_dict() or self._asked(sets, case) != "":
            return "different", f"{self._asked(sets, case)}\n{what}\n---\n{case.text}"
        return "done", ""

    @staticmethod
    def _asked(sets, case):
        """The first setting that is not in the stored text as it was given; "" where all are."""
        stored = tomllib.loads(case.text)
        for number, one in enumerate(sets):
            names, value = one.split("=", 1)
            later = [other.split("=", 1)[0] for other in sets[number + 1 :]]
            if any(other.startswith(names) or names.startswith(other) for other in later):
                continue
            found = stored
            for name in names.split("."):
                found = found.get(name) if isinstance(found, dict) else None
            if found != tomllib.loads(f"x = {value}")["x"]:
                return one
        return ""

    def keep(self, place):
        """Copy the file of the last draw."""
        place.with_suffix(".toml").write_bytes(self.path.read_bytes())


def laid_out(rng, tables):
    """A case's tables as TOML, each one headed, dotted, inline or mixed, in any order."""
    top, below = [], []
    for name in shuffled(rng, tables):
        value = tables[name]
        if not isinstance(value, dict) or rng.random() < 0.15:
            top.append(f"{key(rng, name)} = {inline(rng, value)}")
        elif rng.random() < 0.3:
            top += dotted(rng, key(rng, name), value)
        else:
            below.append(headed(rng, key(rng, name), value))
    rng.shuffle(top)
    rng.shuffle(below)
    gap = "\n" if rng.random() < 0.5 else "\n\n# a remark\n"
    return gap.join([*top, *below]) + ("\n" if rng.random() < 0.8 else "")


def headed(rng, path, table):
    """A table below a heading; tables in it inline, dotted or below headings of their own."""
    lines, further = [], []
    for name in shuffled(rng, table):
        value = table[name]
        if not isinstance(value, dict) or rng.random() < 0.65:
            lines += assigned(rng, key(rng, name), value, whole=0.46)
        else:
            further.append(headed(rng, f"{path}.{key(rng, name)}", value))
    head = [f"[{path}]"] if lines or not further or rng.random() < 0.5 else []
    return "\n".join([*head, *lines, *further])


def dotted(rng, path, table):
    """A table as keys with dots."""
    if not table:
        return [f"{path} = {{}}"]
    lines = []
    for name in shuffled(rng, table):
        lines += assigned(rng, f"{path}.{key(rng, name)}", table[name], whole=0.4)
    return lines


def assigned(rng, path, value, whole):
    """A value behind its key; a table in one line, with the likelihood given, else as keys with dots."""
    if not isinstance(value, dict) or rng.random() < whole:
        return [f"{path} = {inline(rng, value)}{remark(rng)}"]
    return dotted(rng, path, value)


def inline(rng, value):
    """A value in one line, lists at times over several."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key(rng, n)} = {inline(None, v)}" for n, v in value.items()) + " }"
    if isinstance(value, list):
        gap = "\n  " if rng is not None and rng.random() < 0.2 else " "
        return f"[{gap}" + f",{gap}".join(inline(None, part) for part in value) + " ]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        plain = "'" not in value and rng is not None and rng.random() < 0.5
        return f"'{value}'" if plain else '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return repr(value)


def key(rng, name):
    """A key, at times in quotes."""
    return f'"{name}"' if rng is not None and rng.random() < 0.15 else name


def remark(rng):
    """At times one behind a value."""
    return "  # [not a table] = 1" if rng.random() < 0.15 else ""


def shuffled(rng, table):
    """Names of a table in any order."""
    return [str(name) for name in rng.permutation(list(table))]
