# Every reason for which the board switches motors off has its line in docs/explanation/safety.md.
# SPDX-License-Identifier: Apache-2.0
"""usage: reasons.py ROOT"""
import pathlib
import re
import sys


def main(root):
    header = (pathlib.Path(root) / "shared/protocol/messages.h").read_text(encoding="utf-8")
    page = (pathlib.Path(root) / "docs/explanation/safety.md").read_text(encoding="utf-8")
    reasons = re.findall(r"^#define KZ_SHUTDOWN_(\w+) ", header, re.MULTILINE)
    rows = re.findall(r"^\| ([A-Z_]+) \|", page, re.MULTILINE)
    wanted = [reason for reason in reasons if reason != "NONE"]
    if not wanted or wanted != rows:
        sys.exit(f"docs/explanation/safety.md has rows for {rows}, messages.h has the reasons {wanted}")


main(sys.argv[1])
