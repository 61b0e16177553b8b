#!/bin/bash
# Runs a case, a command or the tests with what the machine has; installs what is missing on Debian 12 and newer.
# shellcheck disable=SC1091,SC2046,SC2086  # lists of names without blanks are meant to be split
set -eu

usage() {
    cat <<'END'
./run_mpi.sh [-n RANKS] CASE.toml [options]         run a case; without -n one contact on 1 rank, a series on 2
./run_mpi.sh COMMAND ...                            as ehlpetsc COMMAND, see below
./run_mpi.sh test [TESTS]                           run the test suite, serial and under mpirun
./run_mpi.sh docs [FOLDER]                          open the pages as one site, or build it in a folder
./run_mpi.sh --install                              install what is missing for runs and pictures, nothing else
./run_mpi.sh --commands FOLDER                      link the command ehlpetsc into a folder, one of your PATH

A python3 on the PATH that has everything is used. Otherwise it is Debian's, and what is missing is installed from
Debian's packages: by this script as root, else the command is shown.

END
    PYTHONPATH=$here python3 -m ehlpetsc -h 2>/dev/null || true
}

# what cannot be imported -> the Debian packages that have it
declare -A package_of=([h5py]="python3-h5py python3-h5py-mpi" [petsc4py]=python3-petsc4py-real [mpirun]=openmpi-bin
    [xdist]=python3-pytest-xdist [myst_parser]=python3-myst-parser [furo]="furo libjs-mathjax" [python]=python3)
run_modules="numpy scipy numba mpi4py h5py petsc4py"
drawing="matplotlib plotly xarray h5netcdf" # pictures, reading of results
site="sphinx myst_parser furo" # the pages as one site
testing="$drawing pytest xdist hypothesis pip hatchling"

here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd -P)
check="$here/ehlpetsc/base/environment.py"
export HOME=${HOME:-/} # Open MPI 5 does not start without one
apt="apt-get -o DPkg::Lock::Timeout=600"

say() { echo "run_mpi.sh: $*" >&2; }

# Set python and mpirun, with the modules of the first list; where something is installed, those of the second too
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
            is_debian || { other_machine $modules; exit 2; }
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
    python=/usr/bin/python3 mpirun=/usr/bin/mpirun.openmpi
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
    local install="install -y --no-install-recommends" name
    for name in $(printf '%s\n' "$@" | awk '!seen[$0]++'); do
        install+=" ${package_of[$name]-python3-$name}"
    done
    if [ "$(id -u)" != 0 ]; then
        say "these Debian packages are missing. Type this, then run again:"
        echo "sudo apt-get update && sudo apt-get $install"
        exit 2
    fi
    say "installing${install#*recommends}"
    export DEBIAN_FRONTEND=noninteractive LC_ALL=C
    quietly $apt update && quietly $apt $install || { say "installation failed"; exit 2; }
    say "installed"
}

# Output only of what goes wrong
quietly() {
    local log
    log=$("$@" 2>&1 </dev/null) || { echo "$log" >&2; return 1; }
}

