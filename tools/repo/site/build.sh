#!/bin/sh
# Builds the documentation as HTML: the tree's Markdown pages with Sphinx, the headers' API pages with Doxygen.
# SPDX-License-Identifier: Apache-2.0
# usage: build.sh OUT   OUT: folder of the site; replaced when the new site is complete
set -eu
out=$(realpath -m "$1")
cd "$(dirname "$0")/../../.."
if [ -e "$out" ] && [ ! -e "$out/searchindex.js" ] && [ -n "$(ls -A "$out")" ]; then
  echo "site: $out exists and is not a site; give another folder" >&2
  exit 1
fi
new=$out.new
rm -rf "$new" "$new.doctrees"
trap 'rm -rf "$new" "$new.doctrees"' EXIT
trap 'exit 130' INT TERM
mkdir -p "$new"
echo "site: pages"
LC_ALL=C.UTF-8 /usr/bin/python3 -B -m sphinx -q -W --keep-going -b html -c tools/repo/site -d "$new.doctrees" . "$new"
echo "site: API"
KAZ_SITE=$new doxygen tools/repo/site/Doxyfile
rm -rf "$out"
mv "$new" "$out"
echo "site: $out/index.html"
