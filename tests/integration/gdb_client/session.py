#!/usr/bin/env python3
# A real GDB against the emulator's server: one session from load to reverse execution.
# SPDX-License-Identifier: Apache-2.0
"""Drives h8300-elf-gdb against `kaz mcu run --gdb PORT IMAGE` and checks each answer.

The program is testdata/matrix.c at -O0: `multiply` runs as often as `rounds` says, and `result` is the trace
of the product. Every expected value follows from that, from the image or from an earlier answer.
"""

import argparse
import pathlib
import re
import socket
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools/repo/gdb"))
import coff_to_elf  # noqa: E402

HANG_S = 1200  # of a busy machine
TRACE = sum((i * 100 - k * 37) * (i * 55 - k * 91) for i in range(16) for k in range(16))

# Commands and what their output must match; (?P<name>) is remembered, {name} stands for it later.
SESSION = [
    (["info registers"], r"er0 .*\n(.*\n)*sp .*\n(.*\n)*pc +0x00000400 "),
    (["x/1xw 0"], r"0x0.*0x00000400"),
    (["set {short}&rounds = 3", "p *(short*)&rounds"], r"= 3"),
    (["break multiply", "continue"], r"Breakpoint 1.*\n?.*in multiply"),
    (["p/x $pc", "p/x $sp"], r"= (?P<pc>0x40e)\n\$\d+ = (?P<sp>0x\w+)"),
    # One frame: the program keeps no frame pointer, and GDB has nothing else to go by.
    (["backtrace"], r"#0 +0x0000040e in multiply \(\)"),
    (["stepi", "p/x $pc"], r"= 0x414$"),
    (["p/x $sp"], r"= (?P<lower>0x\w+)$"),
    (["stepi", "stepi", "p/x $pc"], r"= 0x41a$"),
    (["set $er3 = 0x12345678", "p/x $er3"], r"= 0x12345678$"),
    (["set {char[4]}0xffe900 = {1, 2, 3, 4}", "x/1xw 0xffe900"], r"0x01020304"),
    (["reverse-stepi", "p/x $pc"], r"= 0x416$"),
    (["reverse-stepi", "reverse-stepi", "p/x $pc"], r"= 0x40e$"),
    (["p/x $sp"], r"= {sp}$"),
    (["continue"], r"Breakpoint 1.*in multiply"),
    (["p *(long*)&c"], r"= (?P<first>-?\d+)$"),
    (["watch *(short*)&result", "delete 1", "continue"], r"[Ww]atchpoint 2.*(\n.*)*New value"),
    (["stepi", "stepi", "p *(long*)&result"], rf"= {TRACE}$"),
    (["delete 2", "break multiply", "reverse-continue"], r"Breakpoint 3.*in multiply"),
    # What RAM held at power-on (0xa5 in each byte): the program does not clear it.
    (["p *(long*)&result"], r"= -1515870811$"),
    (["delete 3", "break *&done", "continue"], r"Breakpoint 4.*in (done|.*) \(\)"),
    (["p *(long*)&result"], rf"= {TRACE}$"),
    (["disassemble start,+6"], r"mov\.l\s+#0xfff000,er7"),
]


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def check(output):
    """Every answer against what it must be; the number of those that are wrong."""
    answers = re.split(r"(?m)^@@\d+@@\n", output)[1:]
    known, wrong = {}, 0
    for k, (commands, pattern) in enumerate(SESSION):
        answer = answers[k].strip() if k < len(answers) else "(no answer)"
        for name, value in known.items():
            pattern = pattern.replace("{" + name + "}", re.escape(value))
        match = re.search(pattern, answer)
        if match:
            known.update(match.groupdict())
            continue
        wrong += 1
        print(f"{'; '.join(commands)}: answers\n{answer}\nwhich does not match {pattern}")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gdb", required=True, help="h8300-elf-gdb")
    parser.add_argument("--kaz", required=True, help="the program kaz")
    parser.add_argument("--image", required=True, help="matrix0.coff of the emulator's test data")
    parser.add_argument("--out", required=True, help="folder for the ELF file, the script and the transcript")
    args = parser.parse_args()
    out = pathlib.Path(args.out)
    out.mkdir(parents=True, exist_ok=True)
    coff_to_elf.convert(args.image, out / "program.elf")
    port = free_port()
    lines = ["set pagination off", "set confirm off", "set width 0", f"file {out / 'program.elf'}",
             "set architecture h8300s", "set tcp connect-timeout 20", f"target remote localhost:{port}"]
    for k, (commands, _) in enumerate(SESSION):
        lines += [f"echo @@{k}@@\\n", *commands]
    (out / "script.gdb").write_text("\n".join(lines + ["kill", ""]))
    with subprocess.Popen([args.kaz, "mcu", "run", "--gdb", str(port), args.image], stdout=subprocess.DEVNULL,
                          stderr=subprocess.PIPE, text=True) as server:
        try:
            done = subprocess.run([args.gdb, "-nx", "-q", "-batch", "-x", out / "script.gdb"],
                                  capture_output=True, text=True, timeout=HANG_S, check=False)
            server.wait(timeout=HANG_S)
        except subprocess.TimeoutExpired as late:
            print(f"time limit: {late}")
            server.kill()
            return 1
        finally:
            if server.poll() is None:
                server.kill()
        errors = server.stderr.read()
    (out / "transcript.txt").write_text(done.stdout + done.stderr)
    wrong = check(done.stdout)
    if wrong:
        print(f"gdb: {done.stderr.strip()[-1000:]}\nkaz: {errors.strip()[-1000:]}")
    print(f"{len(SESSION) - wrong} of {len(SESSION)} answers are right; transcript in {out}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
