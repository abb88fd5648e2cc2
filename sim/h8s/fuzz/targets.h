// Fuzz targets: each accepts any bytes and returns a description of the failure, or an empty string.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shared/image/image.h"

namespace kaz::h8s::fuzz {

using Bytes = std::span<const std::uint8_t>;

// The bytes as an image file of each format; what loads is put on a chip and run a little.
std::string image(Bytes input);

// The bytes as packets from GDB, line by line, to a chip that runs.
std::string gdb(Bytes input);

// The bytes as the text of a netlist around a chip that runs.
std::string netlist(Bytes input);

// The bytes as flash, RAM and events at the pins, run by every engine side by side.
std::string chip(Bytes input);

// The same with a working program whose bits the input flips. `base` is that program.
std::string flipped(const Image& base, Bytes input);

}  // namespace kaz::h8s::fuzz
