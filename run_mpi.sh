#!/bin/bash
# Runs a case, or the tests, under MPI, with what the machine has; installs what is missing on Debian 12 and newer.
# shellcheck disable=SC1091,SC2046,SC2086  # lists of names without blanks are meant to be split
set -eu

usage() {
    cat <<'END'
./run_mpi.sh [-n RANKS] CASE.toml [PETSc options]   run a case; without -n one contact on 1 rank, a series on 2
./run_mpi.sh explain CASE.toml                      a case in words: film, run time, file size; nothing is run
./run_mpi.sh plot|post|summary|compare|gears|life ...    the same as ehlpetsc plot ..., each with -h
./run_mpi.sh docs [FOLDER]                          the pages as one site, opened in a browser or built there
./run_mpi.sh test                                   run the whole test suite, serial and under mpirun
./run_mpi.sh --install                              install what is missing for runs and pictures, nothing else
./run_mpi.sh --commands FOLDER                      put the command ehlpetsc (on one rank; ehlpetsc plot,
                                                    post ...) into a folder of your PATH, as ~/.local/bin

A python3 on the PATH that has everything is used. Else it is Debian's, and what is missing is installed from
Debian's packages: by itself as root, else the command is shown.
Own options and PETSc's: ./run_mpi.sh CASE.toml -help
Exit status: 0 done, 1 bug, 2 bad input, 3 no convergence, 4 stopped and restart file written.
END
}

# what cannot be imported -> the Debian packages that have it
declare -A package_of=([h5py]="python3-h5py python3-h5py-mpi" [petsc4py]=python3-petsc4py-real [mpirun]=openmpi-bin
    [xdist]=python3-pytest-xdist [myst_parser]=python3-myst-parser [furo]="furo libjs-mathjax")
run_modules="numpy scipy numba mpi4py h5py petsc4py"
drawing="matplotlib xarray h5netcdf" # pictures, reading of results
site="sphinx myst_parser furo" # the pages as one site
testing="$drawing plotly pytest xdist hypothesis pip hatchling"

commands="ehlpetsc"
called=$(basename "$0")
here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd -P)
check="$here/ehlpetsc/environment.py"
test_only="$here/.test-packages" # what the tests compare with and Debian does not have
debian_python=/usr/bin/python3
export HOME=${HOME:-/} # Open MPI 5 does not start without one
apt="apt-get -o DPkg::Lock::Timeout=600"

say() { echo "run_mpi.sh: $*" >&2; }

# Sets python and mpirun, with the modules of the first list there, or the way to them told; where something is
# installed, those of the second come with it
prepare() {
    local modules=$1 also=${2-} missing
    local -x PYTHONDONTWRITEBYTECODE=1
    python=$(command -v python3 || true) mpirun=mpirun
    # one that is not Debian's: a virtual environment, modules of a cluster, PETSC_DIR
    if [ -n "$python" ] && PYTHONPATH="$here${PYTHONPATH:+:$PYTHONPATH}" "$python" "$check" own $modules 2>/dev/null; then
        command -v mpirun >/dev/null || { say "$python has everything, but there is no mpirun on the PATH"; exit 2; }
        export PYTHONPATH="$here${PYTHONPATH:+:$PYTHONPATH}"
    else
        use_debian
        missing=$(missing_in_debian $modules)
        if [ -n "$missing" ]; then
            is_debian || { other_machine $modules >&2; exit 2; }
            install_packages $missing $(missing_in_debian $also)
            use_debian
            missing=$(missing_in_debian $modules)
            [ -z "$missing" ] || { say "installed, but still not there: $missing"; exit 2; }
        fi
    fi
    set_environment
}

