#!/bin/sh
# Shares a run of shadercheck out over the tasks of a Slurm array job, and joins the results in a job that waits
# for all of them.
#
#   submit.sh SHARDS DIR COMMAND...
#   submit.sh 64 results check --shipped --samples 1000000000
#
# DIR is a folder that all nodes see. Prints the numbers of both jobs. A task that is requeued goes on from its last
# checkpoint; submitting again with the same arguments does what is missing, and no more.
#
#   SHADERCHECK     the program; `shadercheck` on PATH without it
#   SBATCH_OPTIONS  more options for both jobs, such as `--partition=short --time=60`
set -eu
if [ "$#" -lt 3 ]; then
    sed -n '5,6s/^# *//p' "$0" >&2
    exit 2
fi
shards=$1
dir=$2
shift 2
case $shards in
    '' | *[!0-9]* | 0) echo "submit.sh: \`$shards\` is no number of shards" >&2; exit 2 ;;
esac
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
mkdir -p "$dir"
dir=$(CDPATH='' cd -- "$dir" && pwd)
export SHADERCHECK="${SHADERCHECK:-shadercheck}"
# shellcheck disable=SC2086 # several options in one variable
array=$(sbatch --parsable --array="0-$((shards - 1))" --output="$dir/shard-%a.log" --open-mode=append \
    ${SBATCH_OPTIONS:-} "$here/shards.sh" "$dir" "$@")
# shellcheck disable=SC2086
merge=$(sbatch --parsable --dependency="afterok:$array" --output="$dir/merge.log" \
    ${SBATCH_OPTIONS:-} "$here/merge.sh" "$dir")
echo "shards $array"
echo "merge $merge"
