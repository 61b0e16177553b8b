#!/bin/bash
# The README's two commands on a Debian that has nothing yet, in a folder that is removed afterwards:
#   tests/fresh_machine.sh bookworm|trixie             as root: the commands as they are there
#   tests/fresh_machine.sh bookworm|trixie TESTS ...   the first 100 steps of the case, these tests and those of MPI
# Where its Python suits them, then PETSc and MPICH as wheels of PyPI in a virtual environment, which must print the
# digits of Debian's. The release comes by debootstrap from the mirror that this machine's apt uses, the project from
# its last commit. Its tests wait for a lock on the file FRESH_TURN, where the environment names one.
# Exit status: 0 as the README says, 1 not, 77 cannot be tried here.
set -eu

release=${1:?usage: tests/fresh_machine.sh bookworm|trixie [TESTS ...]}
shift
here=$(cd "$(dirname "$0")/.." && pwd -P)
say() { echo "fresh_machine.sh: $*"; }
cannot() { say "cannot be tried here: $*" >&2; exit 77; }
fail() { say "$*" >&2; exit 1; }

if [ "${FRESH_ROOT-}" = "" ]; then # the outer half: what must be undone, whatever happens
    [ "$(id -u)" = 0 ] || cannot "debootstrap needs root"
    command -v debootstrap >/dev/null || apt-get -o DPkg::Lock::Timeout=600 install -y -qq debootstrap >/dev/null 2>&1 ||
        { apt-get update -qq && apt-get install -y -qq debootstrap; } >/dev/null 2>&1 || cannot "no debootstrap"
    unshare --mount true 2>/dev/null || cannot "file systems cannot be mounted"
    FRESH_ROOT=$(mktemp -d)
    export FRESH_ROOT
    chmod 755 "$FRESH_ROOT"
    trap 'rm -rf --one-file-system "$FRESH_ROOT"' EXIT
    status=0
    # mounts are seen inside alone and end with it; so do its processes
    unshare --mount --pid --fork --kill-child --propagation private "$0" "$release" "$@" &
    trap 'kill -KILL $!' INT TERM HUP # the first process of the fresh machine dies with it, and so do all others
    wait $! || status=$?
    exit $status
fi
root=$FRESH_ROOT
# what runs by PETSc: starts, Newton's method, its options, contacts in the plane
of_petsc="tests/unit/test_newton.py tests/verification/test_starts.py"

mirror() {
    local VERSION_CODENAME=""
    . /etc/os-release
    # shellcheck disable=SC2016  # apt's own
    apt-get indextargets --format '$(SUITE) $(RELEASE) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' |
        awk -v name="$VERSION_CODENAME" '($1 == name || $2 == name) && $3 == "main" { print $4; exit }'
}

in_root() { # USER COMMAND: in the fresh machine, in a plain environment
    local home=/root
    [ "$1" = root ] || home=/home/$1
    chroot --userspec="$1" --groups="" "$root" /usr/bin/env -i HOME="$home" \
        PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin /bin/bash -c "cd && cd ehlpetsc 2>/dev/null; $2"
}

expect() { # STATUS USER COMMAND WORDS ...: what it ends with and prints
    local wanted=$1 user=$2 command=$3 status=0 words
    shift 3
    say "$release, $user: $command"
    in_root "$user" "$command" </dev/null >"$root/said" 2>&1 || status=$?
    sed 's/^/    /' "$root/said"
    [ $status = "$wanted" ] || fail "ended with $status, not $wanted"
    for words in "$@"; do
        grep -qE -- "$words" "$root/said" || fail "did not print: $words"
    done
}

install_wheels() { # in the virtual environment ~/wheels of the guest; status 1 where there are none to be had
    local python="python3 -c 'import sys; sys.exit(sys.version_info < (3, 12))'" pip="~/wheels/bin/pip install -q"
    in_root root "$python" || { say "$release: no wheels for its Python"; return 1; }
    in_root root 'apt-get install -y -qq --no-install-recommends python3-venv' >/dev/null 2>&1 &&
        in_root guest "python3 -m venv ~/wheels && $pip --retries 1 hatchling" ||
        { say "$release: PyPI cannot be reached: the wheels are not tried"; return 1; }
    in_root guest "$pip '.[wheel,test]'" || fail "the wheels cannot be installed"
}

