// The control socket of a `kaz sim` under test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kaz::test {

// Sends one request to the socket at `path` and returns the reply, a line of JSON. Throws where nobody
// answers.
std::string query_control(const std::string& path, const std::string& request);

}  // namespace kaz::test
