#!/bin/sh
# first.sh NICE COMMAND ...: runs a test in real time. Other programs hardly keep it waiting, if the system permits that.
# SPDX-License-Identifier: Apache-2.0
# It is permitted to root, or with a limit `nice` (limits.conf(5)). Where each session has its share of the processors
# (autogroup), a low nice value only counts within one: so the test gets its own, with a low nice value, too. SCHED_RR
# would be worse: a program of it that computes for 0.1 s keeps the kernel's threads of a pty waiting.
level=$1
shift
[ -z "$(nice -n "$level" true 2>&1)" ] || exec "$@"
exec setsid sh -c 'echo "$0" 2>/dev/null >/proc/self/autogroup; exec nice -n "$0" "$@"' "$level" "$@"
