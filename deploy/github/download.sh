#!/bin/sh
# Downloads the program of a release: download.sh VERSION FOLDER. Without a release, a binary for this platform or the right sum,
# it says so and ends with 1; the action then builds the program.
#
#   BASE  address that releases lie below: https://github.com/OWNER/shadercheck/releases/download
set -eu

version=$1
folder=$2

give_up() {
    echo "shadercheck is built from source: $1"
    exit 1
}

case "$(uname -s)-$(uname -m)" in
    Linux-x86_64) target=x86_64-unknown-linux-gnu ;;
    Linux-aarch64 | Linux-arm64) target=aarch64-unknown-linux-gnu ;;
    Darwin-x86_64) target=x86_64-apple-darwin ;;
    Darwin-arm64) target=aarch64-apple-darwin ;;
    *) give_up "there is no archive for $(uname -s) on $(uname -m)" ;;
esac
case $version in
    v[0-9]*) ;;
    *) give_up "\`$version\` is no version of a release" ;;
esac

name=shadercheck-$target
mkdir -p "$folder/bin"
for file in "$name.tar.gz" "$name.tar.gz.sha256"; do
    curl --fail --silent --show-error --location --retry 3 --output "$folder/$file" "$BASE/$version/$file" ||
        give_up "$BASE/$version/$file cannot be downloaded"
done
# `shasum` is on all machines of GitHub; the file names the archive.
sum=$(shasum -a 256 "$folder/$name.tar.gz" | cut -d ' ' -f 1)
[ "$sum" = "$(cut -d ' ' -f 1 "$folder/$name.tar.gz.sha256")" ] || give_up "$name.tar.gz has another SHA-256 than its release says"
tar -xzf "$folder/$name.tar.gz" -C "$folder/bin" --strip-components=1
"$folder/bin/shadercheck" --version || give_up "the program of $name.tar.gz does not start here"
