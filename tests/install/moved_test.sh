#!/usr/bin/env bash
# Oracle: the promise of docs/deployment.md. Moved to another folder, an installed Palpate runs a session
# and its studies with source and build tree gone: empty folders lie over both, in a mount namespace.
# Where the machine allows none, no installed file may name either tree.
# moved_test.sh PREFIX SOURCE_DIR BUILD_DIR
set -euo pipefail
prefix=$1 source=$2 build=$3

if [ "${4:-}" != hidden ]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  cp -r "$prefix" "$work/moved"
  cp "$0" "$work/test"
  cd "$work"
  hide=()
  if unshare -rm true 2>/dev/null; then
    hide=(unshare -rm)
  elif grep -rlF -e "$source" -e "$build" moved; then
    echo "these files name the source or the build tree" >&2
    exit 1
  else
    echo "no mount namespace here: nothing installed names the source or the build tree"
    source=$work/nothing build=$work/nothing
    mkdir "$source"
  fi
  env -i PATH=/usr/bin:/bin HOME="$work" \
    "${hide[@]}" bash test "$work/moved" "$source" "$build" hidden
  exit
fi

for tree in "$build" "$source"; do
  [ "$tree" = "$PWD/nothing" ] || mount -t tmpfs none "$tree"
  [ -z "$(ls -A "$tree")" ]
done
palpate=$prefix/bin/palpate scene=$prefix/share/palpate/scenes/stomach_probe.yaml
set -x
"$palpate" run "$scene" --headless --session "moved-$$" --duration 1 --record run.mcap
"$palpate" inspect run.mcap | grep node_positions
"$palpate" chart --quick --case ball --model implicit_volume --no-peers -o chart
"$palpate" plan "$scene" --seconds 3 --touches 1 -o planned.yaml
"$palpate" check planned.yaml
"$palpate" stability --quick --only squeeze --series mass_spring -o stability
"$palpate" certify "$scene" --lockstep --quick -o certify || [ $? -eq 1 ]  # 1: a line failed
for result in chart/*.csv stability/*.csv certify/certif*; do [ -s "$result" ]; done
