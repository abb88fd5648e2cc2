#!/usr/bin/env bash
# Debian packages of the checked-out commit, built and tried in clean chroots: usage: packages.sh [OPTION ...]
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

usage() {
  cat <<'TEXT'
usage: ./tools/dev packages [--twice] [--no-test] [--built] [--suite S]

Builds the Debian packages of the checked-out commit for Debian 12: kaz, kaz-firmware, kaz-dev, python3-kaz and
kaz-doc. Writes them to out/packages, which is an archive for apt with SHA256SUMS. The build runs without network, in a
chroot that contains only the packages named in debian/control. Then lintian examines the packages. A bare system
without a compiler installs the packages, runs `kaz demo`, and upgrades and removes the packages. Files that remain
after the removal are an error. At the end, autopkgtest runs debian/tests.

  --twice     build a second time with another user name, home, time zone and language; the packages must be equal
  --no-test   build and examine the packages, but do not install them
  --built     do not build; use the packages that an earlier run has built
  --suite S   Debian release (default: bookworm)

Needs about 6 GB in build/packages, root or sudo, and the network to download packages of Debian and npm.
TEXT
}

say() { printf '== %s\n' "$*"; }
die() { printf 'packages: %s\n' "$*" >&2; exit 1; }

twice=0 test=1 built=0 suite=bookworm
while [ $# -gt 0 ]; do
  case $1 in
    --twice) twice=1 ;;
    --no-test) test=0 ;;
    --built) built=1 ;;
    --suite) suite=${2:?--suite needs a name}; shift ;;
    -h|--help) usage; exit ;;
    *) usage >&2; die "unknown option $1" ;;
  esac
  shift
done

