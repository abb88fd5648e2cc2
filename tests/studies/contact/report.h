// Tables, files and pictures of the contact study.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/studies/contact/study.h"

namespace kaz::contact {

// Returns the tables as Markdown: scores beside the published ones, origin of the errors, fitted values.
// `seed`: seed of the bootstrap.
std::string markdown(std::span<const Row> rows, std::uint64_t seed);

// Returns scores, fitted values and the error of each toss as JSON.
std::string json(std::span<const Row> rows, std::span<const Toss> tosses, std::uint64_t seed);

// Reads the fits of an engine from text of json(). Returns Fault::usage if the text is not such JSON, has no
// row of the engine, or a value is outside the parameter's bounds. `name`: file name for the error message.
Result<std::array<Fit, 2>> read_fits(const std::string& text, const std::string& name,
                                     const Engine& engine);

// Returns one line per toss: number and error in each row, with a heading.
std::string csv(std::span<const Row> rows, std::span<const Toss> tosses);

// Writes toss-10.svg, toss-50.svg and toss-90.svg: measured and simulated outlines of the cube from the side,
// in the first and in the last row. The tosses have the errors at these percentiles of the first row.
Result<void> write_pictures(const std::string& folder, std::span<const Row> rows,
                            std::span<const Toss> tosses);

}  // namespace kaz::contact
