// Behaviours from shared objects: what a plug-in exports, and how it is loaded.
// SPDX-License-Identifier: Apache-2.0
//
// A plug-in is a shared object with one behaviour, built outside of Kaz's tree
// (docs/howto/own-behavior.md). Its source defines a `const Behavior` and ends with
// KAZ_BEHAVIOR_PLUGIN(behavior). It links nothing of Kaz: the program `kaz` exports what host/, vision/
// and shared/ declare (tools/kaz/exports.txt).
#pragma once

#include <string>
#include <string_view>

#include <Eigen/Core>

#include "host/behavior/behavior.h"
#include "kaz_interface.h"  // made by tools/gen/interface_id.py

#define KAZ_PLUGIN_TEXT_OF(number) #number
#define KAZ_PLUGIN_TEXT(number) KAZ_PLUGIN_TEXT_OF(number)
#ifdef _GLIBCXX_DEBUG
#define KAZ_PLUGIN_CONTAINERS ", debug containers"
#else
#define KAZ_PLUGIN_CONTAINERS ""
#endif

// What a plug-in and the program that loads it must have in common for their types to be the same: the
// headers, and the options on which the layout of a type depends (-march changes Eigen's alignment).
#define KAZ_PLUGIN_INTERFACE                                                        \
  "headers " KAZ_INTERFACE_ID ", Eigen alignment " KAZ_PLUGIN_TEXT(                 \
      EIGEN_MAX_ALIGN_BYTES) ", C++11 ABI " KAZ_PLUGIN_TEXT(_GLIBCXX_USE_CXX11_ABI) \
      KAZ_PLUGIN_CONTAINERS

namespace kaz::behavior {

// What the exported function returns.
struct Plugin {
  const char* interface;     // KAZ_PLUGIN_INTERFACE of its build; the first member in every version
  const Behavior* behavior;  // read only if `interface` is the program's
};

// The function's name; a number for each form of `Plugin`.
inline constexpr const char* kPluginSymbol = "kaz_behavior_plugin_v1";

// Defines the function that a plug-in exports. Once in a plug-in, outside of all namespaces.
#define KAZ_BEHAVIOR_PLUGIN(exported)                                               \
  extern "C" __attribute__((visibility("default"))) const ::kaz::behavior::Plugin*  \
  kaz_behavior_plugin_v1() {                                                        \
    static const ::kaz::behavior::Plugin plugin{KAZ_PLUGIN_INTERFACE, &(exported)}; \
    return &plugin;                                                                 \
  }                                                                                 \
  static_assert(true, "takes the semicolon")

// Whether `name` is the path of a plug-in (contains a slash or ends in .so), no name of Kaz's.
bool names_plugin(std::string_view name);

// Loads the shared object, which stays loaded until the program ends. This runs code of the file: never
// call it with a path that comes from data. Errors (usage), each one sentence with `path`: no such
// file, no shared object for this machine, symbols that the program lacks, no exported function, built
// against another Kaz, no valid behaviour, the name of one of Kaz's. Whatever the file's static initialisers
// and its exported function throw is passed on.
Result<Behavior> load_behavior(const std::string& path);

// A plug-in's behaviour if `name` is a path, else find_behavior(name).
Result<Behavior> named_behavior(const std::string& name);

}  // namespace kaz::behavior
