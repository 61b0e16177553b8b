#!/bin/bash
# Installs what is missing on Debian 12 and runs a case, or the tests, under MPI.
set -eu

usage() {
    cat <<'END'
./run_mpi.sh [-n RANKS] CASE.toml [PETSc options]   run a case, on 2 ranks unless told otherwise
./run_mpi.sh --explain CASE.toml                    tell it in words: film, run time, file size; nothing is run
./run_mpi.sh test                                   run the whole test suite, serial and under mpirun

What is missing is installed first from Debian's packages: by itself as root, else the command is shown.
Own options and PETSc's: ./run_mpi.sh CASE.toml -help
Exit status: 0 done, 1 bug, 2 bad input, 3 no convergence, 4 stopped and restart file written.
END
}

run_packages="python3 python3-numpy python3-scipy python3-numba python3-pydantic python3-tomlkit python3-mpi4py
    python3-h5py-mpi python3-petsc4py-real openmpi-bin"
post_packages="python3-matplotlib"
test_packages="$post_packages python3-pytest python3-hypothesis python3-xarray python3-h5netcdf python3-pip"

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
test_only="$here/.test-packages" # what the tests compare with and Debian does not have
python=/usr/bin/python3
export PATH=/usr/sbin:/usr/bin:/sbin:/bin${PATH:+:$PATH}

say() { echo "run_mpi.sh: $*" >&2; }

install_missing() {
    local missing
    missing=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
        awk -v wanted="$*" '$1 == "installed" { have[$2] }
            END { n = split(wanted, p); for (i = 1; i <= n; i++) if (!(p[i] in have)) printf "%s ", p[i] }') || true
    missing=${missing% }
    [ -n "$missing" ] || return 0
    local install="apt-get install -y --no-install-recommends $missing"
    if [ "$(id -u)" != 0 ]; then
        say "these Debian packages are missing. Type this, then run again:"
        echo "sudo apt-get update && sudo $install"
        exit 2
    fi
    say "installing $missing"
    export DEBIAN_FRONTEND=noninteractive
    # shellcheck disable=SC2086  # package names, one word each
    { quietly apt-get update && quietly $install; } || { say "installation failed"; exit 2; }
    say "installed"
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

set_environment() {
    # another Python's modules, or another PETSc, must not mix with Debian's
    unset PYTHONHOME PYTHONSTARTUP VIRTUAL_ENV PETSC_ARCH
    local petsc=(/usr/lib/petscdir/petsc3.18/*-real)
    export PETSC_DIR=${petsc[0]} PYTHONNOUSERSITE=1
    export PYTHONPATH="$here:$PETSC_DIR/lib/python3/dist-packages"
    # without these, threads of BLAS fight the ranks for the cores
    export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
    if [ "$(id -u)" = 0 ]; then
        export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    fi
    # mpirun gives every rank a terminal, also where the output goes to a file
    [ -t 1 ] || export TERM=dumb
    # one machine: shared memory alone, by copies that a container allows, and no wait for a network or munge
    export OMPI_MCA_btl=${OMPI_MCA_btl:-self,vader}
    export OMPI_MCA_btl_vader_single_copy_mechanism=${OMPI_MCA_btl_vader_single_copy_mechanism:-none}
    export PMIX_MCA_psec=${PMIX_MCA_psec:-native} PMIX_MCA_gds=${PMIX_MCA_gds:-hash}
}

# "--oversubscribe" where there are more ranks than cores; no binding, as runs side by side would share a core
mpirun_options() {
    echo "-q -n $1 --bind-to none"
    [ "$1" -le "$(nproc)" ] || echo "--oversubscribe"
}

# SIGTERM to mpirun kills the ranks within a second; SIGUSR1 it hands on, and they stop after the step in hand.
# Hence a session of its own, which Ctrl-C does not reach, and a death signal should this script be killed.
run_case() {
    local status=0
    # shellcheck disable=SC2046  # options, one word each
    setsid setpriv --pdeathsig TERM /usr/bin/mpirun $(mpirun_options "$ranks") \
        $python -m ehlpetsc "$@" </dev/null &
    local mpirun=$!
    trap 'kill -USR1 $mpirun 2>/dev/null; trap "kill -TERM $mpirun" INT TERM' INT TERM HUP USR1
    wait $mpirun || status=$?
    while kill -0 $mpirun 2>/dev/null; do # a signal ends wait, not mpirun
        status=0
        wait $mpirun || status=$?
    done
    [ $status -lt 129 ] || say "a rank was ended by signal $((status - 128))"
    exit $status
}

# Rank 0 reports; what the others say is shown only when something failed
run_mpi_tests() {
    local ranks=$1 status=0 logs
    logs=$(mktemp -d)
    say "tests on $ranks rank(s)"
    # shellcheck disable=SC2046,SC2016
    /usr/bin/mpirun $(mpirun_options "$ranks") --timeout 1800 /bin/sh -c '
        [ "$OMPI_COMM_WORLD_RANK" = 0 ] || exec >"$1/rank$OMPI_COMM_WORLD_RANK.log" 2>&1
        shift; exec "$@"' sh "$logs" $python -m pytest -p no:cacheprovider -q --color=no -m mpi tests/mpi || status=$?
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
        quietly $python -m pip install --retries 1 --no-deps --target "$test_only" rainflow==3.2.0 ||
            say "PyPI cannot be reached: the comparison with its rainflow is left out"
    fi
    export PYTHONPATH="$PYTHONPATH:$test_only"
    $python -m pytest -p no:cacheprovider -q -m "not mpi" tests
    for ranks in 1 2 3; do run_mpi_tests $ranks; done
}

ranks=2
if [ "${1-}" = -n ]; then
    ranks=${2-}
    [[ $ranks =~ ^[1-9][0-9]{0,4}$ ]] || { say "-n $ranks: allowed: a whole number of ranks, at least 1"; exit 2; }
    shift 2
fi
case ${1-} in
    "") usage; exit 2 ;;
    -h | --help | -help) usage; exit 0 ;;
    --explain)
        # shellcheck disable=SC2086
        install_missing $run_packages $post_packages
        set_environment
        $python -m ehlpetsc "$@"
        ;;
    -*) say "$1 stands before the case file"; usage >&2; exit 2 ;;
    test)
        # shellcheck disable=SC2086
        install_missing $run_packages $test_packages
        set_environment
        run_tests
        ;;
    *)
        # shellcheck disable=SC2086
        install_missing $run_packages $post_packages
        set_environment
        run_case "$@"
        ;;
esac
