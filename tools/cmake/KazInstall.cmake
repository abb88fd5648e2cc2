# `cmake --install` puts libraries, headers, data and the program where find_package(kaz) looks for them.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
