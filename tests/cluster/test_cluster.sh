#!/usr/bin/env bash
# Runs one list of tasks in one process, in shards, over MPI ranks and as a Slurm array on this
# machine, and compares the digests: test_cluster.sh BUILD. Starts munge and Slurm of its own in a
# temporary folder and stops them. Exits with 77 and says why where Slurm or MPI is missing.
set -euo pipefail
build=$(cd "${1:?usage: test_cluster.sh BUILD}" && pwd)
modcal=$build/modcal
for program in "$build/modcal-mpi" mpirun slurmctld slurmd sbatch munged; do
  command -v "$program" >/dev/null || { echo "skipped: $program is missing; see packages.txt, mark cluster"; exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "skipped: slurmd needs root"; exit 77; }

work=$(mktemp -d)
chmod 755 "$work"
daemons=()
stop() {
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done
  sleep 1
  for pid in "${daemons[@]}"; do kill -9 "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap stop EXIT

cat >"$work/sweep.yaml" <<'YAML'
kind: sweep
title: small sweep
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 1 s
simulator: {type: newmark_explicit, time_step: 4 us}
measurement: {sample_rate: 12.5 kHz}
inversion: {estimator: one_sided, regularizer: {type: water_level}, parameter_choice: {type: minimal_product}}
score: {windows: [0.5 s], periods: 2}
sweep:
  product:
    scene.bow.normal_force: [0.98 N, 1 N]
    measurement.noise_level: [0 %, 1 %, 2 %, 5 %]
    seed: [1, 2, 3, 4, 5]
YAML
cd "$work"

digest() { "$modcal" merge "$1" | sed 's/.*: //'; }
compare() {
  if [ "$(digest "$1")" != "$whole" ]; then echo "FAILED: $2: $(digest "$1"), not $whole"; exit 1; fi
  echo "$2: $whole"
}

"$modcal" run sweep.yaml --out one --threads 1 >/dev/null 2>&1
whole=$(digest one)
echo "one thread: $whole"
"$modcal" run sweep.yaml --out two --threads 2 >/dev/null 2>&1
compare two "two threads"
for k in 1 2 3 4 5 6 7; do "$modcal" run sweep.yaml --out shards --shard "$k/7" >/dev/null 2>&1; done
compare shards "seven shards"
for ranks in 1 3; do
  mpirun --allow-run-as-root --oversubscribe -n $ranks "$build/modcal-mpi" run sweep.yaml --out "mpi$ranks" \
    >/dev/null 2>"$work/mpi.log" || { cat "$work/mpi.log"; exit 1; }
  [ -s "mpi$ranks/report.html" ] || { echo "FAILED: $ranks ranks leave no report"; exit 1; }
  compare "mpi$ranks" "$ranks MPI ranks"
done

# Slurm: one controller, one node, keys and states in the temporary folder.
host=$(hostname -s)
mkdir -p "$work"/munge "$work"/state "$work"/spool
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 status=none
chown -R munge: "$work/munge"
chmod 700 "$work/munge"
chmod 400 "$work/munge/key"
mkdir -p /run/munge && chown munge: /run/munge && chmod 755 /run/munge
if ! pgrep -x munged >/dev/null; then
  setpriv --reuid munge --regid munge --clear-groups munged --foreground --key-file "$work/munge/key" \
    --pid-file "$work/munge/pid" --log-file "$work/munge/log" --seed-file "$work/munge/seed" \
    >/dev/null 2>&1 &
  daemons+=($!)
fi
cat >"$work/slurm.conf" <<CONF
ClusterName=modcaltest
SlurmctldHost=$host
SlurmUser=root
AuthType=auth/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
ReturnToService=2
MpiDefault=none
NodeName=$host CPUs=$(nproc) State=UNKNOWN
PartitionName=test Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
sleep 1
slurmctld -D >"$work/slurmctld.log" 2>&1 &
daemons+=($!)
slurmd -D >"$work/slurmd.log" 2>&1 &
daemons+=($!)
for _ in $(seq 60); do sinfo -h -o %T 2>/dev/null | grep -q idle && break; sleep 1; done
sinfo -h -o %T | grep -q idle || { echo "FAILED: Slurm does not start"; tail -5 "$work"/slurm*.log; exit 1; }

"$modcal" submit --slurm sweep.yaml --out slurm --bundle-seconds 0.02 --most-jobs 7
for _ in $(seq 120); do [ -z "$(squeue -h)" ] && break; sleep 1; done
[ -s slurm/report.html ] || { echo "FAILED: the Slurm jobs leave no report"; cat slurm/slurm/*.log; exit 1; }
compare slurm "Slurm array of $(grep -c . <<<"$(ls slurm/slurm/run-*.log)") jobs"
echo "all runs give one digest"
