#!/bin/sh
# Each verb that needs files of Kaz, from an installed program in an empty folder: usage: installed.sh PREFIX FOLDER
# SPDX-License-Identifier: Apache-2.0
set -eu
prefix=$1
cd "$2"
export PATH="$prefix/bin:/usr/bin:/bin"
unset KAZ_DATA
share=$prefix/share
for file in kaz/firmware/kaz.mot kaz/firmware/kaz.coff kaz/firmware/writer.bin kaz/udev/70-kaz.rules \
  kaz/wireshark/kaz.lua kaz/robots/arm/arm.urdf kaz/examples/python/kaz_client.py \
  kaz/examples/behavior/wave.cpp kaz/examples/h8s/seconds.c kaz/gdb/coff_to_elf.py man/man1/kaz.1 \
  man/man1/kaz-flash-write.1 doc/kaz/LICENSE doc/kaz/CHANGELOG.md \
  bash-completion/completions/kaz; do
  test -s "$share/$file" || { echo "not installed: $file"; exit 1; }
done

simulator=
trap 'test -z "$simulator" || kill "$simulator"' EXIT

# What is printed counts only where a verb fails.
try() {
  if ! "$@" >said 2>&1; then
    echo "failed: $*"
    cat said
    exit 1
  fi
}

begin() {
  rm -f sim.out
  kaz sim --serial board "$@" >sim.out 2>&1 &
  simulator=$!
  until grep -qs ready sim.out; do
    kill -0 "$simulator" || { cat sim.out; exit 1; }
    sleep 0.1
  done
}
end() {
  kill "$simulator"
  wait "$simulator"
  simulator=
}

try kaz run stand --out stood
try kaz replay stood/recording.mcap
try kaz run stand --mcu native --robot-file "$share/kaz/robots/arm/arm.urdf"
try kaz run search-ball --mcu native --record-pictures --out tracked
# Also of a build without OMPL, whose planner's refusal (exit status 3) names the package.
kaz run navigate --goal 0.1,0 --mcu native --set planner=ompl >said 2>&1 || grep -q "not in this build" said ||
  { cat said; exit 1; }
try kaz vision run --in tracked --frames 5 --out seen
try kaz eyes --out drawn
try kaz evaluate stand --mcu native --episodes 1 --out evaluated
try kaz mcu compare --ticks 100
try kaz mcu run --max-states 1000000 "$share/kaz/firmware/kaz.coff"
try kaz conformance --virtual h8 --filter identify
try kaz fuzz --target h8 --cases 2 --out failing
try kaz bench tick --out ticks
try kaz bench motor --mcu native --filter pot.noise --out measured
try kaz sim --eyes real --write-calibration eyes.yml
begin --erased
try kaz flash write "$share/kaz/firmware/kaz.mot" --robot serial:board --reset ctl:board.ctl
try kaz flash verify "$share/kaz/firmware/kaz.mot" --robot serial:board
try kaz status --robot serial:board
end
begin --mcu native --cameras board.eyes
try kaz run search-ball --robot serial:board --camera board.eyes --out live
end
