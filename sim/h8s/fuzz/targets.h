// Fuzz targets. Each target accepts any bytes and returns a description of the failure, or an empty string.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shared/image/image.h"

namespace kaz::h8s::fuzz {

using Bytes = std::span<const std::uint8_t>;

// Parses the input as an image file of each format. If an image can be loaded, runs the image for a short
// time.
std::string image(Bytes input);

// Sends each line of the input as a packet from GDB to a server with a running chip.
std::string gdb(Bytes input);

// Parses the input as the text of a netlist that is connected to a running chip.
std::string netlist(Bytes input);

// Uses the input as flash, RAM and events at the pins, and compares all engines.
std::string chip(Bytes input);

// Flips bits of the working program `base` as the input specifies, and compares all engines.
std::string flipped(const Image& base, Bytes input);

}  // namespace kaz::h8s::fuzz
