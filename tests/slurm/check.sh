#!/usr/bin/env bash
# A sweep as an array on a cluster of one machine: slurmctld, slurmd and munged of this test's own, on
# the loopback interface. A task is killed and requeued; the table must be that of one undisturbed run.
#   check.sh PHOTORQUE SOURCE_FOLDER
# Exit status 77: this machine has no Slurm, or does not let it start.
set -euo pipefail
program="$1"
source="$2"
skip() {
  echo "Skipped: $1"
  exit 77
}
PATH="$PATH:/usr/sbin:/sbin"
for needed in munged slurmctld slurmd sbatch scontrol squeue; do
  command -v "$needed" >/dev/null || skip "no $needed (packages slurm-wlm and munge)"
done
[[ "$(id -u)" -eq 0 ]] || skip "slurmd starts as root only"

place="$(mktemp -d)"
started=()
finish() {
  [[ -z "${job:-}" ]] || scancel "$job" 2>/dev/null || true
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  for process in "${started[@]}"; do wait "$process" 2>/dev/null || true; done
  rm -rf "$place"
}
trap finish EXIT
chmod 755 "$place"
mkdir "$place/munge" "$place/state" "$place/spool"
chmod 700 "$place/munge"

echo "== A cluster of one"
dd if=/dev/urandom of="$place/munge/key" bs=1024 count=1 status=none
chmod 400 "$place/munge/key"
munged --foreground --force --socket="$place/socket" --key-file="$place/munge/key" \
  --pid-file="$place/munge/pid" --log-file="$place/munge/log" --seed-file="$place/munge/seed" \
  >"$place/munged.out" 2>&1 &
started+=($!)
host="$(hostname -s)"
port=$((20000 + $$ % 20000))
cat >"$place/slurm.conf" <<C
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$place/socket
CredType=cred/munge
StateSaveLocation=$place/state
SlurmdSpoolDir=$place/spool
SlurmctldPidFile=$place/slurmctld.pid
SlurmdPidFile=$place/slurmd.pid
SlurmctldLogFile=$place/slurmctld.log
SlurmdLogFile=$place/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
C
export SLURM_CONF="$place/slurm.conf"
for _ in $(seq 100); do [[ -S "$place/socket" ]] && break || sleep 0.05; done
slurmctld -D -c >"$place/slurmctld.out" 2>&1 &
started+=($!)
slurmd -D -N "$host" >"$place/slurmd.out" 2>&1 &
started+=($!)
ready=""
for _ in $(seq 300); do
  if scontrol show node "$host" 2>/dev/null | grep -q 'State=IDLE'; then ready=yes && break; fi
  sleep 0.1
done
if [[ -z "$ready" ]]; then
  tail -n 5 "$place"/*.log "$place"/*.out
  skip "Slurm does not start here"
fi

echo "== The table of one run"
cp "$source/scenes/stasis/stasis.gltf" "$place"
cat >"$place/e.toml" <<C
[scene]
file = "stasis.gltf"
[trace]
rays = 1000000
[[source]]
kind = "sun"
direction = [0, 0, -1]
[[receiver]]
node = "solar_array"
bins = [20, 20]
[sweep]
verb = "trace"
figures = ["power_on_solar_array_W", "absorbed_W"]
[[sweep.axis]]
key = "attitude.tilt_deg"
from = 0
to = 29
count = 30
C
"$program" sweep "$place/e.toml" --out "$place/one" --quiet

echo "== As an array of three; the second task is killed and requeued"
cd "$place"
export PHOTORQUE="$program"
job="$(sbatch --parsable --array=1-3 --cpus-per-task=1 "$source/tools/slurm/sweep" e.toml --out "$place/array")"
own="$place/array/shards/2-of-3.sqlite"
# Killed in the midst: some designs done, not all.
/usr/bin/python3 - "$own" <<'P'
import os, signal, sqlite3, subprocess, sys, time
for _ in range(6000):
    try:
        done = sqlite3.connect(f"file:{sys.argv[1]}?mode=ro", uri=True).execute("select count(*) from run").fetchone()[0]
    except sqlite3.Error:
        done = 0
    if done >= 3:
        break
    time.sleep(0.01)
assert 3 <= done < 10, f"{done} designs when it should be killed"
for name in os.listdir("/proc"):
    try:
        words = open(f"/proc/{name}/cmdline", "rb").read().split(b"\0") if name.isdigit() else []
    except OSError:
        continue
    if b"--shard" in words and b"2/3" in words and os.path.dirname(os.path.dirname(sys.argv[1])).encode() in words:
        os.kill(int(name), signal.SIGKILL)
        print(f"killed with {done} designs done")
        break
else:
    sys.exit("the task is not there")
P
for _ in $(seq 600); do
  state="$(scontrol show job "${job}_2" | grep -o 'JobState=[A-Z]*' | head -1)"
  [[ "$state" == "JobState=FAILED" ]] && break || sleep 0.1
done
[[ "$state" == "JobState=FAILED" ]] || { echo "a killed task is $state"; exit 1; }
[[ ! -e "$place/array/sweep.csv" ]]
before="$(/usr/bin/python3 -c "import sqlite3, sys; print(sqlite3.connect(sys.argv[1]).execute('select count(*) from run').fetchone()[0])" "$own")"
scontrol requeue "${job}_2"
scontrol update "JobId=${job}_2" StartTime=now  # not after the usual pause of two minutes
for _ in $(seq 1200); do [[ -e "$place/array/sweep.csv" ]] && break || sleep 0.1; done
# Until the last step is gone, so that nothing outlives the daemons.
for _ in $(seq 300); do [[ -z "$(squeue -h)" ]] && break || sleep 0.1; done
cat "$place"/slurm-*.out
grep -q "$((10 - before)) run now, $before kept from before" "$place"/slurm-*_2.out
cmp "$place/one/sweep.csv" "$place/array/sweep.csv"
echo "The same table, to the last byte"
