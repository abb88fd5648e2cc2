// Plug-ins: behaviors in shared objects. Declares the loader and the exported symbol of a plug-in.
// SPDX-License-Identifier: Apache-2.0
//
// A plug-in is a shared object with one behavior, built outside of Kaz's tree (docs/howto/own-behavior.md).
// The source of a plug-in defines a `const Behavior` and ends with KAZ_BEHAVIOR_PLUGIN(behavior). A plug-in
// links no Kaz library, because the program `kaz` exports the functions that a plug-in needs. The file
// tools/cli/exports.txt lists the exported namespaces.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "host/behavior/behavior.h"
#include "kaz_interface.h"  // made by tools/repo/gen/source_id.py

#define KAZ_PLUGIN_TEXT_OF(number) #number
#define KAZ_PLUGIN_TEXT(number) KAZ_PLUGIN_TEXT_OF(number)
#ifdef _GLIBCXX_DEBUG
#define KAZ_PLUGIN_CONTAINERS ", debug containers"
#else
#define KAZ_PLUGIN_CONTAINERS ""
#endif

// Text that identifies the headers and the compiler options that affect the layout of types. For example, the
// compiler option -march changes the alignment of Eigen's types. A plug-in and the program that loads it must
// have equal texts. Then the types have the same layout in both.
#define KAZ_PLUGIN_INTERFACE                                                        \
  "headers " KAZ_INTERFACE_ID ", Eigen alignment " KAZ_PLUGIN_TEXT(                 \
      EIGEN_MAX_ALIGN_BYTES) ", C++11 ABI " KAZ_PLUGIN_TEXT(_GLIBCXX_USE_CXX11_ABI) \
      KAZ_PLUGIN_CONTAINERS

namespace kaz::behavior {

// Return type of the exported function.
struct Plugin {
  // KAZ_PLUGIN_INTERFACE of the plug-in's build. `interface` is the first member in every version of Plugin.
  const char* interface;
  // The program reads `behavior` only if `interface` is equal to the program's own KAZ_PLUGIN_INTERFACE.
  const Behavior* behavior;
};

// Name of the exported function. The number in the name changes when the members of `Plugin` change.
inline constexpr const char* kPluginSymbol = "kaz_behavior_plugin_v1";

// Defines the function that a plug-in exports. Use this macro once in a plug-in, outside of all namespaces.
#define KAZ_BEHAVIOR_PLUGIN(exported)                                               \
  extern "C" __attribute__((visibility("default"))) const ::kaz::behavior::Plugin*  \
  kaz_behavior_plugin_v1() {                                                        \
    static const ::kaz::behavior::Plugin plugin{KAZ_PLUGIN_INTERFACE, &(exported)}; \
    return &plugin;                                                                 \
  }                                                                                 \
  static_assert(true, "takes the semicolon")

// Returns true if `name` is the path of a plug-in, false if it is the name of a behavior. A path contains a
// slash or ends in .so.
bool names_plugin(std::string_view name);

// Loads the shared object, which stays loaded until the program ends. Loading executes code in the file. So
// never pass a path from untrusted data.
//
// Errors (usage). Each message is one sentence and contains `path`. Causes:
// - The file does not exist or is not a shared object for this machine.
// - The file needs symbols that the program lacks, exports no plug-in function, or was built against another
//   version of Kaz.
// - The behavior is not valid, or a behavior of Kaz has the same name.
// - The file's exported function throws an exception. An exception in a static initializer ends the program.
Result<Behavior> load_behavior(const std::string& path);

// Returns the result of load_behavior(name) if `name` is a path, else the result of find_behavior(name).
Result<Behavior> named_behavior(const std::string& name);

// Replaces file names in the settings of the behavior `name` by the values in these files (Option::load).
// Does nothing if the behavior is unknown. Fails (usage) if a file cannot be read or has no valid value.
Result<void> load_settings(const std::string& name, std::map<std::string, std::string>& settings);

// Call thrown_error() in a handler that catches all exceptions. Returns the error for the current exception,
// with `who` as its source. The fault is Fault::failed, or Fault::environment if memory ran out.
Error thrown_error(const std::string& who);

}  // namespace kaz::behavior
