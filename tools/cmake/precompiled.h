// What most sources include, compiled once. No source relies on it: each includes what it uses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Only what most sources use: g++ instantiates the templates that inline functions of these headers use anew
// for each source. That takes 0.5 s; with nlohmann/json.hpp 0.6 s more, with CLI/CLI.hpp 2.6 s.
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
