#!/bin/sh
# Builds GDB for the H8S once, in build/gdb, and runs a session with the emulator's server. Run it in the tree's root.
# SPDX-License-Identifier: Apache-2.0
# usage: check.sh BIN   BIN: folder of the built programs
set -eu
tools/repo/gdb/build_gdb.sh build/gdb
python3 tests/integration/gdb_client/session.py --gdb build/gdb/gdb/gdb --kaz "$1/kaz" \
  --image build/release/sim/h8s/testdata/matrix0.coff --out out/gdb-client
