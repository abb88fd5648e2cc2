# The tests of CanLink that need a kernel with CAN, in the virtual machine.
# SPDX-License-Identifier: Apache-2.0
import re

from robot_guest import ISOTP, Guest, Link, can_bus, can_up, up

# On virtual CAN all, by the program's own error frames and by an adapter that says bus-off; on emulated
# controllers those that need no injected error frames.
RUNS = [("vcan0", "KernelCan*", 7),
        ("can0", "KernelCan.FramesOfAll*:KernelCan.Broadcast*:KernelCan.DownAndUp*", 3)]
MACHINE = Link("kernel", "", "", can_bus(2), [("vcan", ""), ("kvaser_pci", ""), ("slcan", ""), *ISOTP],
               ["ip link add vcan0 type vcan", up("vcan0"), *can_up("can0", "can1")])


def kernel_can(options):
    lines, wrong = [], []
    with Guest(options, options.out / "kernel-can", [], MACHINE) as guest:
        guest.check_program(options)
        for interface, cases, number in RUNS:
            command = (f"KAZ_TEST_CAN={interface} {options.bin}/kernel_can_test --gtest_color=no "
                       f"--gtest_filter='{cases}'")
            code, printed = guest.run(command, check=False)
            passed = re.findall(r"^\[       OK \] (\S+)", printed, re.M)
            lines.append(f"CAN on {interface}, by the kernel: {len(passed)} of {number} passed: "
                         f"{', '.join(passed)}")
            if code != 0 or len(passed) != number:
                wrong.append(f"on {interface}:\n{printed}")
    return lines, wrong
