"""run_mpi.sh: refused arguments, arguments and signals passed on, with a stand-in for the program."""

import re
import shutil
import signal
import subprocess
import time
import tomllib
from pathlib import Path

import pytest
from support import ROOT, is_line_with

ECHO = """\
import os, sys
from mpi4py import MPI
world = MPI.COMM_WORLD
if world.rank == 0:
    print("ARGS", sys.argv[1:], "SIZE", world.size, "CWD", os.getcwd(), "PYTHON", sys.executable)
    print("OMP", os.environ["OMP_NUM_THREADS"], "HOME", os.environ.get("PYTHONHOME"))
    print("VENV", os.environ.get("VIRTUAL_ENV"))
    print(sorted(name for name in os.environ if "_MCA_" in name))
sys.exit(int(os.environ.get("STATUS", "0")))
"""


AT_ONCE = {"OMPI_MCA_odls_base_sigkill_timeout": "0"}  # where no rank is left for mpirun to wait for


@pytest.fixture
def script(tmp_path):
    """A copy of the script beside a stand-in for the package."""
    (tmp_path / "ehlpetsc" / "base").mkdir(parents=True)
    (tmp_path / "ehlpetsc" / "__init__.py").touch()
    (tmp_path / "ehlpetsc" / "__main__.py").write_text(ECHO)
    shutil.copy(ROOT / "run_mpi.sh", tmp_path)
    shutil.copy(ROOT / "ehlpetsc" / "base" / "environment.py", tmp_path / "ehlpetsc" / "base")
    (tmp_path / "elsewhere").mkdir()

    def run(*arguments, **environment):
        outside_mpi = {"PATH": "/usr/bin:/bin", **environment}  # these tests may themselves run under mpirun
        pipes = {"capture_output": True, "text": True, "timeout": 120}
        words = [tmp_path / "run_mpi.sh", *arguments]
        return subprocess.run(words, cwd=tmp_path / "elsewhere", env=outside_mpi, **pipes)

    return run


@pytest.mark.parametrize("ranks, table", [(1, "[time]"), (2, "[series]")])
def test_default_ranks_folder_and_python(script, tmp_path, ranks, table):
    (tmp_path / "elsewhere" / "my case.toml").write_text(f"title = 'x'\n{table}\n")
    done = script("my case.toml")
    assert done.returncode == 0
    assert f"ARGS ['my case.toml'] SIZE {ranks}" in done.stdout
    assert "/elsewhere PYTHON /usr/bin/python3" in done.stdout
    assert "OMP 1" in done.stdout
    assert done.stderr == ""


@pytest.mark.parametrize("status", [1, 4])
def test_options_after_the_case_and_the_exit_status_are_passed_on_silently(script, status):
    options = ["-n", "7", "-h", "-snes_monitor", "-options_left", "--set", "title=two words"]
    done = script("-n", "1", "case.toml", *options, STATUS=str(status), **AT_ONCE)
    assert f"ARGS {['case.toml', *options]} SIZE 1" in done.stdout
    assert (done.returncode, done.stderr) == (status, "")


def test_every_word_of_the_linked_command_goes_to_the_program(script, tmp_path):
    assert "ARGS ['python', 'mine.py', '-n'] SIZE 1 " in script("python", "mine.py", "-n").stdout
    script("--commands", "linked")
    linked = [tmp_path / "elsewhere" / "linked" / "ehlpetsc", "python", "mine.py"]
    done = subprocess.run(linked, cwd=tmp_path / "elsewhere", capture_output=True, text=True, check=True)
    assert "ARGS ['python', 'mine.py'] SIZE 1 " in done.stdout


WAITING = """\
import os, pathlib, signal, sys, time
from mpi4py import MPI
received = []
signal.signal(signal.SIGUSR1, lambda number, frame: received.append(number))
pathlib.Path(f"ready{MPI.COMM_WORLD.rank}").touch()
while not MPI.COMM_WORLD.allreduce(len(received)) or "deaf" in sys.argv:
    time.sleep(0.05)
print("RANK", MPI.COMM_WORLD.rank, "SIGNALLED", flush=True)
sys.exit(4)
"""


