// Semihosting requests for programs on the flat machine, and a printf without floats.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_H8S_FLAT_HOST_H
#define KAZ_H8S_FLAT_HOST_H

// Descriptors 0 and 1 are standard output, descriptor 2 is standard error. Returns the number of bytes
// written.
long write(long descriptor, const void* from, unsigned long length);
// Ends the program with the exit status `status`.
void exit(int status) __attribute__((noreturn));

// Prints to standard output. Formats: %s %c %d %u %x %ld %lu %lx %%, with a width and leading zeros.
void print(const char* format, ...);

#endif
