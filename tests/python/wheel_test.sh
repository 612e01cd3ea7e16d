#!/usr/bin/env bash
# Installs the Python package as a user does (`pip install .` in a fresh environment, which builds the wheel) and runs its tests there.
# Compiles the library; asks the package index for the build's tools, NumPy and cffi.
#
#   wheel_test.sh SOURCE WORK PYTHON      with LIGHTWELL_SAME_FRAME as for python_test
#
# Exit code: 0 passed, 1 failed; "SKIPPED: why" where an environment or the index cannot be had.
source=$1 work=$2 python=$3
rm -rf "$work"
mkdir -p "$work" || exit 1
"$python" -m venv "$work/environment" >"$work/venv.txt" 2>&1 || { echo "SKIPPED: $python makes no environments (python3-venv)"; exit 0; }
inside=$work/environment/bin/python
"$inside" -m pip download -q --no-deps -d "$work/asked" "scikit-build-core>=0.10" >"$work/index.txt" 2>&1 ||
    { echo "SKIPPED: pip reaches no package index"; exit 0; }
"$inside" -m pip install "$source" >"$work/install.txt" 2>&1 || { tail -n 40 "$work/install.txt" >&2; exit 1; }
cd "$work" || exit 1
unset PYTHONPATH LIGHTWELL_LIBRARY
"$inside" - <<'PROGRAM' || exit 1
import pathlib
import sys
import lightwell
where = pathlib.Path(lightwell.__file__).resolve().parent
assert str(where).startswith(sys.prefix), where
assert list(where.glob("liblightwell.so.*")) and (where / "py.typed").exists(), list(where.iterdir())
print("lightwell", lightwell.__version__, "in", where)
PROGRAM
exec "$inside" -B -m unittest discover -s "$source/tests/python"
