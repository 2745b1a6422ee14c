#!/usr/bin/env bash
# A study over a cluster of one node: the array script of scripts/cluster under real Slurm daemons.
# Oracle: the same study without shards, byte for byte. Usage: cluster_test.sh BIN_FOLDER SOURCE_FOLDER
set -euo pipefail
bin=$1 source=$2
PATH=$PATH:/usr/sbin
for program in slurmctld slurmd sbatch srun; do
  command -v "$program" >/dev/null || { echo "SKIPPED: no $program (Debian: slurmd slurmctld slurm-client)"; exit 0; }
done
[ "$(id -u)" -eq 0 ] || { echo "SKIPPED: slurmd starts jobs as root only"; exit 0; }

folder=$(mktemp -d)
daemons=()
cleanup() {
  [ ${#daemons[@]} -eq 0 ] || { kill "${daemons[@]}"; wait "${daemons[@]}"; } 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT
port=$((20000 + RANDOM % 10000))
host=$(hostname -s)
mkdir "$folder/state" "$folder/spool"
cat >"$folder/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
export SLURM_CONF=$folder/slurm.conf
slurmctld -D >"$folder/slurmctld.out" 2>&1 & daemons+=($!)
slurmd -D -N "$host" >"$folder/slurmd.out" 2>&1 & daemons+=($!)
for _ in $(seq 150); do
  sinfo -h -o %t 2>/dev/null | grep -q idle && break
  sleep 0.2
done
if ! sinfo -h -o %t 2>/dev/null | grep -q idle; then
  echo "SKIPPED: no node of Slurm comes up here: $(tail -qn 1 "$folder"/slurm*.out "$folder"/slurm*.log 2>/dev/null | tr '\n' ' ')"
  exit 0
fi

study=(stability --quick --only step_stiffness --series implicit_volume mass_spring --out)
export PALPATE=$bin/palpate
script=$source/scripts/cluster/study.sbatch
sbatch --wait --array=1-2 -o "$folder/shard-%a.txt" "$script" "${study[@]}" "$folder/shared"
grep -H "^shard 1/2: " "$folder/shard-1.txt"
grep -H "^shard 2/2: " "$folder/shard-2.txt"
if [ -e "$folder/shared/atlas.csv" ]; then echo "a shard wrote the tables"; exit 1; fi
points=$(find "$folder/shared/points" -name '*.csv' | wc -l)
measured=$(($(sed -n 's/^shard [0-9/]*: \([0-9]*\) points measured here.*/\1/p' "$folder"/shard-?.txt | paste -sd+)))
echo "$points points, measured $measured times"
[ "$points" -gt 0 ] && [ "$points" -eq "$measured" ]
sbatch --wait -o "$folder/merged.txt" "$script" "${study[@]}" "$folder/shared"
"$PALPATE" "${study[@]}" "$folder/alone" >/dev/null 2>&1
for table in atlas.csv frontiers.csv; do cmp "$folder/shared/$table" "$folder/alone/$table"; done
if sbatch --wait --array=2-3 -o "$folder/wrong-%a.txt" "$script" "${study[@]}" "$folder/shared"; then
  echo "an array that is not 1-N was accepted"; exit 1
fi
grep -H "must be 1-N" "$folder/wrong-2.txt"
