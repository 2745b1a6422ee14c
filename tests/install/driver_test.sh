#!/usr/bin/env bash
# Oracle: the promise of examples/README.md. An example driver builds against an installed package and
# moves a probe of the real processes over loopback DDS: it presses, hears the force that the organ
# gives, ends when told to, and the session does not refuse a sample of its.
# driver_test.sh PREFIX EXAMPLE WORK_FOLDER
set -euo pipefail
prefix=$1 example=$2 work=$3

rm -rf "$work"
mkdir -p "$work"
cmake -S "$example" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DPALPATE_IDL="$prefix/share/palpate/idl" \
  -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON -DCMAKE_DISABLE_FIND_PACKAGE_fcl=ON
cmake --build "$work/build"

cat >"$work/scene.yaml" <<END
palpate_scene: 1
organs:
  - mesh: {file: $prefix/share/palpate/scenes/meshes/ball.ply}
    tissue: {youngs_modulus_pa: 20e3}
    springs: {inner_ratio: 0.5}
    fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.03]}}]
probes:
  - name: another
    shape: {sphere: {radius_m: 0.01}}
    device: {scripted: {start_m: [0.5, 0, 0], moves: [{wait_s: 1}]}}
  - name: finger
    shape: {sphere: {radius_m: 0.01}}
    device: {topic: {start_m: [0, 0, 0.065]}}
END
session=drivers_$$ domain=$((100 + $$ % 90))
"$prefix/bin/palpate" run "$work/scene.yaml" --headless --session $session --domain $domain --no-realtime \
  >"$work/run.log" 2>&1 &
run=$!
driver=
trap 'kill $run $driver 2>/dev/null || true; tail -n 20 "$work"/*.log' EXIT

# Until the line of some second has it.
wait_for() {
  for _ in $(seq 300); do
    ! grep -qE "$1" "$work/run.log" || return 0
    sleep 0.1
  done
  echo "the run does not say: $1" >&2
  return 1
}
wait_for " s  real time"
export PALPATE_TOKEN
PALPATE_TOKEN=$("$prefix/bin/palpate" token --session $session --domain $domain)  # for Cyclone DDS
"$work/build/driver" $session $domain 1 0 0 0.065 >"$work/driver.log" &
driver=$!
wait_for "force .*finger 0\.(0[1-9]|[1-9])"  # 10 mN and more
kill -TERM $driver
wait $driver  # its exit code is 0
driver=
wait_for "probe 'finger': its driver is silent"
kill -INT $run
wait $run
grep -qE "driver: [0-9]{3,} forces heard, at most 0\.(0[1-9]|[1-9])" "$work/driver.log"
grep -q "probe finger .*limits that acted: .*driver silent" "$work/run.log"
! grep -A1 "^haptics  " "$work/run.log" | grep -qE "samples refused|packets from a stranger"
trap - EXIT
