# Upper bound of the stack from the object code: the deepest path through the call tree.
# SPDX-License-Identifier: Apache-2.0
"""What no bound can be given for (recursion, calls through pointers, a computed stack pointer) is an
error. Interrupts do not nest: each runs with the I bit set, so the deepest one counts once.
"""
import re
import subprocess
from dataclasses import dataclass, field

LABEL = re.compile(r"^[0-9a-f]+ <(\S+)>:$")
INSTRUCTION = re.compile(r"^\s*([0-9a-f]+):\t(?:[0-9a-f]{2} )+\s*\t(\S+)\s*(.*?)\s*$")
TARGET = re.compile(r"\(0x([0-9a-f]+)\)|@0x([0-9a-f]+)|\.[-+]?\d+ \(0x([0-9a-f]+)\)")
RETURN_ADDRESS = 4
EXCEPTION_FRAME = 4


class Unbounded(Exception):
    """One sentence: which function, and why."""


@dataclass
class Function:
    name: str
    frame: int = 0  # deepest the function itself goes
    calls: set = field(default_factory=set)  # addresses
    divisions: int = 0  # instructions, of up to 21 states each
    is_handler: bool = False


CODE_SECTIONS = (".text", ".ltext", ".ramtext", ".rest")


def disassemble(objdump, path):
    command = [objdump, "-d"] + [word for name in CODE_SECTIONS for word in ("-j", name)] + [path]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def is_function(label):
    """Not one of the compiler's or the assembler's local labels."""
    return label.startswith("_")


def pushed(mnemonic, operands):
    """By how many bytes an instruction moves the stack down (negative: up); None: unknown."""
    if mnemonic.startswith("stm") or mnemonic.startswith("ldm"):
        first, last = re.search(r"er(\d)-er(\d)", operands).groups()
        size = 4 * (int(last) - int(first) + 1)
        return size if mnemonic.startswith("stm") else -size
    if operands.endswith("@-er7") or mnemonic.startswith("push"):
        return 4 if mnemonic.endswith("l") else 2
    if operands.startswith("@er7+") or mnemonic.startswith("pop"):
        return -4 if mnemonic.endswith("l") else -2
    if not re.search(r",(er7|sp)$", operands) or mnemonic.startswith(("cmp", "btst")):
        return 0
    constant = re.match(r"#(-?(?:0x)?[0-9a-f]+)", operands)
    if constant and mnemonic.startswith(("add", "sub")):
        value = int(constant.group(1), 0)
        if value >= 1 << 31:
            value -= 1 << 32
        return -value if mnemonic.startswith("add") else value
    return None


def parse(lines):
    """Functions by address."""
    functions, current, depth = {}, None, 0
    for line in lines:
        label = LABEL.match(line)
        if label:
            if is_function(label.group(1)):
                current = Function(label.group(1))
                depth = 0
                functions[int(line.split()[0], 16)] = current
            continue
        match = INSTRUCTION.match(line)
        if not match or current is None:
            continue
        _, mnemonic, operands = match.groups()
        if mnemonic == "mov.l" and operands.startswith("#") and operands.endswith("er7"):
            depth = 0  # start-up sets the stack pointer
            continue
        change = pushed(mnemonic, operands)
        if change is None:
            raise Unbounded(f"{current.name}: '{mnemonic} {operands}' computes the stack pointer")
        # gcc pushes once at the start of a function and pops once at its end.
        depth += change
        current.frame = max(current.frame, depth)
        if mnemonic.startswith("div"):
            current.divisions += 1
        if mnemonic == "rte":
            current.is_handler = True
        if mnemonic in ("jsr", "bsr"):
            target = TARGET.search(operands)
            if not target:
                raise Unbounded(f"{current.name}: '{mnemonic} {operands}' calls through a pointer")
            current.calls.add(int(next(g for g in target.groups() if g), 16))
    return functions


def deepest(functions, address, path=()):
    """(bytes, names from caller to callee) below and including the function at `address`."""
    if address not in functions:
        raise Unbounded(f"a call goes to {address:#x}, where no function starts")
    if address in path:
        raise Unbounded(f"{functions[address].name} calls itself")
    function = functions[address]
    below, names = 0, []
    for callee in sorted(function.calls):
        size, callees = deepest(functions, callee, path + (address,))
        if size + RETURN_ADDRESS > below:
            below, names = size + RETURN_ADDRESS, callees
    return function.frame + below, [function.name] + names


def calls_out_of(functions, first, end):
    """(caller, address) of each call from a function in first..end-1 to somewhere else."""
    return [(function.name, callee) for address, function in sorted(functions.items())
            if first <= address < end
            for callee in sorted(function.calls) if not first <= callee < end]


def stack_bound(objdump, path, start):
    """(bytes, names) of the deepest path from the function `start`, with one interrupt on top."""
    functions = parse(disassemble(objdump, path))
    by_name = {function.name: address for address, function in functions.items()}
    if start not in by_name:
        raise Unbounded(f"{path}: no function {start}")
    size, names = deepest(functions, by_name[start])
    handlers = [deepest(functions, address) for address, function in functions.items()
                if function.is_handler]
    if handlers:
        interrupt, interrupt_names = max(handlers)
        size += EXCEPTION_FRAME + interrupt
        names = names + interrupt_names
    return size, names
