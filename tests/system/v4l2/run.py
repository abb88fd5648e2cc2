# Runs a test program against the kernel's virtual video driver, in a virtual machine.
# SPDX-License-Identifier: Apache-2.0
"""Exit status: 0 passed, 1 failed, 77 something is missing (it says what)."""

import argparse
import pathlib
import re
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "guest"))
import machine  # noqa: E402

# Two cameras, one that gives its pictures in several planes, one node that only takes pictures.
VIVID = ("n_devs=4 node_types=0x1,0x1,0x1,0x100 num_inputs=1,1,1,1 input_types=0,0,0,0 "
         "num_outputs=1,1,1,1 output_types=1,1,1,1 multiplanar=1,1,2,1 vid_cap_nr=0,1,2,-1 "
         "vid_out_nr=-1,-1,-1,3")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("--bin", "--kernels", "--out"):
        parser.add_argument(name, type=pathlib.Path, required=True)
    parser.add_argument("--fetch", action="store_true", help="get a kernel if there is none")
    options = parser.parse_args()
    if options.fetch:
        machine.fetch(options.kernels)
    try:
        kernel = machine.kernel(options.kernels)
    except machine.Missing as missing:
        print(f"SKIPPED: the V4L2 camera was not tested on the kernel's driver: {missing}; "
              "`./tools/dev study camera-test` gets it")
        return 77
    binaries = options.bin.resolve()
    print(f"kernel: {kernel.name}", flush=True)
    start = time.monotonic()
    with machine.Machine(binaries / "guest_init", kernel, options.out, [("vivid", VIVID)],
                         machine.COUNTED) as guest:
        code, printed = guest.run(f"{binaries}/camera_guest --gtest_color=no", check=False)
    passed = re.findall(r"^\[       OK \] (\S+) \((\d+) ms\)", printed, re.M)
    for name, milliseconds in passed:
        print(f"passed {name} ({int(milliseconds) / 1000:.1f} s)")
    for name in re.findall(r"^\[  FAILED  \] (\S+) \(\d+ ms\)", printed, re.M):
        print(f"FAILED {name}")
    good = code == 0 and passed
    if not good:
        print(printed[-20000:])
    print(f"{len(passed)} cases passed in {time.monotonic() - start:.0f} s, "
          f"{'all is well' if good else 'not all is well'}; console: {options.out}/console.txt")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
