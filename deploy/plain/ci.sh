#!/bin/sh
# Lints, checks and fuzzes shaders as a CI job does: ci.sh [PATH...] (default: the current folder).
#
#   RUN          what to do, separated by blanks: lint, check and fuzz (default: lint check)
#   ARGS         further options of `shadercheck check`, separated by blanks
#   LINT_ARGS    further options of `shadercheck lint`
#   FUZZ_ARGS    further options of `shadercheck fuzz`
#   LANES        only these lanes, separated by commas (default: all available)
#   REQUIRE      lanes that must be available, separated by commas
#   FORMAT       how findings are printed: text (the default), or github for annotations
#   REPORTS      folder for the reports (shadercheck-reports)
#   SUMMARY      file that a summary in Markdown is added to; $GITHUB_STEP_SUMMARY on GitHub
#   SHADERCHECK  the program (default: shadercheck on PATH)
#
# Exit status: 0 clean, 1 findings, 2 something could not be run.
set -eu

shadercheck=${SHADERCHECK:-shadercheck}
run=${RUN:-lint check}
format=${FORMAT:-text}
reports=${REPORTS:-shadercheck-reports}
summary=${SUMMARY:-${GITHUB_STEP_SUMMARY:-}}
worst=0

if [ $# -eq 0 ]; then
    set -- .
fi
case $format in
    text | github) ;;
    *)
        echo "ci.sh: FORMAT is \`$format\`; it is text or github" >&2
        exit 2
        ;;
esac
for what in $run; do
    case $what in
        lint | check | fuzz) ;;
        *)
            echo "ci.sh: RUN has \`$what\`; it is lint, check or fuzz" >&2
            exit 2
            ;;
    esac
done
mkdir -p "$reports"

# Runs a command and keeps the worst status: a finding of one does not keep the others from running.
try() {
    status=0
    "$@" || status=$?
    # 127 is a program that is not there.
    if [ "$status" -gt 2 ]; then
        status=2
    fi
    if [ "$status" -gt "$worst" ]; then
        worst=$status
    fi
}

has() {
    case " $run " in
        *" $1 "*) return 0 ;;
        *) return 1 ;;
    esac
}

# Called by `try`, by name.
# shellcheck disable=SC2317
lint() {
    rm -f "$reports/lint.sarif"
    # Options are lists of words.
    # shellcheck disable=SC2086
    "$shadercheck" lint "$@" ${LINT_ARGS:-} --format "$format" && found=0 || found=$?
    # shellcheck disable=SC2086
    "$shadercheck" lint "$@" ${LINT_ARGS:-} --format sarif --output "$reports/lint.sarif" --exit-zero > "$reports/lint.txt"
    return "$found"
}

# shellcheck disable=SC2317
check() {
    rm -f "$reports/summary.md"
    # shellcheck disable=SC2086
    "$shadercheck" check "$@" ${LANES:+--lane "$LANES"} ${REQUIRE:+--require-lane "$REQUIRE"} ${ARGS:-} \
        --report-dir "$reports" --format "$format"
}

# Its reports have the names of those of check.
# shellcheck disable=SC2317
fuzz() {
    rm -f "$reports/fuzz/summary.md"
    # shellcheck disable=SC2086
    "$shadercheck" fuzz "$@" ${LANES:+--lane "$LANES"} ${FUZZ_ARGS:-} --report-dir "$reports/fuzz" --format "$format"
}

if has lint; then
    try lint "$@"
    linted=$status
fi
if has check; then
    try check "$@"
fi
if has fuzz; then
    try fuzz "$@"
fi

if [ -n "$summary" ]; then
    if has lint; then
        {
            echo "## shadercheck lint"
            echo
            if [ "$linted" -eq 0 ]; then
                echo "No findings."
            else
                # A page of a run is no place for thousands of lines.
                echo '```text'
                head -c 20000 "$reports/lint.txt"
                echo '```'
            fi
            echo
        } >> "$summary"
    fi
    if has check && [ -f "$reports/summary.md" ]; then
        cat "$reports/summary.md" >> "$summary"
    fi
    if has fuzz && [ -f "$reports/fuzz/summary.md" ]; then
        cat "$reports/fuzz/summary.md" >> "$summary"
    fi
fi
exit "$worst"
