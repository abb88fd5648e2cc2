#!/usr/bin/env bash
# Writes a release: archives of sources and installation, firmware, bill of materials, changes, checksums.
# SPDX-License-Identifier: Apache-2.0
#
# usage: release.sh --name       print the release's name
#        release.sh BUILD OUT    write the release of BUILD, a build of this commit, to the folder OUT
#
# Run it in the root of a clone without changes. The same commit and the same build give the same bytes. OUT
# appears only when it is complete.
set -euo pipefail
umask 022
unset GZIP
export LC_ALL=C.UTF-8 TZ=UTC0

die() { printf 'release: %s\n' "$*" >&2; exit 1; }

changed=$(git status --porcelain --untracked-files=normal) || die 'a release is made in a clone'
[ -z "$changed" ] || die "uncommitted changes; commit, stash or remove them:
$(head -20 <<<"$changed")"
version=$(sed -n 's/^project(kaz VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
title=Unreleased name=$version-$(git rev-parse --short=12 HEAD)
if git tag --points-at HEAD | grep -qx "v$version"; then
  title=$version name=$version
fi
if [ "${1-}" = --name ]; then
  echo "$name"
  exit
fi
[ $# = 2 ] || die 'give two folders: BUILD and OUT'
build=$(realpath "$1") out=$(realpath -m "$2")
if [ -e "$out" ] && [ ! -e "$out/SHA256SUMS" ] && [ -n "$(ls -A "$out")" ]; then
  die "$out exists and is not a release; give another folder"
fi
changes=$(awk -v title="## [$title]" 'index($0, "## [") == 1 { on = index($0, title) == 1; next } on' CHANGELOG.md)
[ "$title" = Unreleased ] || [ -n "$changes" ] ||
  die "CHANGELOG.md has no section [$title] for the tag v$version: rename [Unreleased]"

new=$out.partial
rm -rf "$new"
trap 'rm -rf "$new"' EXIT
trap 'exit 130' INT TERM
mkdir -p "$new"
cd "$new"
root=$OLDPWD
git=(git -C "$root" -c tar.umask=0022 -c core.autocrlf=false -c core.eol=lf)
"${git[@]}" archive --format=tar --prefix="kaz-$name/" HEAD | gzip -n9 >"kaz-$name-source.tar.gz"

cmake --install "$build" --prefix "$new/kaz-$name" >/dev/null || die "cmake --install $build failed (above)"
# An installation silently lacks these if a package was missing when it was built.
for part in bin/kaz share/kaz/firmware/{kaz.mot,kaz.coff,writer.bin} share/kaz/view/index.html \
  lib/kaz/{ompl_planner,world_reader}.so; do
  [ -f "kaz-$name/$part" ] || die "$build was built without $part; run ./tools/dev setup, then build again"
done
for image in kaz.mot kaz.coff writer.bin; do
  cp "kaz-$name/share/kaz/firmware/$image" "kaz-$name-$image"
done
# The notices of libraries whose code may be in the programs or in the page.
notices=kaz-$name/share/doc/kaz/third-party
mkdir -p "$notices"
sed '/^# \[build\]/,/^# \[run\]/!d; /^#/d; /^$/d' "$root/tools/packages.txt" | while read -r package; do
  [ ! -e "/usr/share/doc/$package/copyright" ] || cp -L "/usr/share/doc/$package/copyright" "$notices/$package"
done
for license in "$build"/tools/viewer/page/npm/node_modules/{three,urdf-loader}/LICENSE*; do
  [ ! -e "$license" ] || cp "$license" "$notices/npm-$(basename "$(dirname "$license")")"
done
# shellcheck source=/dev/null
system=$(. /etc/os-release && echo "${ID-linux}${VERSION_ID-}-$(dpkg --print-architecture)")
tar -c --format=gnu --sort=name --owner=root:0 --group=root:0 --mode=u=rwX,go=rX \
  --mtime="@$("${git[@]}" log -1 --format=%ct)" "kaz-$name" | gzip -n9 >"kaz-$name-$system.tar.gz"
rm -r "kaz-$name"

reuse --root "$root" spdx | sed "/^Created:/s/ .*/ $("${git[@]}" log -1 --format=%cd --date=format-local:%Y-%m-%dT%H:%M:%SZ)/; \
s|^DocumentName: .*|DocumentName: kaz-$name|; s|^DocumentNamespace: .*|DocumentNamespace: https://spdx.org/spdxdocs/kaz-$name|" >"kaz-$name.spdx"
printf '%s\n' "$changes" | sed '/./,$!d' >"kaz-$name-changes.md"
sha256sum -- * >SHA256SUMS.new
mv SHA256SUMS.new SHA256SUMS
cd "$root"
rm -rf "$out"
mv "$new" "$out"
echo "== release: kaz-$name in $out"
