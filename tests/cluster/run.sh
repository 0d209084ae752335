#!/usr/bin/env bash
# One sweep four times: in order, on a Ray cluster, as a Slurm array, and again. All hashes must be equal.
#   tests/cluster/run.sh GAITWAY [SWEEP.toml [SECONDS]]
# With SECONDS a worker of Ray is killed every so often, else once. GAITWAY_RAY names a Python that has Ray; without it, or
# without Slurm, that part is skipped and says so.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
gaitway=$(readlink -f "$1") sweep=${2:-$here/short.toml} every=${3:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$gaitway" plan "$sweep" --out "$folder/plan.jsonl"
begin=$EPOCHREALTIME
"$gaitway" run "$folder/plan.jsonl" --out "$folder/serial" --backend cpu --quiet
awk -v from="$begin" -v to="$EPOCHREALTIME" 'BEGIN { printf "serial: %.1f s\n", to - from }'

others=()
if [[ -n ${GAITWAY_RAY:-} ]]; then
    # shellcheck disable=SC2086  # may be empty
    "$GAITWAY_RAY" "$here/ray_cluster.py" "$gaitway" "$folder" $every 2>"$folder/ray.log" || { tail -n 30 "$folder/ray.log"; exit 1; }
    others+=("$folder/ray")
else
    echo "skipped: set GAITWAY_RAY to a python that has ray"
fi
status=0
"$here/slurm.sh" "$gaitway" "$folder" || status=$?
case $status in
0) others+=("$folder/slurm") ;;
5) echo "skipped: no Slurm starts here" ;;
*) exit 1 ;;
esac
# As any scheduler tells it, where there is none.
SLURM_ARRAY_TASK_ID=1 "$gaitway" run "$folder/plan.jsonl" --out "$folder/told" --quiet >/dev/null
JOB_COMPLETION_INDEX=2 "$gaitway" run "$folder/plan.jsonl" --out "$folder/told" --quiet >/dev/null
[[ $("$gaitway" plan "$folder/plan.jsonl" --status --out "$folder/told") == *"done       2"* ]]
python3 "$here/equal.py" "$folder/serial" "${others[@]}"
# What is done is not done again, in less than a millisecond a run.
"$gaitway" run "$folder/plan.jsonl" --out "$folder/serial" --json | python3 -c 'import json, sys
found = json.load(sys.stdin)
assert found["skipped"] == found["runs"] > 0 and found["done"] == 0, found
print("again: %.4f ms a run" % (1000 * found["wall_seconds"] / found["runs"]))
assert found["wall_seconds"] < 0.001 * found["runs"] + 0.05, found'
