// For tests: client of the control socket of `kaz sim`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::test {

// Sends one request to the socket at `path` and returns the reply, a line of JSON. Throws std::runtime_error
// without a reply within 10 s.
std::string query_control(const std::string& path, const std::string& request);

}  // namespace kaz::test
