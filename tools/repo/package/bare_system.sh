#!/bin/sh
# In a bare Debian: installs the packages from /srv/packages, runs the demo, upgrades to /srv/next, removes all.
# SPDX-License-Identifier: Apache-2.0
set -eu
export DEBIAN_FRONTEND=noninteractive

echo "deb [trusted=yes] file:/srv/packages ./" >/etc/apt/sources.list.d/kaz.list
apt-get update -q
apt-get install -qy --no-install-recommends kaz >/dev/null
for compiler in cc gcc g++ c++ clang; do
  ! command -v "$compiler" || { echo "a compiler came with the package: $compiler"; exit 1; }
done
kaz --version
kaz demo --out demo
test -s demo/result.json
kaz conformance --virtual h8 --filter identify

apt-get install -qy --no-install-recommends kaz-dev python3-kaz kaz-doc >/dev/null
echo "deb [trusted=yes] file:/srv/next ./" >/etc/apt/sources.list.d/kaz.list
apt-get update -q
apt-get upgrade -qy >/dev/null
upgraded=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package} ${Version}\n' kaz kaz-firmware kaz-dev python3-kaz kaz-doc)
echo "$upgraded"
test "$(echo "$upgraded" | grep -c '^ii .*+next$')" = 5
kaz run stand --out stood

packages="kaz kaz-firmware kaz-dev python3-kaz kaz-doc"
# shellcheck disable=SC2086  # several words
files=$(dpkg -L $packages | sort -u)
# shellcheck disable=SC2086
apt-get purge -qy $packages >/dev/null
echo "$files" | while read -r file; do
  # Folders may be others', too.
  if [ ! -d "$file" ] || [ -z "${file##*/kaz*}" ]; then
    test ! -e "$file" || { echo "left behind: $file"; exit 1; }
  fi
done
left=$(find /etc /usr /var/lib /opt -ipath '*kaz*' ! -path '/var/lib/apt/*' ! -path '/etc/apt/*' | head)
test -z "$left" || { echo "left behind: $left"; exit 1; }
echo "installed, ran, upgraded, removed without a trace"
