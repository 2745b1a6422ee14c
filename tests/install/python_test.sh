#!/usr/bin/env bash
# Oracle: the promise of docs/python.md. The installed package runs from its prefix, and its wheel in a fresh
# environment, both away from source and build tree, without a word on import.
# python_test.sh PREFIX SOURCE_DIR
set -euo pipefail
prefix=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/press.py" <<'END'
import sys
import palpate
assert sys.argv[1] in palpate.__file__, palpate.__file__
session = palpate.Session(palpate.scene_path("stomach_probe"))
assert sys.argv[1] in str(session.scene.file), session.scene.file
assert session.run(5, keep="haptic_force")["haptic_force"]["force_n"].min() < -0.01
END
"$source/scripts/wheel" "$prefix" "$work/wheels"
cd "$work"

installed() { env -i PATH=/usr/bin:/bin PYTHONPATH="$prefix/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 "$@"; }
said=$(installed -c "import palpate" 2>&1)
[ "$said" = "" ] || { echo "import says: $said" >&2; exit 1; }
installed press.py "$prefix"

/usr/bin/python3 -m venv --system-site-packages fresh
fresh/bin/pip install -q --no-index --no-deps --disable-pip-version-check wheels/palpate-*.whl
env -i PATH=/usr/bin:/bin fresh/bin/python press.py "$work/fresh"
