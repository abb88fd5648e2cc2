// Size of the serial ring buffers, for C and assembler.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_FIRMWARE_SERIAL_RINGS_H
#define KAZ_FIRMWARE_SERIAL_RINGS_H

#define KZ_RING 64  // size of each buffer, bytes; a power of two; one byte always stays unused

#endif
