#!/bin/sh
# Oracle: the installed files: each page that a scene, an example or a new scene names is there, and so is
# each page or picture that a page leads to.
# pages_test.sh PREFIX
set -eu
prefix=$1
share=$prefix/share/palpate pages=$prefix/share/doc/palpate
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$prefix/bin/palpate" new "$share/scenes/meshes/ball.ply" -o "$folder/new.yaml" > /dev/null
wrong=0
check() {  # FOLDER FILE NAMED
  [ -e "$1/$3" ] || { echo "$2 names $3, which is not there"; wrong=1; }
}
for scene in "$share"/scenes/*.yaml "$folder/new.yaml"; do
  for page in $(grep -ohE 'docs/[a-z_]+\.md' "$scene"); do check "$share" "$scene" "$page"; done
done
for page in "$pages/README.md" "$pages"/docs/*.md "$share/examples/README.md"; do
  at=$(dirname "$page")
  # Sources are not installed.
  for link in $(grep -ohE '\]\([^)#:]+' "$page" | cut -c3- | grep -E '^(\.\./)?(docs|images|decisions|examples|[a-z_]+\.md)'); do
    check "$at" "$page" "$link"
  done
done
grep -q 'share/doc/palpate' "$folder/new.yaml" && [ -s "$pages/docs/scene.md" ] || wrong=1
exit $wrong
