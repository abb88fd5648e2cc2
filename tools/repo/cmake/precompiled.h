// Precompiled header of most sources. No source relies on it: each includes what it uses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Contains only headers that most sources use. For each source, g++ again instantiates the templates that
// their inline functions use. That takes 0.5 s; nlohmann/json.hpp would add 0.6 s, CLI/CLI.hpp 2.6 s.
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
