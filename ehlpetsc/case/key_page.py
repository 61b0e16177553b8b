"""Text of every key of a case file, generated from the schema: list, page, commented example case."""

import json

from ehlpetsc.case.faults import allowed
from ehlpetsc.case.loading import Case
from ehlpetsc.case.schema.equations import EQUATIONS, SYMBOLS
from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.tables.surface import SYNTHETIC
from ehlpetsc.command_parser import CommandParser, exit_status, put
from ehlpetsc.errors import UsageError

# keys that are required or set in almost every case: Table 1 of Holmes et al. 2005
EXAMPLE = {
    "title": '"My contact"',
    "contact.radius": "0.0191",
    "contact.load": "527e3",
    "contact.youngs_modulus": "[207e9, 207e9]",
    "contact.poisson_ratio": "[0.3, 0.3]",
    "contact.boundary_friction": "0.1",
    "contact.model": '"mixed"',
    "fluid.viscosity": "0.005",
    "fluid.law": '"roelands"',
    "fluid.pressure_viscosity": "11.1e-9",
    "fluid.density": '"dowson-higginson"',
    "fluid.eyring_stress": "10e6",
    "motion.entrainment_speed": "5.0",
    "motion.slide_roll_ratio": "0.25",
    "mesh.inlet": "-2.5",
    "mesh.outlet": "1.5",
    "mesh.points_per_half_width": "200",
    "time.travel": "6.0",
}
PAGE = """# Every key of a case file

`ehlpetsc keys` prints them too, `ehlpetsc keys fluid` those of one table, `ehlpetsc keys contact.load` a key,
`ehlpetsc template` a commented case to begin from. Numbers are in SI units; a value may also be written with
its unit: `load = "350 N/mm"`, `viscosity = "15 mPa s"` (this needs the package pint). Unknown keys, values
out of bounds, nan and inf are rejected. A key whose default is "none" is required where its table is. Made
from the schema by `python3 -m ehlpetsc.case.key_page > cases/keys.md`.
"""


def tables():
    """Tables of a case file with their models, in the order of the file.

    Returns
    -------
    dict of str to type
        By dotted name, "" for the keys above all tables; kinds of synthetic profiles as
        ``surface.1.synthetic (ridge)``.
    """
    models = {"": Case}
    for name, model in _below(Case):
        models[name] = model
        if name == "surface.1":
            models |= {f"{name}.synthetic ({kind})": profile for kind, profile in SYNTHETIC.items()}
    return models


def _below(model, above=""):
    for field in model.__fields__.values():
        if _is_table(field):
            name = above + field.alias
            if _keys(field.type_):
                yield name, field.type_
            yield from _below(field.type_, name + ".")


def _is_table(field):
    return isinstance(field.type_, type) and issubclass(field.type_, Table)


def _keys(model):
    return [field for field in model.__fields__.values() if not _is_table(field)]


def _default(field):
    if field.required:
        return "none"
    return "left out" if field.default is None else json.dumps(field.default)


def _equation(model, field):
    return EQUATIONS.get(f"{model.__name__}.{field.alias}", "")


def keys(table=None):
    """Keys with allowed values and default, a line each, followed by the equation in which they appear.

    Parameters
    ----------
    table : str, optional
        Single table, as in "fluid" or "surface.1", or single key, as in "contact.load".

    Raises
    ------
    UsageError
        There is no such table or key.
    """
    models = tables()
    if table is not None:
        above, _, key = table.rpartition(".")
        fields = [field for field in _keys(models[above]) if field.alias == key] if above in models else []
        if fields:
            return "\n".join(_lines(models[above], fields))
        models = {name: models[name] for name in models if name == table or name.startswith(f"{table}.")}
        if not models:
            names = [name for name in tables() if name and " " not in name]
            raise UsageError(f"keys {table}: no such table or key; tables: {', '.join(names)}")
    lines = []
    for name, model in models.items():
        lines += [f"[{name}]" if name else "above all tables", *_lines(model, _keys(model))]
    return "\n".join(lines)


def _lines(model, fields):
    for field in fields:
        yield f"  {field.alias}: {allowed(field)}; default: {_default(field)}"
        if _equation(model, field):
            yield f"      {_equation(model, field)}"


def page():
    """Markdown page of all keys."""
    texts = [PAGE, SYMBOLS]
    for name, model in tables().items():
        heading = f"`[{name}]`" if name else "Above all tables"
        equations = any(_equation(model, field) for field in _keys(model))
        head = ["key", "takes", "default", *["equation"] * equations]
        texts.append(f"\n## {heading}\n\n{_row(head)}{'|---' * len(head)}|\n")
        for field in _keys(model):
            cells = [f"`{field.alias}`", allowed(field), _default(field)]
            cells += [_equation(model, field)] * equations
            texts.append(_row([cell.replace("|", r"\|").replace("*", r"\*") for cell in cells]))
    return "".join(texts)


def _row(cells):
    return "| " + " | ".join(cells) + " |\n"


def template():
    """Text of a complete case with all other keys in comments."""
    lines = []
    for name, model in tables().items():
        written = [EXAMPLE.get(f"{name}.{f.alias}" if name else f.alias) for f in _keys(model)]
        if name in ("surface.2", "post", "petsc", "series") or " (" in name:
            continue
        if name:
            lines += ["", f"[{name}]" if any(written) else f"# [{name}]"]
        for field, value in zip(_keys(model), written, strict=True):
            if isinstance(field.default, dict):
                continue
            shown = value or ("..." if field.default is None else json.dumps(field.default))
            lines.append(f"{'' if value else '# '}{field.alias} = {shown}  # {allowed(field)}")
    return "\n".join(lines) + "\n"


def main(words: list[str]) -> int:
    """Run the command ``ehlpetsc keys``; returns its exit status."""
    parser = CommandParser("keys", "Keys of a case file: meaning, unit, bounds, default.")
    parser.add_argument("table", nargs="?", metavar="TABLE or TABLE.KEY", help="default: all")
    chosen = parser.parse_args(words)
    return exit_status("keys", lambda: put(keys(chosen.table), chosen))


def main_template(words: list[str]) -> int:
    """Run the command ``ehlpetsc template``; returns its exit status."""
    chosen = CommandParser("template", "A commented case file to begin with.").parse_args(words)
    return exit_status("template", lambda: put(template(), chosen))


if __name__ == "__main__":
    print(page(), end="")
