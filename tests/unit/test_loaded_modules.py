"""A scene loads what it needs."""

import subprocess
import sys

from support import CASES
from support.running import BARE, SCRIPT

MAX_MODULES = 110
CODE = """
import sys
from ehlpetsc.__main__ import main
status = main(sys.argv[1:])
print(status, *sorted(name for name in sys.modules if name.startswith("ehlpetsc")), sep="\\n")
"""


def test_smooth_dry_contact_loads_few_modules(tmp_path):
    words = [CASES / "dry_hertz.toml", "--set", "mesh.points_per_half_width=20"]
    done = subprocess.run(
        [sys.executable, "-c", CODE, *words], cwd=tmp_path, env=BARE | SCRIPT, capture_output=True, text=True
    )
    status, *modules = done.stdout[done.stdout.rindex("wall=") :].split("\n")[1:-1]
    assert status == "0", done.stderr
    assert len(modules) <= MAX_MODULES
    rooms = {name.split(".")[1] for name in modules if "." in name}
    assert not rooms & {"post", "life", "analysis", "pictures"}
    unneeded = {"series", "passes", "explain", "gauss_seidel", "mixed", "synthetic", "path"}
    assert not {name.rpartition(".")[2] for name in modules} & unneeded