try_wheels() { # imports in both orders, one case on one and two ranks, post, two MPIs, tests
    local run="cd /tmp && ~/wheels/bin/ehlpetsc" python="~/wheels/bin/python"
    local solver="import ehlpetsc; ehlpetsc.Simulation" petsc="from petsc4py import PETSc" mpi="from mpi4py import MPI"
    local what="print('PETSc', *PETSc.Sys.getVersion(), MPI.Get_library_version())"
    expect 0 guest "$python -c \"$solver; $petsc; $mpi; $what\"" '^PETSc 3 [0-9 ]+MPICH'
    expect 0 guest "$python -c \"$mpi; $petsc; $solver; $what\"" '^PETSc 3 [0-9 ]+MPICH'
    expect 0 guest "$run ~/ehlpetsc/$case -o one.h5" ' 1 rank;' "^ehlpetsc: done $printed "
    expect 0 guest "$run -n 2 ~/ehlpetsc/$case -o two.h5" ' 2 ranks;' "^ehlpetsc: done $printed "
    expect 0 guest "$run post one.h5 --depths 0.1 && ~/wheels/bin/ehlpetsc plot one.h5" 'one.post.h5' '^one.png$'
    expect 2 guest "PYTHONPATH=/usr/lib/python3/dist-packages; export PYTHONPATH; $run ~/ehlpetsc/$case -o three.h5" \
        '^ehlpetsc: petsc4py in .* needs libmpi.so.12, mpi4py in .* uses libmpi.so.40: '
    expect 0 guest "$python -m pytest -q -p no:cacheprovider $of_petsc" '[0-9]+ passed'
    expect 0 guest "~/wheels/bin/mpirun -n 2 $python -m pytest -q -p no:cacheprovider tests/mpi/test_ranks.py" \
        '[0-9]+ passed'
}

from=$(mirror)
[ -n "$from" ] || cannot "no mirror of Debian among apt's sources"
say "$release from the mirror of this machine's apt"
log=$(debootstrap --variant=minbase "$release" "$root" "$from" 2>&1) ||
    { tail -n 5 <<<"$log" >&2; cannot "debootstrap of $release failed"; }
mount -t proc proc "$root/proc"
mount --rbind /sys "$root/sys"
mount --rbind /dev "$root/dev"
echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io" # nothing of it is to outlive a crash
# the way to the net: name server, proxies, certificates
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
grep -lsi proxy /etc/apt/apt.conf /etc/apt/apt.conf.d/* | xargs -r cp -t "$root/etc/apt/apt.conf.d" || true
mkdir -p "$root/usr/local/share/ca-certificates"
cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates" 2>/dev/null || true

in_root root 'apt-get update -qq && apt-get install -y -qq --no-install-recommends git ca-certificates' >/dev/null 2>&1 ||
    cannot "git cannot be installed"
in_root root 'useradd --create-home guest'
git -C "$here" bundle create -q "$root/project" HEAD
for user in root guest; do
    in_root "$user" 'git -c init.defaultBranch=main -c advice.detachedHead=false clone -q /project ehlpetsc'
done
began=$SECONDS

case=cases/mixed.toml
first="./run_mpi.sh $case"
# as the README prints them, to the digits that do not depend on the processor
digits='([0-9])\.(...)[0-9]*e'
line="(.* newton=.)[0-9]* h_min=$digits-([0-9]+) p_max=$digits\\+([0-9]+) .*"
printed=$(sed -nE "s/^ehlpetsc: done $line/\1[0-9]* h_min=\2\\\\.\3[0-9]*e-\4 p_max=\5\\\\.\6[0-9]*e\\\\+\7/p" "$here/README.md")
[ -n "$printed" ] || fail "README.md shows no figures of the first run"
figures=$printed
if [ $# != 0 ]; then
    first+=' --set time.travel=0.5'
    figures='steps=50 newton=[0-9]+ h_min=3\.00[0-9]*e-07 p_max=1\.016[0-9]*e\+09 contacts=[0-9]+'
fi
finished="^ehlpetsc: done $figures .*load_error=[0-9.]+e-1[0-9] "
install='^sudo apt-get update && sudo apt-get install -y .*python3-petsc4py-real'
expect 2 guest "$first" "$install"
expect 0 root "$first" '^run_mpi.sh: installed$' '^result: mixed.h5$' "$finished"
say "$release: $((SECONDS - began)) s from the clone to the first result"
expect 0 guest "$first" ' 1 rank;' "$finished"
expect 0 guest './run_mpi.sh --commands ~/.local/bin' 'in /home/guest/.local/bin: ehlpetsc$'
picture='cd /tmp && PATH=$HOME/.local/bin:$PATH && ehlpetsc plot ~/ehlpetsc/mixed.h5'
expect 0 guest "$picture" '^/home/guest/ehlpetsc/mixed.png$'
has_wheels=0
install_wheels || has_wheels=$?
[ -z "${FRESH_TURN-}" ] || flock "$FRESH_TURN" true
began=$SECONDS
expect 0 root "./run_mpi.sh test $*" '[0-9]+ passed' 'tests on 3 rank'
! grep -E '^(FAILED|ERROR)|[0-9]+ failed' "$root/said" || fail "tests failed"
say "$release: tests in $((SECONDS - began)) s"
if [ $has_wheels = 0 ]; then
    began=$SECONDS
    try_wheels
    say "$release: wheels in $((SECONDS - began)) s"
fi
say "$release: all as the README says"
