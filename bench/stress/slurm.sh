#!/bin/sh
# The fine maps of stability on a cluster with Slurm, from the root of the repository, on a file system that all nodes see:
#
#   make build
#   job=$(sbatch --parsable --array=1-16 bench/stress/slurm.sh)
#   sbatch --dependency=afterok:$job bench/stress/slurm.sh merge
#
# Shard i of n writes build/results/stability-i-of-n.jsonl. An interrupted shard continues where it stopped when its job
# is submitted again: sbatch --array=3 --export=ALL,SHARDS=16 bench/stress/slurm.sh
#SBATCH --job-name=tumble-stress
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --time=01:00:00
#SBATCH --output=build/results/stress-%A-%a.txt
set -eu
program=build/host/bench/stress/tumble_stress
status=0
if [ "${1:-}" = merge ]; then
    files=$(ls build/results/stability-*-of-*.jsonl | paste -sd,)
    "$program" --merge "$files" --results bench/results/stability.jsonl --directory bench/results || status=$?
    exit $status
fi
shards=${SHARDS:-$SLURM_ARRAY_TASK_COUNT}
# The merge reports silent cells, status 3.
"$program" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
    --results "build/results/stability-$SLURM_ARRAY_TASK_ID-of-$shards.jsonl" || status=$?
[ "$status" -eq 3 ] || exit "$status"
