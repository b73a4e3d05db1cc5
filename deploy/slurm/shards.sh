#!/bin/sh
#SBATCH --job-name=shadercheck
#SBATCH --requeue
# One task of the array job that submit.sh starts: shards.sh DIR COMMAND...
# `--shard auto` reads the number of the task, and of how many, from Slurm's variables. To run some tasks again
# alone, export SHADERCHECK_SHARD_COUNT with the number of all.
set -eu
dir=$1
command=$2
shift 2
# The parts of reference data are files of their own: submit.sh 64 data refdata generate sphere --samples 1000000000
if [ "$command" = refdata ]; then
    exec "${SHADERCHECK:-shadercheck}" refdata "$@" --shard auto --output "$dir"
fi
exec "${SHADERCHECK:-shadercheck}" "$command" "$@" --shard auto --shard-dir "$dir"
