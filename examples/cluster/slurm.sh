#!/bin/bash
# A sweep as a Slurm array, one job for every EACH runs of the plan:
#   runs=$(gaitway plan sweep.toml --out plan.jsonl --json | jq .runs)
#   sbatch --array=0-$(((runs - 1) / 10)) --export=ALL,EACH=10 slurm.sh plan.jsonl /shared/runs
# A job that is requeued, or the same array submitted again, does what is missing and nothing else.
#SBATCH --job-name=gaitway
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
#SBATCH --requeue
#SBATCH --output=gaitway-%A_%a.log
set -euo pipefail
plan=$1 runs=$2 each=${EACH:-1}
first=$((SLURM_ARRAY_TASK_ID * each))
# Slurm counts in cores, and so does the thread pool.
export RAYON_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec "${GAITWAY:-gaitway}" run "$plan" --index "$first..$((first + each))" --out "$runs" --backend "${BACKEND:-cpu}"
