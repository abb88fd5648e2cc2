#!/bin/sh
# The package by pip, without network, into an environment of its own: usage: pip_install.sh PYTHON BUILD FOLDER
# SPDX-License-Identifier: Apache-2.0
set -eu
python=$1 build=$2 folder=$3
here=$(dirname "$0")
rm -rf "$folder"
mkdir -p "$folder"
# A copy: pip writes into the folder that it installs from.
cp -r "$here/.." "$folder/python"
cp "$here/../../CMakeLists.txt" "$folder"
"$python" -m venv --system-site-packages "$folder/environment"
KAZ_BUILD=$build "$folder/environment/bin/pip" install --no-build-isolation --no-index --quiet "$folder/python"
cd "$folder"
"$folder/environment/bin/python" -c '
import kaz
assert kaz.__file__.startswith("'"$folder"'/environment/"), kaz.__file__
simulation = kaz.Simulation(world="ball", mcu="h8")
with kaz.Robot(simulation) as robot:
    robot.enable(["neck_pan"])
    robot.sleep(0.1)
print("installed", kaz.__version__)'
