# Sourced by the scripts beside it, from the checkout's root: make .venv there when missing, and install into it.
# `make_environment [EXTRAS [OPTION…]]` installs the package with the extras, from the pins of constraints.txt and with
# options of pip; again only when what it depends on has changed. Compiled models go into .venv too, under names that are a hash of their source.

find_python() {
    local name
    for name in "${PYTHON:-}" python3.13 python3.12 python3.11 python3 python; do
        if [ -n "$name" ] && "$name" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then
            echo "$name"
            return
        fi
    done
    echo "screwsim: no Python >= 3.11 found (install one, or set PYTHON to its path)" >&2
    return 1
}

wanted() { # of what the packages of .venv depend on
    .venv/bin/python -c 'import hashlib, pathlib, sys
print(sys.version.split()[0], *(hashlib.sha256(pathlib.Path(name).read_bytes()).hexdigest() for name in sys.argv[1:]))' \
        pyproject.toml constraints.txt
}

make_environment() {
    local extras=${1:-} stamp=.venv/screwsim-stamp python
    [ $# -eq 0 ] || shift
    if ! .venv/bin/python -c 'import pip, sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then
        python=$(find_python)
        echo "screwsim: making .venv with $("$python" --version)" >&2
        "$python" -m venv .venv
    fi
    stamp=$stamp${extras:+-$extras}
    if [ "$(cat "$stamp" 2>/dev/null)" != "$(wanted)" ]; then
        echo "screwsim: installing into .venv" >&2
        .venv/bin/python -m pip install -q --disable-pip-version-check ${1+"$@"} -c constraints.txt \
            -e ".${extras:+[$extras]}"
        wanted >"$stamp"
    fi
    export PATH="$PWD/.venv/bin:$PATH"
    export SCREWSIM_CACHE="$PWD/.venv/screwsim-cache"
    export MPLCONFIGDIR="$PWD/.venv/matplotlib" MPLBACKEND=Agg
    mkdir -p "$SCREWSIM_CACHE" "$MPLCONFIGDIR"
    chmod 700 "$SCREWSIM_CACHE" # where the umask lets a group write, screwsim would not use it
}
