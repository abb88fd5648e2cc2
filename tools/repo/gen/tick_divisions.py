# Which functions of a firmware image divide in the path of the tick.
# SPDX-License-Identifier: Apache-2.0
"""There is no library to divide with, and none may come in by the back door: a routine that divides
32 bits takes some hundred states, and in a loop over the joints that is a tick. The instructions that
divide 16 bits, up to 21 states each, are counted against a list."""

# By function: how many, and why that is acceptable. Measured under the walking load with the profile
# of `kaz mcu run`: all ramps of a tick start in 2,400 states.
ALLOWED = {
    "_kz_joints_start_ramps": 2,  # a joint's ramp: its length; its whole step and the rest
    "_kz_reply": 1,  # once in the answer to `identify`
}
LIBRARY = ("div", "mod", "mul")


class Forbidden(Exception):
    """One sentence: which function, and what it does."""


def is_library(name):
    """__udivsi3 and its kin, as the compiler calls them."""
    return name.startswith("___") and any(word in name for word in LIBRARY)


def reachable(functions, name):
    """Functions that run when `name` is called."""
    by_name = {function.name: address for address, function in functions.items()}
    if name not in by_name:
        raise Forbidden(f"there is no function {name}")
    seen, waiting = set(), [by_name[name]]
    while waiting:
        address = waiting.pop()
        if address in seen or address not in functions:
            continue
        seen.add(address)
        waiting.extend(functions[address].calls)
    return [functions[address] for address in sorted(seen)]


def tick_divisions(functions, name="_kz_tick", allowed=None):
    """{function: instructions that divide}, if all of them are allowed."""
    allowed = ALLOWED if allowed is None else allowed
    found = {}
    for function in reachable(functions, name):
        if is_library(function.name):
            raise Forbidden(f"{function.name} of a library is called in the path of {name}; "
                            "divide and multiply 16 bits there")
        if function.divisions > allowed.get(function.name, 0):
            raise Forbidden(f"{function.name}, in the path of {name}, has {function.divisions} "
                            f"divisions, of which {allowed.get(function.name, 0)} are allowed: do "
                            "without, or measure it and enter it in tick_divisions.py")
        if function.divisions:
            found[function.name] = function.divisions
    return found
