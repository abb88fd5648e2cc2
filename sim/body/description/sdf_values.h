// Numbers and other values of SDF elements, and their ranges.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <tinyxml2.h>

namespace kaz::sim {

inline constexpr double kMinSdfMass = 1e-9;  // kg, of bodies that can move

// Returns what is wrong with the text of an element and with the attributes of Kaz's own elements, or
// nullopt. `parent`: as in SdfElement::parent. The text of a pose may be empty.
std::optional<std::string> sdf_value_error(const tinyxml2::XMLElement& element,
                                           const std::string& parent);

// Returns the text of an element without the spaces around it.
std::string trimmed_text(const tinyxml2::XMLElement& element);

// Returns whether `text` and `value` are the same truth value, or the same numbers.
bool same_value(const std::string& text, std::string_view value);

// Returns the truth value of the child `name`, or nullopt without such a child.
std::optional<bool> truth_of(const tinyxml2::XMLElement& parent, const char* name);

// Returns the limit of a joint in the element <lower> or <upper>; at 1e16 and above it is infinite. Returns
// nullopt if the text is no number.
std::optional<double> joint_limit(const std::string& text);

// Returns the mask in <collide_bitmask>, decimal or hexadecimal; nullopt if it has more than 16 bits.
std::optional<unsigned> bitmask(const std::string& text);

}  // namespace kaz::sim