# For a machine that is neither Debian nor prepared
other_machine() {
    say "packages are missing, and this is not Debian 12 or newer, where they could be installed.
found:   $(command -v python3 || echo "no python3"), without $(python3 "$check" missing "$@" 2>/dev/null | paste -sd " ")
needed:  Python 3.11 or newer with ${run_modules// /, }, and the mpirun of their MPI, first on the PATH:
  a cluster: module load ..., until python3 -c 'import petsc4py, mpi4py, h5py' works; or export PETSC_DIR=...
  a virtual environment: pip install '${here}[wheel]' (Linux on x86-64, Python 3.12 or newer) or
    '${here}[solver,post]' (builds PETSc), then activate it
  conda-forge, a container, WSL: see README.md"
}

set_environment() {
    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 # threads of BLAS would compete with the ranks for the cores
    # mpirun gives every rank a terminal, also without one here
    if [ -t 1 ]; then export EHLPETSC_TERMINAL=1; else export TERM=dumb; fi
    [ -z "${OMPI_COMM_WORLD_SIZE-}${PMI_SIZE-}${PMIX_RANK-}" ] || return 0 # under mpirun, which has set the rest
    # Open MPI 4 | 5; another MPI does not read them. No binding, as runs side by side would share a core.
    export OMPI_MCA_hwloc_base_binding_policy=none PRTE_MCA_hwloc_default_binding_policy=none
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    export OMPI_MCA_ess_singleton_isolated=1 # no daemon for a rank without mpirun
    [ "$(nodes)" = 1 ] || return 0
    # shared memory alone, by copies that a container allows, and no wait for a network or munge
    export OMPI_MCA_btl=${OMPI_MCA_btl:-^tcp,ofi,openib,uct} OMPI_MCA_smsc=${OMPI_MCA_smsc:-^cma}
    export OMPI_MCA_btl_vader_single_copy_mechanism=${OMPI_MCA_btl_vader_single_copy_mechanism:-none}
    export PMIX_MCA_psec=${PMIX_MCA_psec:-native} PMIX_MCA_gds=${PMIX_MCA_gds:-hash}
}

# Machines that a batch system has allocated
nodes() {
    local list=${PBS_NODEFILE:-${PE_HOSTFILE:-${LSB_DJOB_HOSTFILE-}}}
    if [ -r "$list" ]; then cut -d ' ' -f 1 "$list" | sort -u | wc -l; else echo "${SLURM_JOB_NUM_NODES:-1}"; fi
}

# A waiting rank yields its core where ranks are more than cores, and before Linux 6.6: since then it comes back after
# a turn of all others, and two ranks beside a busy process take ten times as long. A rank on every core keeps its own.
settings_of_ranks() {
    local yields=1 policy=none cores
    [ "$(nodes)" = 1 ] || return 0
    cores=$(lscpu --parse=CORE | grep -v '^#' | sort -u | wc -l)
    if [ "$1" -le "$cores" ] && printf '%s\n' 6.6 "$(uname -r)" | sort -C -V; then yields=0; fi
    if [ "$1" -gt 1 ] && [ "$1" = "$cores" ]; then policy=core; fi
    : "${users_yield=${OMPI_MCA_mpi_yield_when_idle-}}" # as it was before the first call
    export OMPI_MCA_mpi_yield_when_idle=${users_yield:-$yields} OMPI_MCA_hwloc_base_binding_policy=$policy
    export PRTE_MCA_hwloc_default_binding_policy=$policy
    [ "$1" -le "$cores" ] ||
        export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
}

# Leave out the comments of Open MPI on an exit status that the run has explained, on signals that it passes on, and
# on the names of the settings above. Its other comments become their first sentence, once, with the names in them;
# status 2 where there is nothing else: the launcher has refused; 3 where it has lost its words of it, as Open MPI 4
# does once in five times.
without_comment() {
    trap '' INT TERM HUP USR1
    local left_out='(prterun|mpirun[.a-z]*)[ \n]+(detected|noticed)|^Primary job|Deprecated variable: +(hwloc|rmaps)_default_'
    left_out+='|(MPI_INIT|orte_init) failed|internal error has occurred in ORTE' # the reason comes before them
    exec awk -v left_out="$left_out" '
        function sentence(text, words, named, names, n, k, line) {
            n = split(text, line, "\n")
            for (k = 1; k <= n; k++) if (line[k] ~ /^ *[A-Z][a-z]+: +[^ ]/) names = names ", " line[k]
            sub(/\n *\n.*/, "", text); gsub(/[ \n]+/, " ", text); sub(/\. .*/, "", text); sub(/[.:] *$/, "", text)
            gsub(/ +/, " ", names)
            if (text ~ /not enough slots/) names = names "; try -n 1, or ask the batch system for more tasks"
            return "run_mpi.sh: mpirun: " text names
        }
        /^\[[^ ]*\] PMIX ERROR: PMIX_ERR_UNREACH/ || /^mpirun[.a-z]*: Forwarding signal/ { next }
        /^-+$/ && length > 50 && !inside { inside = 1; held = ""; next }
        /^-+$/ && length > 50 {
            inside = 0
            if (held ~ left_out) next
            line = sentence(held)
            if (!said[line]++) { print line; refused = 1; fflush() }
            next
        }
        inside { held = held $0 "\n"; next }
        /ORTE_ERROR_LOG: .*show_help/ { lost = 1; next }
        /^\[[^ ]*:[0-9]+\] / { of_mpi = of_mpi $0 "\n"; next }
        { print; others = 1; fflush() }
        END {
            if (inside) printf "%s", held
            if (!refused && !lost) printf "%s", of_mpi
            exit others ? 0 : refused ? 2 : lost ? 3 : 0
        }'
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

# SIGTERM to mpirun kills the ranks within a second; SIGUSR1 it passes on, and they stop after the current step.
# Hence a session of its own, which Ctrl-C does not reach, and a death signal should this script be killed.
run_ranks() {
    local status=0 asked="" refused=0 job comments filter
    settings_of_ranks "$ranks"
    exec {comments}> >(without_comment >&2)
    filter=$!
    setsid setpriv --pdeathsig TERM "$mpirun" -n "$ranks" "$python" -m ehlpetsc "$@" </dev/null 2>&$comments &
    job=$!
    exec {comments}>&-
    trap 'asked=1; ask_until_heard $job & trap "kill -TERM $job" INT TERM' INT TERM HUP USR1
    wait $job || status=$?
    while kill -0 $job 2>/dev/null; do # a signal ends wait, not mpirun
        status=0
        wait $job || status=$?
    done
    wait $filter || refused=$?
    if [ $status = 1 ] && [ $refused = 3 ]; then # a process without mpirun says the same
        "$python" -c "from mpi4py import MPI" 2>&1 >/dev/null | without_comment >&2 || refused=2
        [ $refused = 2 ] || say "mpirun: refused, and lost its reason; type the same again"
        exit 2
    fi
    if [ $status = 1 ] && [ $refused = 2 ]; then exit 2; fi
    # of SIGUSR1 only mpirun and a Python die that have hardly begun: the run takes it as a request
    if [ -n "$asked" ] && [ $status = 138 ]; then stopped_early; fi
    exit $status
}

run_tests() {
    cd "$here"
    # more processes than two cores: many tests wait for a signal, or for mpirun to end
    "$python" -m pytest -p no:cacheprovider -q -n 3 --dist loadfile -m "not mpi" "${@:-tests}"
    local chosen="mpi and not several_ranks" # one rank would be compared with itself
    for ranks in 1 2 3; do
        say "tests on $ranks rank(s)"
        settings_of_ranks $ranks
        timeout 1800 "$mpirun" -n $ranks "$python" -m pytest -p no:cacheprovider -q --color=no -m "$chosen" tests/mpi ||
            { say "tests on $ranks rank(s) failed"; exit 1; }
        chosen=mpi
    done
}

# The pages with search and typeset equations
build_site() {
    local target=${1-${XDG_CACHE_HOME:-$HOME/.cache}/ehlpetsc/docs} scratch
    scratch=$(mktemp -d)
    trap "rm -r '$scratch'" EXIT
    "$python" -m sphinx -q -W --keep-going -d "$scratch" -c "$here/.github/site" "$here" "$target" ||
        { say "$target: the site was not built"; exit 2; }
    echo "$target/README.html"
    [ -n "${1-}" ] || "$python" -m webbrowser "file://$target/README.html"
}

# A link to this script, which by its name knows that it is a command
write_command() {
    mkdir -p -- "$1" && [ ! -e "$1/ehlpetsc" ] || [ -L "$1/ehlpetsc" ] || { say "$1/ehlpetsc: is not such a link"; exit 2; }
    ln -sfn -- "$here/run_mpi.sh" "$1/ehlpetsc"
    say "in $1: ehlpetsc"
    [[ :$PATH: = *:"$1":* ]] || say "not on your PATH yet; type: export PATH=\"$1:\$PATH\""
}

ranks=""
if [ "${0##*/}" = ehlpetsc ] && [ "${1-}" != -n ]; then # by the link of write_command
    prepare "$run_modules" "$drawing"
    exec "$python" -m ehlpetsc "$@"
elif [ "${1-}" = -n ]; then
    ranks=${2-}
    [[ $ranks =~ ^[1-9][0-9]{0,4}$ ]] || { say "-n $ranks: allowed: a whole number of ranks, at least 1"; exit 2; }
    shift 2
fi
case ${1-} in
    "") usage; exit 2 ;;
    -h | --help | -help) usage ;;
    --install) prepare "$run_modules $drawing" ;;
    --commands) write_command "${2-}" ;;
    test) prepare "$run_modules $testing"; run_tests "${@:2}" ;;
    docs) prepare "$run_modules $drawing $site"; build_site "${@:2}" ;;
    -[!-]*) say "$1: a case or a command comes first, see -h"; exit 2 ;;
    *)
        trap stopped_early INT TERM HUP USR1
        prepare "$run_modules" "$drawing"
        # two ranks gain nothing certain for one contact, and all of the second for the members of a series
        [ -n "$ranks" ] || [[ $1 != *.toml ]] || ! grep -qs '^ *\[series\]' "$1" || ranks=2
        [ -n "$ranks" ] || exec "$python" -m ehlpetsc "$@"
        run_ranks "$@"
        ;;
esac
