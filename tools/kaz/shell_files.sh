#!/bin/sh
# Completion and manual pages, a page a verb: usage: shell_files.sh KAZ FOLDER
# SPDX-License-Identifier: Apache-2.0
set -eu
kaz=$1
cd "$2"
"$kaz" completion bash >kaz
"$kaz" man >kaz.1
sed -n "s/^ *'kaz \([a-z -]*\)') words=.*/\1/p" kaz | while read -r verb; do
  # shellcheck disable=SC2086  # several words
  # Where this build found its firmware is no fact of an installed one.
  "$kaz" man $verb | sed '/^The firmware of this kaz: /d' >"kaz-$(echo "$verb" | tr ' ' -).1"
done
