# shellcheck shell=bash disable=SC2034,SC2154 # its variables are used where it is sourced
# What the scripts beside this file share. Sourced, never run. The caller has set `name`.

# The checkout these scripts belong to, whatever folder or link they are called through.
repository=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)

# Everything the scripts fetch or unpack goes here; deleting the folder undoes it.
if [[ -n ${XDG_CACHE_HOME:-} ]]; then
    cache=$XDG_CACHE_HOME/gaitway
elif [[ -n ${HOME:-} ]]; then
    cache=$HOME/.cache/gaitway
else
    cache=${TMPDIR:-/tmp}/gaitway-$(id -u)
fi
vulkan_root=${GAITWAY_VULKAN_ROOT:-$cache/vulkan-trixie}
pedpy_root=$cache/pedpy
cluster_root=$cache/cluster
python_root=$cache/python
browser_root=${GAITWAY_BROWSER_ROOT:-$cache/browser}
checkers_root=$cache/checkers
# GNU's name of this machine, in library folders; Debian's own name of it is asked of dpkg.
triplet=$(uname -m)-linux-gnu

say() { printf '%s: %s\n' "$name" "$*"; }
# fail LINE...: the reason, then what to do about it, and out.
fail() {
    printf '%s: error: %s\n' "$name" "$1" >&2
    shift
    (($# == 0)) || printf '  %s\n' "$@" >&2
    exit 1
}
# The first of the paths that exists; fails when none does.
first_of() {
    local path
    for path in "$@"; do
        [[ ! -e $path ]] || { echo "$path"; return; }
    done
    return 1
}
have() { command -v "$1" >/dev/null 2>&1; }

# What scripts/setup fetched to check sources with; the machine's own programs come first.
PATH=$PATH:$checkers_root/bin

# rustup writes its PATH into the shell's start-up file: a shell from before does not know it.
if ! have cargo && [[ -x ${CARGO_HOME:-${HOME:-/nonexistent}/.cargo}/bin/cargo ]]; then
    PATH=${CARGO_HOME:-$HOME/.cargo}/bin:$PATH
fi
