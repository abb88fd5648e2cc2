# At the beginning of `cmake --install`: what would be copied is there, or nothing is copied.
# SPDX-License-Identifier: Apache-2.0
set(kaz_missing "")
foreach(file IN LISTS kaz_built)
  if(NOT EXISTS ${file})
    list(APPEND kaz_missing ${file})
  endif()
endforeach()
if(kaz_missing)
  list(LENGTH kaz_missing missing)
  list(LENGTH kaz_built all)
  list(GET kaz_missing 0 first)
  message(FATAL_ERROR "Nothing was installed: ${missing} of ${all} files are not built, ${first} for one. Build them, without tests, by\n"
                      "  cmake --build ${kaz_build} --target kaz_product")
endif()
if(kaz_has_page AND NOT EXISTS ${kaz_build}/view/index.html)
  message("The page of --view is not built and is left out; to have it, first\n"
          "  cmake --build ${kaz_build} --target kaz_page")
endif()
