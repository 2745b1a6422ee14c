#!/bin/sh
# Oracle: systemd's own judge of units; what the service starts, with the variables of its file.
# service_test.sh PREFIX
set -eu
prefix=$1
command -v systemd-analyze > /dev/null || { echo "SKIPPED: systemd-analyze is not installed"; exit 0; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$prefix/share/palpate/systemd/palpate@.service" "$folder/palpate@lab.service"
said=$(systemd-analyze verify --man=no "$folder/palpate@lab.service" 2>&1) || { echo "refused: $said"; exit 1; }
[ -z "$said" ] || { echo "$said"; exit 1; }
start=$(sed -n 's/^ExecStart=//p' "$folder/palpate@lab.service" | sed 's/%i/lab/')
said=$(env -i PATH="$prefix/bin:/usr/bin:/bin" SCENE=stomach_probe HOSTS="$folder/no.yaml" HOST=rack sh -c "$start" 2>&1) && code=0 || code=$?
[ "$code" -eq 2 ] && [ "$said" = "palpate: $folder/no.yaml: no such file" ] || { echo "exit code $code: $said"; exit 1; }
