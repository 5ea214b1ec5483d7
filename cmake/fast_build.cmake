# A build from nothing takes half as long with precompiled headers and with several sources to a
# compiler run. Floating-point results do not depend on what is inlined. A source with options of its
# own must have SKIP_PRECOMPILE_HEADERS: functions with a target attribute take their options from the
# precompiled header, so that -fno-trapping-math, for one, would be lost there. Turn UNDERBRUSH_UNITY off while working on one file again and again.
option(UNDERBRUSH_PCH "Compile what most sources include once, ahead of them" ON)
option(UNDERBRUSH_UNITY "Compile several sources of a target at once" ON)
set(UNDERBRUSH_UNITY_BATCH 17 CACHE STRING "Sources to a compiler run")

# ccache keeps nothing of a source with a precompiled header unless it is told that this is well.
if(UNDERBRUSH_PCH AND "$CACHE{CMAKE_CXX_COMPILER_LAUNCHER}" MATCHES "ccache$")
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    $CACHE{CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# GCC reads a precompiled header into the memory that it collects, and would mark all of it at each collection.
if(UNDERBRUSH_PCH AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(--param=ggc-min-heapsize=900000)
endif()

# A precompiled header for each kind of target, compiled once: the first target that asks for it owns it, and all
# others of the kind share it, for which they need the same flags. Without CLI11: each source that sees its headers
# compiles its validators, which takes longer than to read them.
set(underbrush_pch_library
    <algorithm> <array> <bit> <charconv> <cmath> <cstdint> <cstdio> <cstring> <filesystem> <fstream>
    <functional> <limits> <map> <memory> <numeric> <optional> <set> <span> <sstream> <string>
    <string_view> <unordered_map> <utility> <vector>
    <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <nlohmann/json.hpp>)
set(underbrush_pch_outer ${underbrush_pch_library})
set(underbrush_pch_test ${underbrush_pch_library} <gtest/gtest.h>)

# What is compiled for a fast build and not for a fast run: three quarters of the time of -O3. Outer code (options, tables, pages,
# messages, and modules in which a run spends little) is never the time of a run, and neither is what a test or a
# study does beside the library.
set(underbrush_optimization_outer -O1)
set(underbrush_optimization_test -O1)

# underbrush_fast_build(TARGET KIND): KIND is library, outer or test.
function(underbrush_fast_build target kind)
  if(DEFINED underbrush_optimization_${kind})
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${underbrush_optimization_${kind}}>)
  endif()
  # Libraries and programs with the same flags share the header.
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${target} PRIVATE -fPIC)
  if(UNDERBRUSH_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON
      UNITY_BUILD_BATCH_SIZE ${UNDERBRUSH_UNITY_BATCH})
    # A class whose private struct has a field of an unnamed namespace is as safe as in its own file.
    # GCC 12 takes a string literal in a moved std::string for one out of bounds, once all is inlined.
    foreach(warning IN ITEMS subobject-linkage array-bounds stringop-overflow stringop-overread restrict)
      target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-${warning}>)
    endforeach()
  endif()
  if(UNDERBRUSH_PCH)
    get_property(owner GLOBAL PROPERTY UNDERBRUSH_PCH_OWNER_${kind})
    if(owner)
      target_precompile_headers(${target} REUSE_FROM ${owner})
    else()
      target_precompile_headers(${target} PRIVATE ${underbrush_pch_${kind}})
      set_property(GLOBAL PROPERTY UNDERBRUSH_PCH_OWNER_${kind} ${target})
    endif()
  endif()
endfunction()
