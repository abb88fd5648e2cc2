#!/bin/sh
# Builds GDB for the H8S from Debian's sources: usage: build_gdb.sh FOLDER; the program is FOLDER/gdb/gdb. Some minutes.
# SPDX-License-Identifier: Apache-2.0
set -eu
case ${1:-} in
  ''|-*)
    sed -n '2s/^# //p' "$0"
    echo "needs: apt-get install g++ make gdb-source libgmp-dev libexpat1-dev zlib1g-dev"
    exit 2
    ;;
esac
folder=$1
if [ -x "$folder/gdb/gdb" ]; then
  echo "there already: $folder/gdb/gdb"
  exit
fi
set -- /usr/src/gdb.tar.*
[ -e "$1" ] || {
  echo "build_gdb.sh: GDB's sources are missing: apt-get install gdb-source libgmp-dev libexpat1-dev zlib1g-dev" >&2
  exit 3
}
rm -rf "$folder" "$folder-source"
mkdir -p "$folder" "$folder-source"
tar xf "$1" -C "$folder-source" --strip-components=1
source=$(cd "$folder-source" && pwd)
cd "$folder"
echo "building GDB; log in $PWD/build.log"
{
  "$source/configure" --target=h8300-elf --disable-gdbserver --disable-sim --disable-binutils --disable-ld --disable-gas \
    --disable-gprof --disable-nls --disable-werror --disable-source-highlight --disable-tui --without-python \
    --without-debuginfod
  make -j "${KAZ_JOBS:-$(nproc)}" all-gdb MAKEINFO=true
} >build.log 2>&1 || { echo "build_gdb.sh: GDB did not build: the reason is at the end of $PWD/build.log" >&2; exit 1; }
rm -rf "$source"
echo "$PWD/gdb/gdb"
