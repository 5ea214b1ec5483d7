# The layers of the library, in the order of the data flow. A module may use only modules that
# stand before it in this list; underbrush_module() stops the configuration otherwise.
set(UNDERBRUSH_LAYERS
    core compact io ground movers elements trace sensor radiometry cluster surface credit keyframes likelihood simulate
    calibrate fit update primitives plant_meshes library test_site sites worlds metrics optimize perception osi actors
    regions pipeline rasters jobs serve live)

# underbrush_module(NAME SOURCES a.cpp ... HEADERS a.hpp ... DEPENDS module ... LINK target ... [OUTER])
#
# DEPENDS names other modules; LINK names third-party targets, linked privately: a heavy third party
# stays inside the sources of one module. PUBLIC_LINK is for what the headers show (Eigen). OUTER says that a run
# spends little in it, so that it is compiled for a fast build.
function(underbrush_module name)
  cmake_parse_arguments(M "OUTER" "" "SOURCES;HEADERS;DEPENDS;LINK;PUBLIC_LINK" ${ARGN})
  list(FIND UNDERBRUSH_LAYERS ${name} mine)
  if(mine LESS 0)
    message(FATAL_ERROR "module '${name}' is not in UNDERBRUSH_LAYERS")
  endif()
  foreach(other IN LISTS M_DEPENDS)
    list(FIND UNDERBRUSH_LAYERS ${other} theirs)
    if(theirs LESS 0 OR NOT theirs LESS mine)
      message(FATAL_ERROR "module '${name}' may not depend on '${other}': it does not stand before it")
    endif()
  endforeach()
  add_library(underbrush_${name} STATIC ${M_SOURCES})
  add_library(underbrush::${name} ALIAS underbrush_${name})
  target_compile_features(underbrush_${name} PUBLIC cxx_std_20)
  target_include_directories(underbrush_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
  target_sources(underbrush_${name} PUBLIC FILE_SET HEADERS
    BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${M_HEADERS})
  list(TRANSFORM M_DEPENDS PREPEND underbrush::)
  target_link_libraries(underbrush_${name} PUBLIC ${M_DEPENDS} ${M_PUBLIC_LINK} PRIVATE ${M_LINK})
  set_target_properties(underbrush_${name} PROPERTIES
    EXPORT_NAME ${name} UNDERBRUSH_DEPENDS "${M_DEPENDS}")
  set_property(GLOBAL APPEND PROPERTY UNDERBRUSH_MODULES ${name})
  set(kind library)
  if(M_OUTER)
    set(kind outer)
  endif()
  underbrush_fast_build(underbrush_${name} ${kind})
endfunction()