use_debian() {
    # another Python's modules, or another PETSc, must not mix with Debian's
    unset PYTHONHOME PYTHONSTARTUP VIRTUAL_ENV PETSC_ARCH PETSC_DIR
    export PATH=/usr/sbin:/usr/bin:/sbin:/bin${PATH:+:$PATH} PYTHONNOUSERSITE=1 PYTHONPATH=$here
    python=$debian_python mpirun=/usr/bin/mpirun.openmpi
    [ -x $mpirun ] || mpirun=/usr/bin/mpirun
    local petsc
    petsc=$(printf '%s\n' /usr/lib/petscdir/petsc*/*-real | sort -V | tail -n 1)
    [ ! -d "$petsc" ] || export PETSC_DIR=$petsc PYTHONPATH="$here:$petsc/lib/python3/dist-packages"
}

missing_in_debian() {
    [ -x $mpirun ] || echo mpirun
    [ ! -x $python ] || { $python "$check" missing "$@" && return; }
    printf '%s\n' python "$@"
}

is_debian() {
    local ID="" VERSION_ID=""
    [ ! -r /etc/os-release ] || . /etc/os-release
    [ "$ID" = debian ] && [ "${VERSION_ID:-99}" -ge 12 ] && command -v apt-get >/dev/null
}

install_packages() {
    local packages="" name
    for name in $(printf '%s\n' "$@" | awk '!seen[$0]++'); do
        packages+=" ${package_of[$name]-python3-$name}"
    done
    packages=${packages/ python3-python/ python3}
    local install="install -y --no-install-recommends$packages"
    if [ "$(id -u)" != 0 ]; then
        say "these Debian packages are missing. Type this, then run again:"
        echo "sudo apt-get update && sudo apt-get $install"
        exit 2
    fi
    say "installing$packages"
    export DEBIAN_FRONTEND=noninteractive
    { update_lists && quietly $apt $install; } || { say "installation failed"; exit 2; }
    say "installed"
}

# What a machine has that is neither Debian nor prepared
other_machine() {
    local PRETTY_NAME="an unknown system" found
    [ ! -r /etc/os-release ] || . /etc/os-release
    found=$(python3 "$check" found "$@" 2>/dev/null || command -v python3 || echo "no python3")
    cat <<END
run_mpi.sh: something is missing, and this is not Debian 12 or newer, where it could be installed.
found:   $PRETTY_NAME; $found; $(mpirun --version 2>/dev/null | head -n 1 || true)
needed:  Python 3.11 or newer with numpy, scipy, numba, h5py, mpi4py and petsc4py, on PETSc 3.18 or
         newer of real numbers in double precision, and the mpirun of the MPI that mpi4py and petsc4py were built with
to go on, make them the first on the PATH and run the same command again:
  a cluster: module load ... (module avail petsc), until python3 -c 'import petsc4py, mpi4py, h5py' works
  PETSc of your own, built with petsc4py: export PETSC_DIR=... PETSC_ARCH=...
  a virtual environment: pip install '${here}[solver,post]' (builds PETSc from source), then activate it
  a container: tests/Containerfile
END
}

set_environment() {
    # without these, threads of BLAS fight the ranks for the cores
    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    # mpirun gives every rank a terminal, also where the output goes to a file
    [ -t 1 ] || export TERM=dumb
    [ -z "${OMPI_COMM_WORLD_SIZE-}${PMI_SIZE-}${PMIX_RANK-}" ] || return 0 # under mpirun, which has set the rest
    # Open MPI 4 | 5; another MPI does not read them. No binding, as runs side by side would share a core.
    export OMPI_MCA_hwloc_base_binding_policy=none PRTE_MCA_hwloc_default_binding_policy=none
    export OMPI_MCA_orte_execute_quiet=1
    if [ "$(id -u)" = 0 ]; then
        export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    fi
    [ "$(nodes)" = 1 ] || return 0
    # shared memory alone, by copies that a container allows, and no wait for a network or munge
    export OMPI_MCA_btl=${OMPI_MCA_btl:-^tcp,ofi,openib,uct}
    export OMPI_MCA_btl_vader_single_copy_mechanism=${OMPI_MCA_btl_vader_single_copy_mechanism:-none}
    export OMPI_MCA_smsc=${OMPI_MCA_smsc:-^cma}
    export PMIX_MCA_psec=${PMIX_MCA_psec:-native} PMIX_MCA_gds=${PMIX_MCA_gds:-hash}
}

# Machines that a batch system has given
nodes() {
    local list=${PBS_NODEFILE:-${PE_HOSTFILE:-${LSB_DJOB_HOSTFILE-}}}
    if [ -n "${SLURM_JOB_NUM_NODES-}" ]; then
        echo "$SLURM_JOB_NUM_NODES"
    elif [ -r "$list" ]; then
        cut -d ' ' -f 1 "$list" | sort -u | wc -l
    else
        echo 1
    fi
}

cores() {
    lscpu --parse=CORE | grep -v '^#' | sort -u | wc -l
}

# nproc would count the threads of BLAS
processors() {
    env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc
}

# A rank that waits yields its core to the rank it waits for where there are more ranks than cores, and else before
# Linux 6.6 alone: since then it comes back after a whole turn of the others, so that two ranks beside one busy process
# take ten times as long as without
settings_of_ranks() {
    local yields=1 policy=none processors
    [ "$(nodes)" = 1 ] || return 0
    processors=$(processors)
    if [ "$1" -le "$processors" ] && printf '%s\n' 6.6 "$(uname -r)" | sort -C -V; then yields=0; fi
    : "${users_yield=${OMPI_MCA_mpi_yield_when_idle-}}" # as it was before the first call
    export OMPI_MCA_mpi_yield_when_idle=${users_yield:-$yields}
    # a rank on every core: each keeps its own, as beside a busy process they would be moved onto one in turns
    if [ "$1" -gt 1 ] && [ "$1" = "$processors" ] && [ "$1" = "$(cores)" ]; then policy=core; fi
    export OMPI_MCA_hwloc_base_binding_policy=$policy PRTE_MCA_hwloc_default_binding_policy=$policy
    if [ "$1" -gt "$processors" ]; then
        export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
    fi
}

# A list that another apt is fetching: DPkg::Lock::Timeout is for the packages alone
update_lists() {
    local log status
    log=$(mktemp)
    for _ in {1..120}; do
        status=0
        LC_ALL=C $apt update >"$log" 2>&1 </dev/null || status=$?
        if [ $status = 0 ] || ! grep -q "Could not get lock" "$log"; then break; fi
        sleep 5
    done
    [ $status = 0 ] || cat "$log" >&2
    rm -f "$log"
    return $status
}

# Output only of what goes wrong
quietly() {
    local log status=0
    log=$(mktemp)
    "$@" >"$log" 2>&1 </dev/null || status=$?
    [ $status = 0 ] || cat "$log" >&2
    rm -f "$log"
    return $status
}

# What Open MPI 5 cannot be kept from saying when a run ends with a status of its own, which the run has explained, or
# of the request to stop, which this script explains
without_mpiruns_comment() {
    trap '' INT TERM HUP USR1
    exec awk '
        function flush_held() { printf "%s", held; held = ""; fflush() }
        function comment() { # its lines are broken anywhere
            gsub(/[ \n]+/, " ", text)
            return text ~ /prterun detected that one or more processes exited with non-zero status/ ||
                text ~ /prterun noticed that process rank .* exited on signal 10 /
        }
        /^\[[^ ]*\] PMIX ERROR: PMIX_ERR_UNREACH/ { next }
        /^-+$/ && length($0) > 70 {
            if (held == "") { held = $0 "\n"; next }
            text = held
            if (comment()) held = ""; else held = held $0 "\n"
            flush_held(); next
        }
        held == "" { print; fflush(); next }
        { held = held $0 "\n" }
        END { text = held; if (!comment()) flush_held() }'
}

# One rank for one contact unless the gain is certain: a large mesh, and two idle cores. Faults are told by the run
worthwhile_ranks() {
    local told
    told=$("$python" -m ehlpetsc --ranks "$@" 2>/dev/null) || true
    [ "$told" = 2 ] && echo 2 || echo 1
}

# mpirun ends a run whose reader has gone, as `head -1` does
outliving_its_reader() {
    trap '' INT TERM HUP USR1 PIPE
    cat 2>/dev/null || { say "standard output is lost (Broken pipe); continuing without it"; exec cat >/dev/null; }
}

# mpirun loses what comes before its ranks are there; the run takes the same request twice as one
ask_until_heard() {
    trap '' INT TERM HUP USR1
    exec >/dev/null 2>&1
    while kill -USR1 "$1"; do sleep 2; done
}

stopped_early() {
    say "stopped before the run had begun; nothing to continue from"
    exit 4
}

# SIGTERM to mpirun kills the ranks within a second; SIGUSR1 it hands on, and they stop after the step in hand.
# Hence a session of its own, which Ctrl-C does not reach, and a death signal should this script be killed.
run_case() {
    local status=0 comments copier="" asked="" killed=""
    settings_of_ranks "$ranks"
    if [ -p /dev/stdout ]; then
        exec > >(outliving_its_reader)
        copier=$!
    fi
    exec {comments}> >(without_mpiruns_comment >&2)
    local filter=$!
    setsid setpriv --pdeathsig TERM "$mpirun" -n "$ranks" "$python" -m ehlpetsc "$@" </dev/null 2>&$comments &
    local job=$!
    exec {comments}>&-
    trap 'asked=1; ask_until_heard $job & trap "killed=143; kill -TERM $job" INT TERM' INT TERM HUP USR1
    wait $job || status=$?
    while kill -0 $job 2>/dev/null; do # a signal ends wait, not mpirun
        status=0
        wait $job || status=$?
    done
    exec >&-
    wait $filter $copier || true
    status=${killed:-$status} # Open MPI 5 ends with 1 when it is killed
    # of SIGUSR1 only mpirun and a Python die that have hardly begun: the run takes it as a request
    if [ -n "$asked" ] && [ $status = 138 ]; then stopped_early; fi
    [ $status -lt 129 ] || say "a rank was ended by signal $((status - 128))"
    exit $status
}

# Rank 0 reports; what the others say is shown only when something failed
run_mpi_tests() {
    local ranks=$1 status=0 logs
    logs=$(mktemp -d)
    say "tests on $ranks rank(s)"
    settings_of_ranks "$ranks"
    # shellcheck disable=SC2016
    timeout 1800 "$mpirun" -n "$ranks" /bin/sh -c '
        rank=${OMPI_COMM_WORLD_RANK:-${PMI_RANK:-$PMIX_RANK}}
        [ "$rank" = 0 ] || exec >"$1/rank$rank.log" 2>&1
        shift; exec "$@"' sh "$logs" "$python" -m pytest -p no:cacheprovider -q --color=no -m mpi tests/mpi || status=$?
    if [ $status != 0 ]; then
        find "$logs" -name '*.log' -exec tail -n 50 {} +
        say "tests on $ranks rank(s) failed"
    fi
    rm -rf "$logs"
    return $status
}

run_tests() {
    cd "$here"
    if [ ! -d "$test_only/rainflow" ] && [ ! -e "$test_only/rainflow.py" ]; then
        say "fetching rainflow 3.2.0 from PyPI for the tests alone"
        quietly "$python" -m pip install --retries 1 --no-deps --target "$test_only" rainflow==3.2.0 ||
            say "PyPI cannot be reached: the comparison with its rainflow is left out"
    fi
    export PYTHONPATH="$PYTHONPATH:$test_only"
    # more processes than two cores: many tests wait for a signal, or for mpirun to end
    "$python" -m pytest -p no:cacheprovider -q -n 3 --dist loadfile -m "not mpi" "${@:-tests}"
    for ranks in 1 2 3; do run_mpi_tests $ranks; done
}

# Links to this script, which then knows by its name what to do
write_commands() {
    local folder=$1 name path
    [ -n "$folder" ] || { say "--commands: name a folder of your PATH, as ~/.local/bin"; exit 2; }
    { mkdir -p -- "$folder" 2>/dev/null && folder=$(CDPATH='' cd -- "$folder" && pwd) && [ -w "$folder" ]; } ||
        { say "$1 is no folder that can be written to"; exit 2; }
    for name in $commands; do
        path=$folder/$name
        if [ -e "$path" ] || [ -L "$path" ]; then
            [ "$(basename -- "$(readlink -- "$path")")" = run_mpi.sh ] ||
                { say "$path is there and is none of these commands: nothing was written"; exit 2; }
        fi
    done
    for name in $commands; do
        ln -sfn -- "$here/run_mpi.sh" "$folder/$name" || exit 2
    done
    say "in $folder: $commands"
    case :$PATH: in
        *:"$folder":*) ;;
        *) say "not on your PATH yet; type: export PATH=\"$folder:\$PATH\"" ;;
    esac
}

if [[ " $commands " = *" $called "* ]]; then # by a link of write_commands
    prepare "$run_modules" "$drawing"
    exec "$python" -m ehlpetsc "$@"
fi

ranks=""
if [ "${1-}" = -n ]; then
    ranks=${2-}
    [[ $ranks =~ ^[1-9][0-9]{0,4}$ ]] || { say "-n $ranks: allowed: a whole number of ranks, at least 1"; exit 2; }
    shift 2
fi
case ${1-} in
    "") usage; exit 2 ;;
    -h | --help | -help) usage; exit 0 ;;
    --install) prepare "$run_modules $drawing" ;;
    --commands) write_commands "${2-}" ;;
    -*) say "$1 stands before the case file"; usage >&2; exit 2 ;;
    plot | post | summary | compare | gears | life | ensemble | explain | keys | template | docs | python | --version)
        [ "$1" != docs ] || run_modules+=" $site"
        prepare "$run_modules" "$drawing"
        exec "$python" -m ehlpetsc "$@"
        ;;
    test)
        prepare "$run_modules $testing"
        run_tests "${@:2}"
        ;;
    *)
        trap stopped_early INT TERM HUP USR1
        prepare "$run_modules" "$drawing"
        [ -n "$ranks" ] || ranks=$(worthwhile_ranks "$@")
        run_case "$@"
        ;;
esac
