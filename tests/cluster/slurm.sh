#!/usr/bin/env bash
# An array on a Slurm of one controller and two nodes on this machine: slurm.sh GAITWAY FOLDER
# FOLDER/plan.jsonl is done into FOLDER/slurm; one of the nodes is killed on the way and its job done again.
# As root, with Debian's slurm-wlm and munge; exit code 5 where these are not installed or do not start.
set -euo pipefail
gaitway=$(readlink -f "$1") folder=$(readlink -f "$2") here=$(dirname "$(readlink -f "$0")")
export PATH=$PATH:/usr/sbin
for program in munged slurmctld slurmd sbatch; do
    command -v "$program" >/dev/null || { echo "slurm: no $program here (Debian: slurm-wlm, munge)"; exit 5; }
done
[[ $(id -u) == 0 ]] || { echo "slurm: its services are started as root"; exit 5; }

state=$(mktemp -d /tmp/gaitway-slurm.XXXXXX)
chmod 755 "$state"
pids=()
stop() {
    local pid
    for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
    wait 2>/dev/null || true
    [[ ${KEEP_STATE:-} ]] || rm -rf "$state"
}
trap stop EXIT
# Ports that differ from those of a Slurm that runs here.
port=$((20000 + $$ % 20000))
mkdir -p "$state"/{munge,save,spool}
chmod 700 "$state/munge"
head -c 1024 /dev/urandom >"$state/munge/key"
chmod 400 "$state/munge/key"
cat >"$state/slurm.conf" <<END
ClusterName=gaitway
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$state/munge/socket
CryptoType=crypto/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=5
KillWait=2
MessageTimeout=20
StateSaveLocation=$state/save
SlurmdSpoolDir=$state/spool/%n
SlurmctldPidFile=$state/slurmctld.pid
SlurmdPidFile=$state/slurmd-%n.pid
SlurmctldLogFile=$state/slurmctld.log
SlurmdLogFile=$state/slurmd-%n.log
JobAcctGatherType=jobacct_gather/none
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=one NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 State=UNKNOWN
NodeName=two NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 State=UNKNOWN
PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$state/slurm.conf
give_up() {
    echo "slurm: $1"
    tail -n 3 "$state"/*.log 2>/dev/null || true
    exit 5
}
munged --foreground --force --key-file="$state/munge/key" --socket="$state/munge/socket" --pid-file="$state/munge/pid" \
    --log-file="$state/munge/log" --seed-file="$state/munge/seed" >/dev/null 2>&1 &
pids+=($!)
for _ in {1..50}; do [[ ! -S $state/munge/socket ]] || break; sleep 0.1; done
[[ -S $state/munge/socket ]] || give_up "munged does not start"
slurmctld -D >/dev/null 2>&1 &
pids+=($!)
for name in one two; do
    slurmd -D -N "$name" >/dev/null 2>&1 &
    pids+=($!)
done
for _ in {1..100}; do
    [[ $(sinfo -h -o '%T %D' 2>/dev/null) != "idle 2" ]] || break
    sleep 0.2
done
[[ $(sinfo -h -o '%T %D' 2>/dev/null) == "idle 2" ]] || give_up "its nodes do not come up: $(sinfo -h 2>&1 | head -n 2)"

runs=$(sed -n '1s/.*"runs":\([0-9]*\).*/\1/p' "$folder/plan.jsonl")
# Enough for a job that a kill finds at work to have runs left.
each=6
last=$(((runs - 1) / each))
submit() {
    sbatch --parsable --chdir="$folder" --array="0-$last" --export="ALL,EACH=$each,GAITWAY=$gaitway" \
        "$here/../../examples/cluster/slurm.sh" "$folder/plan.jsonl" "$folder/slurm"
}
done_runs() { find "$folder/slurm" -maxdepth 1 -name 'run=*' | wc -l; }
finish() {
    for _ in {1..600}; do
        [[ -n $(squeue -h -j "$1" 2>/dev/null) ]] || break
        sleep 0.1
    done
}
# A job at work, once a run is done. The pattern is ours alone: the folder has a random name.
kill_one() {
    local victim finished
    for _ in {1..3000}; do
        finished=$(done_runs)
        ((finished < runs)) || return 0
        if ((finished > 0)); then
            victim=$(pgrep -f "run $folder/plan.jsonl .*$folder/slurm" | head -n 1) || true
            [[ ! $victim ]] || ! kill -9 "$victim" 2>/dev/null || return 0
        fi
        sleep 0.01
    done
}
# On a busy machine a kill may come when a job has done its last run: nothing is left
# to do again then, and another array is submitted.
for _ in {1..5}; do
    rm -rf "$folder/slurm"
    mkdir "$folder/slurm" # so that its runs can be counted from the beginning
    job=$(submit)
    kill_one
    finish "$job"
    before=$(done_runs)
    ((before == runs)) || break
done
((before < runs)) || { echo "slurm: nothing was missing in five arrays, although a job of each was killed"; exit 1; }
# The same array again does what is missing.
finish "$(submit)"
echo "slurm: $(done_runs) of $runs runs by an array of $((last + 1)) jobs on two nodes, $((runs - before)) of them by the second" \
    "submission, since a job was killed in the first"
(($(done_runs) == runs))