as_root=()
[ "$(id -u)" = 0 ] || as_root=(sudo)
work=$PWD/build/packages out=$PWD/out/packages
version=$(dpkg-parsechangelog -SVersion)
upstream=${version%-*}
stated=$(sed -n 's/^project(kaz VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ "$upstream" = "$stated" ] || die "debian/changelog has $upstream, CMakeLists.txt $stated: they must be equal"
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
[ -z "$(git status --porcelain)" ] || say "beware: the checkout has changes that are in no commit, and not packaged"

# Sorted, without owner or time of their own.
archive() { tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -c "$@" | gzip -n -6; }

# The source package: the commit without debian/, npm's packages for the page, debian/.
source_package() {
  local lock=tools/viewer/page/package-lock.json npm=$work/npm wanted
  mkdir -p "$work/source"
  wanted=$(sha256sum "$lock" | cut -d' ' -f1)
  if [ "$(cat "$npm/installed" 2>/dev/null)" != "$wanted" ]; then
    say "packages of npm for the page"
    rm -rf "$npm"
    mkdir -p "$npm"
    cp tools/viewer/page/package.json "$lock" "$npm"
    (cd "$npm" && npm ci --ignore-scripts --no-audit --no-fund --prefer-offline)
    printf %s "$wanted" >"$npm/installed"
  fi
  say "source package $version"
  rm -rf "$work/source"
  mkdir -p "$work/source/kaz-$upstream"
  git archive --prefix="kaz-$upstream/" HEAD -- . ':(exclude)debian' | gzip -n -6 >"$work/source/kaz_$upstream.orig.tar.gz"
  archive -C "$work" npm >"$work/source/kaz_$upstream.orig-npm.tar.gz"
  tar -xzf "$work/source/kaz_$upstream.orig.tar.gz" -C "$work/source"
  tar -xzf "$work/source/kaz_$upstream.orig-npm.tar.gz" -C "$work/source/kaz-$upstream"
  git archive HEAD debian | tar -x -C "$work/source/kaz-$upstream"
  (cd "$work/source" && dpkg-source -b "kaz-$upstream")
  rm -r "$work/source/kaz-$upstream"
}

# in_chroot PACKAGES HOOK ...: a new system with these packages alone, and mmdebstrap's hooks in it. Nothing is kept.
in_chroot() {
  local packages=$1 hooks=() hook
  shift
  for hook in "$@"; do hooks+=("--customize-hook=$hook"); done
  "${as_root[@]}" mmdebstrap --variant=apt ${packages:+--include="$packages"} "${hooks[@]}" "$suite" /dev/null
}

# build FOLDER PATH ENVIRONMENT ...: the packages into FOLDER, built in a chroot below PATH, without network.
build() {
  local folder=$1 path=$2 needed
  shift 2
  # What debian/control names, and nothing else but build-essential.
  needed=$(sed -n '/^Build-Depends:/,/^[A-Z]/s/^ \([a-z0-9+.-]*\).*/\1/p' debian/control |
    sed 's/debhelper-compat/debhelper/' | paste -sd,)
  rm -rf "$folder"
  mkdir -p "$folder"
  # shellcheck disable=SC2016
  in_chroot "build-essential,fakeroot,$needed" \
    'chroot "$1" useradd -m builder' \
    "mkdir -p \"\$1$path\"" \
    "copy-in $(printf '%s ' "$work"/source/*) $path" \
    "chroot \"\$1\" chown -R builder: $path" \
    "chroot \"\$1\" unshare -n su builder -c 'cd $path && $* dpkg-source -x kaz_$version.dsc src && cd src && \
      $* env -u SOURCE_DATE_EPOCH DEB_BUILD_OPTIONS=parallel=$(nproc) nice dpkg-buildpackage -us -uc -b'" \
    "rm -rf \"\$1$path/src\"" \
    "sync-out $path $folder"
  [ "$(id -u)" = 0 ] || "${as_root[@]}" chown -R "$(id -u):$(id -g)" "$folder"
}

# An archive that apt can use, in place of the one before only when it is whole.
publish() {
  rm -rf "$out.part"
  mkdir -p "$out.part"
  cp "$work/built"/* "$out.part"
  (cd "$out.part" && apt-ftparchive packages . >Packages && gzip -kn9 Packages &&
    apt-ftparchive release . >Release && find . -type f ! -name SHA256SUMS -printf '%P\n' | sort | xargs sha256sum >SHA256SUMS)
  rm -rf "$out"
  mv "$out.part" "$out"
}

# The next version of each package with the same content, for the upgrade.
next_version() {
  local deb folder=$work/next
  rm -rf "$folder"
  mkdir -p "$folder"
  for deb in "$out"/*.deb; do
    case $deb in *-dbgsym_*) continue ;; esac
    dpkg-deb -R "$deb" "$folder/tree"
    sed -i "s/^Version: .*/&+next/; s/(= $version)/(= $version+next)/" "$folder/tree/DEBIAN/control"
    dpkg-deb --root-owner-group -b "$folder/tree" "$folder/$(basename "$deb" .deb)+next.deb" >/dev/null
    rm -r "$folder/tree"
  done
  (cd "$folder" && apt-ftparchive packages . >Packages)
}

if [ "$test" = 1 ]; then stages=4; else stages=2; fi
if [ "$built" = 1 ]; then
  ls "$work/built"/*.changes >/dev/null 2>&1 || die "--built: nothing is built yet; leave it out"
else
  say "1 of $stages: source package"
  source_package
  say "2 of $stages: packages, in a chroot without network (some 15 minutes on two cores)"
  build "$work/built" /build/kaz LANG=C.UTF-8
fi
say "lintian"
# These are no upload to Debian: there is no bug to close, and no address to write to.
lintian --fail-on error,warning --suppress-tags initial-upload-closes-no-bugs,bogus-mail-host \
  --suppress-tags bogus-mail-host-in-debian-changelog "$work/built"/*.changes "$work/source"/*.dsc ||
  die "lintian found what is above"
if [ "$twice" = 1 ]; then
  say "the same once more, in other circumstances"
  # In the same path: GCC 3.4 for the H8 writes it into the debug information and cannot map it.
  build "$work/again" /build/kaz LANG=fr_FR.UTF-8 TZ=Pacific/Kiritimati USER=other HOME=/tmp
  for deb in "$work/built"/*.deb; do
    cmp "$deb" "$work/again/$(basename "$deb")" || die "the two builds differ: compare them with diffoscope"
  done
  say "both builds are the same, byte for byte"
fi
publish
[ "$test" = 1 ] || { say "packages are in out/packages; they were not installed anywhere"; exit; }

say "3 of $stages: installed into a bare system, upgraded, removed"
next_version
in_chroot "" \
  "copy-in $out /srv" "copy-in $work/next /srv" "copy-in tools/repo/package/bare_system.sh /root" \
  'chroot "$1" sh /root/bare_system.sh'
say "4 of $stages: debian/tests under autopkgtest"
in_chroot "autopkgtest" \
  "copy-in $out /srv" "copy-in $work/source /srv" \
  'chroot "$1" sh -c "cd /srv && autopkgtest packages/*.deb source/*.dsc -- null"'
say "packages are in out/packages: apt install ./out/packages/kaz_*.deb ./out/packages/kaz-firmware_*.deb"
