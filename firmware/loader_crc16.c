// The loader's own copy of the CRC: it must not depend on the application that it checks.
// SPDX-License-Identifier: Apache-2.0
#define kz_crc16 kz_loader_crc16
#define kz_crc16_table kz_loader_crc16_table
#include "shared/protocol/crc16.c"
