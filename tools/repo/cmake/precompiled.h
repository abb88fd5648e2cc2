// Precompiled header of most sources. Sources do not rely on this header: each source includes the headers
// that it uses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Includes only headers that most sources use. For each source, g++ again instantiates the templates that the
// inline functions of these headers use. The instantiation takes 0.5 s. nlohmann/json.hpp would add 0.6 s,
// and CLI/CLI.hpp would add 2.6 s.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <tl/expected.hpp>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>
