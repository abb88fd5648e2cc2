#!/bin/sh
# Completion and manual pages, a page a verb: usage: shell_files.sh KAZ FOLDER
# SPDX-License-Identifier: Apache-2.0
set -eu
kaz=$1
cd "$2"
"$kaz" completion bash >kaz
"$kaz" man >kaz.1
sed -n "s/^ *'kaz \([a-z -]*\)') words=.*/\1/p" kaz | while read -r verb; do
  page=kaz-$(echo "$verb" | tr ' ' -).1
  # shellcheck disable=SC2086  # several words
  "$kaz" man $verb >"$page"
  # Where this build found its firmware is no fact of an installed one.
  sed -i '/^The firmware of this kaz: /d' "$page"
done
