#!/usr/bin/env bash
# Oracle: the promise of docs/tutorial.md. The device that the page shows builds against an installed
# package where VTK and FCL cannot be found, and then runs.
# device_test.sh PREFIX TUTORIAL WORK_FOLDER
set -euo pipefail
prefix=$1 tutorial=$2 work=$3

block() { sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/p" "$tutorial" | sed '/^```/d'; }
rm -rf "$work"
mkdir -p "$work"
block cpp >"$work/my_device.cpp"
block cmake >"$work/CMakeLists.txt"
cmake -S "$work" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON -DCMAKE_DISABLE_FIND_PACKAGE_fcl=ON
cmake --build "$work/build"
code=0
timeout 2 "$work/build/my_device" || code=$?
[ $code -eq 124 ] || { echo "my_device ended with code $code instead of going on" >&2; exit 1; }
