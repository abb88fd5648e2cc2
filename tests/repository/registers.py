# The registers and bits of firmware/h8s2128.h are those of the emulator's table, sim/h8s/chip/registers.def.
# SPDX-License-Identifier: Apache-2.0
"""usage: registers.py ROOT"""

import pathlib
import re
import sys

# The firmware names the unit first (SCI0_SMR, TMR_TCR0), the table names the channel last (SMR0, TCR0).
UNITS = [(re.compile(pattern), name) for pattern, name in (
    (r"^SCI(\d)_(\w+)$", r"\2\1"), (r"^WDT(\d)_(\w+)$", r"W\2\1"), (r"^(?:TMR|FRT)_(\w+)$", r"\1"))]
# Both registers of a watchdog are written by a keyed word at the address of TCSR.
KEYED = {"WDT0_TCNT": "WDT0_TCSR"}
# Names that do not consist of group and bit -> the bit, or the field with this setting.
SETTINGS = {
    "TMR_CLEAR_AT_A": "TMR_TCR.CCLR", "TMR_PHI_2": "TMR_TCR.CKS", "TMR_HIGH_AT_A": "TMR_TCSR.OS10",
    "TMR_LOW_AT_B": "TMR_TCSR.OS32", "FRT_TCR_PHI_8": "FRT_TCR.CKS", "WDT_WATCHDOG": "WTCSR.WTIT",
    "WDT_RUN": "WTCSR.TME", "WDT_RESET": "WTCSR.RSTNMI", "WDT_PHI_2": "WTCSR.CKS",
    "WDT_PHI_512": "WTCSR.CKS", "ADCSR_AN0_TO_3": "ADCSR.CH",
}
# Reset values and keys, which the table does not have.
OTHERS = ("MSTPCRH_RESET", "MSTPCRL_RESET", "WDT_TCSR_KEY", "WDT_TCNT_KEY")


def table(text):
    """Returns {name: (address, size)} of the registers and {"GROUP.BIT": mask} of the bits."""
    rows = re.findall(r"^KZ_(?:REGISTER|BANKED|WRITE_ONLY)\((\w+), (0x\w+), (\d)", text, re.M)
    registers = {name: (int(address, 16), int(size)) for name, address, size in rows}
    bits = {f"{group}.{name}": int(mask, 16)
            for group, row in re.findall(r"^KZ_BITS\((\w+),([^)]+)\)", text, re.M)
            for name, mask in re.findall(r"(\w+) = (0x\w+)", row)}
    return registers, bits


def register_fault(name, width, address, registers):
    keyed = name.startswith("WDT")
    known = KEYED.get(name, name)
    for pattern, replacement in UNITS:
        known = pattern.sub(replacement, known)
    wanted = registers.get(known)
    if wanted is None:
        return f"registers.def has no {known}"
    if (address, width // 8) != (wanted[0], 2 if keyed else wanted[1]):
        return f"registers.def has {known} at {wanted[0]:#x} with {wanted[1]} bytes"
    return None


def bit_fault(name, mask, bits):
    if name in SETTINGS:
        wanted = bits[SETTINGS[name]]
        single = wanted & (wanted - 1) == 0
        wrong = mask != wanted if single else mask & ~wanted
        return f"registers.def has {SETTINGS[name]} = {wanted:#x}" if wrong else None
    group, _, bit = name.rpartition("_")
    wanted = bits.get(f"{group}.{bit}", bits.get(f"{group.removeprefix('FRT_')}.{bit}"))
    return None if mask == wanted else f"registers.def has {wanted and hex(wanted)} for it"


def faults(header, registers, bits):
    """Yields (name, whether it is a register, what is wrong or None) for each number in the header."""
    for name, width, number in re.findall(
            r"^#define (\w+) (?:KZ_REG(\d+)\()?(0x[0-9A-F]+)\b", header, re.M):
        if name not in OTHERS:
            value = int(number, 16)
            yield name, bool(width), (register_fault(name, int(width), value, registers) if width
                                      else bit_fault(name, value, bits))


def main(root):
    registers, bits = table((root / "sim/h8s/chip/registers.def").read_text())
    header = (root / "firmware/h8s2128.h").read_text()
    checked = list(faults(header, registers, bits))
    wrong = [f"firmware/h8s2128.h: {name}: {text}" for name, _, text in checked if text]
    # Each number is really checked: with one bit changed, it is a fault.
    for name, _, _ in checked:
        changed = re.sub(rf"(?m)^(#define {name} .*?)(0x[0-9A-F]+)",
                         lambda m: f"{m[1]}0x{int(m[2], 16) ^ 0x80:X}", header)
        if not any(other == name and text for other, _, text in faults(changed, registers, bits)):
            wrong.append(f"tests/repository/registers.py: finds no change of {name}")
    count = sum(is_register for _, is_register, _ in checked)
    print("\n".join(wrong) if wrong else f"{count} registers and {len(checked) - count} masks agree")
    sys.exit(1 if wrong or not checked else 0)


main(pathlib.Path(sys.argv[1]))