@pytest.mark.parametrize("name", ["SIGUSR1", "SIGTERM"])
def test_signal_reaches_every_rank(script, tmp_path, name, ranks=2):
    done = signalled(script, tmp_path, ranks, [name], "case.toml")
    assert done.returncode == 4, done.stderr
    assert sorted(done.stdout.splitlines()) == [f"RANK {rank} SIGNALLED" for rank in range(ranks)]
    assert done.stderr == ""


def test_signal_before_the_start_ends_with_status_4(script, tmp_path):
    """To the script while it looks for packages, and to ranks without a signal handler."""
    for wait in (False, True):
        program = "import pathlib, time\npathlib.Path('ready0').touch()\ntime.sleep(30)\n"
        done = signalled(script, tmp_path, 1, ["SIGINT"], "case.toml", program=program, wait=wait)
        assert (done.returncode, done.stdout) == (4, "")
        assert is_line_with(done.stderr, "run_mpi.sh: stopped ")


def signalled(script, tmp_path, ranks, names, *arguments, program=WAITING, wait=True):
    """Run the script and send it signals, once all ranks have started or as soon as it has a handler."""
    (tmp_path / "ehlpetsc" / "__main__.py").write_text(program)
    command = [tmp_path / "run_mpi.sh", "-n", str(ranks), *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    pipes["preexec_fn"] = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # ignored in a shell's job
    folder, environment = tmp_path / "elsewhere", {"PATH": "/usr/bin:/bin"} | (AT_ONCE if ranks == 1 else {})
    with subprocess.Popen(command, cwd=folder, env=environment, **pipes) as job:
        for _ in range(3000):
            if len(list(folder.glob("ready*"))) == ranks if wait else catches(job.pid, signal.SIGUSR1):
                break
            time.sleep(0.02)
        for number, name in enumerate(names):
            time.sleep(1.0 if number else 0.0)
            job.send_signal(signal.Signals[name])
        try:
            stdout, stderr = job.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            job.kill()  # or the test would wait for ever
            raise
    return subprocess.CompletedProcess(command, job.returncode, stdout, stderr)


def catches(pid, number):
    """Whether a process has a handler of a signal."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16) >> (number - 1) & 1


@pytest.mark.parametrize(
    "arguments", [["-n"], ["-n", "0", "c.toml"], ["-n", "two", "c.toml"], ["-v", "c.toml"]]
)
def test_bad_arguments_end_with_status_2(script, arguments):
    done = script(*arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("run_mpi.sh: -")


@pytest.fixture
def machine(script, tmp_path):
    """The script without a package on a system of any name, with stand-ins for apt-get and id."""
    tools, log = tmp_path / "tools", tmp_path / "log"
    tools.mkdir()
    for name, body in (("apt-get", f'echo "$@" >>{log}'), ("id", 'echo "$USER_ID"')):
        (tools / name).write_text(f"#!/bin/sh\n{body}\n")
        (tools / name).chmod(0o755)
    path = tmp_path / "run_mpi.sh"
    text = path.read_text().replace("PATH=/usr/sbin", f"PATH={tools}:/usr/sbin", 1)
    text = text.replace("/etc/os-release", str(tmp_path / "os-release"))

    def run(user, system, wanted="nonesuch"):
        (tmp_path / "os-release").write_text(system)
        path.write_text(text.replace('run_modules="', f'run_modules="{wanted} ', 1))
        done = script("case.toml", USER_ID=str(user))
        return done, log.read_text().splitlines() if log.exists() else []

    return run


DEBIAN = 'ID=debian\nVERSION_ID="13"\nPRETTY_NAME="Debian GNU/Linux 13 (trixie)"\n'


@pytest.mark.parametrize("system", [DEBIAN, DEBIAN.replace("13", "12"), "ID=debian\n"])
def test_user_without_root_gets_the_install_command(machine, system):
    done, typed = machine(1000, system)
    install = "apt-get install -y --no-install-recommends python3-nonesuch"
    assert done.returncode == 2
    assert done.stdout == f"sudo apt-get update && sudo {install}\n"
    assert typed == []


def test_install_brings_what_pictures_import_and_root_waits_for_the_apt_lock(machine):
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    lists = re.findall(r'^(?:run_modules|drawing)="(.*?)"', (ROOT / "run_mpi.sh").read_text(), re.MULTILINE)
    assert {re.match(r"\w+", name)[0] for name in extras["post"]} <= set(" ".join(lists).split())
    done, (update, install) = machine(0, DEBIAN)
    assert "installing python3-nonesuch" in done.stderr
    assert update == "-o DPkg::Lock::Timeout=600 update"
    assert install.startswith("-o DPkg::Lock::Timeout=600 install -y --no-install-recommends")
    assert install.endswith(" python3-nonesuch")
    assert done.returncode == 2  # what was asked for is still not there
    assert done.stderr.endswith(": nonesuch\n")


def test_complete_python_on_the_path_is_used(script, tmp_path):
    debians = next(Path("/usr/lib/petscdir").glob("petsc*/*-real/lib/python3/dist-packages/petsc4py"))
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "petsc4py").symlink_to(debians)  # as of another PETSc: not on Debian's path
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python3").symlink_to("/usr/bin/python3")
    path = f"{tmp_path / 'bin'}:/usr/bin:/bin"
    done = script("case.toml", PATH=path, PYTHONPATH=str(tmp_path / "own"), VIRTUAL_ENV="own")
    assert done.returncode == 0, done.stderr
    assert f"PYTHON {tmp_path / 'bin' / 'python3'}" in done.stdout
    assert "VENV own" in done.stdout


def test_command_link_starts_ranks_in_any_folder(script, tmp_path):
    folder = tmp_path / "some where" / "bin"
    for _ in range(2):  # the second time it is there
        done = script("--commands", str(folder))
        assert done.returncode == 0 and f'export PATH="{folder}:$PATH"' in done.stderr
    path, words = {"PATH": f"{folder}:/usr/bin:/bin"}, ["-n", "2", "case.toml", "a b"]
    pipes = {"capture_output": True, "text": True, "timeout": 60}
    done = subprocess.run(["ehlpetsc", *words], cwd=tmp_path, env=path, **pipes)
    assert f"ARGS ['case.toml', 'a b'] SIZE 2 CWD {tmp_path} " in done.stdout, done.stderr


def is_open_mpi_4():
    done = subprocess.run(["mpirun", "--version"], capture_output=True, text=True)
    return "(Open MPI) 4." in done.stdout


@pytest.mark.skipif(not is_open_mpi_4(), reason="settings that make the launcher of Open MPI 4 refuse")
@pytest.mark.parametrize(
    "settings, words",
    [
        ({"OMPI_MCA_orte_default_hostfile": "{hosts}"}, ["not enough slots available", "; try -n 1"]),
        ({"OMPI_MCA_btl": "nonsense"}, ["A requested component was not found", "Component: nonsense"]),
        ({"OMPI_MCA_plm": "nonsense"}, ["A requested component was not found", "Framework: plm"]),
    ],
)
def test_refusal_of_the_launcher_is_one_sentence(script, tmp_path, settings, words):
    (tmp_path / "hosts").write_text("localhost slots=1\n")
    settings = {name: value.format(hosts=tmp_path / "hosts") for name, value in settings.items()}
    done = script("-n", "2", "case.toml", **settings)
    assert (done.returncode, done.stdout) == (2, "")
    assert is_line_with(done.stderr, "run_mpi.sh: mpirun: ", *words)
