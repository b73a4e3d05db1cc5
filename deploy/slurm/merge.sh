#!/bin/sh
#SBATCH --job-name=shadercheck-merge
# Joins what the tasks found: merge.sh DIR. The report is in DIR/report.txt, and the exit status is that of the
# run: 1 when something was found.
set -eu
dir=$1
status=0
"${SHADERCHECK:-shadercheck}" merge "$dir" > "$dir/.report.txt.new" || status=$?
mv "$dir/.report.txt.new" "$dir/report.txt"
cat "$dir/report.txt"
exit "$status"
