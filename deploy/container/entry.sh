#!/bin/sh
# Runs shadercheck as the owner of the folder that is mounted, who can write there. A container that is started as a user other
# than root stays that user. Nothing is run as root: a folder of root's is used by `nobody`.
set -eu

if [ "$(id -u)" -eq 0 ]; then
    owner=$(stat -c %u:%g .)
    user=${owner%:*}
    group=${owner#*:}
    if [ "$user" -eq 0 ]; then
        user=65534 group=65534
    fi
    exec setpriv --reuid "$user" --regid "$group" --clear-groups shadercheck "$@"
fi
exec shadercheck "$@"
