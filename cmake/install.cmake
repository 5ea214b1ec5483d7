# Installs the program, the library's modules with their public headers (each module's HEADERS), and
# what find_package(underbrush) needs. A consumer links the modules it uses: underbrush::simulate.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/underbrush)

install(TARGETS underbrush RUNTIME COMPONENT program)
get_property(modules GLOBAL PROPERTY UNDERBRUSH_MODULES)
set(finds "")
foreach(module IN LISTS modules)
  install(TARGETS underbrush_${module} EXPORT underbrush ARCHIVE FILE_SET HEADERS)
  # The modules are static, so what they link privately a consumer's linker needs as well. A target
  # Package::name comes from that package, PkgConfig::NAME from pkg_check_modules(NAME ...).
  get_target_property(links underbrush_${module} LINK_LIBRARIES)
  list(FILTER links EXCLUDE REGEX "^underbrush::|^-|NOTFOUND$")
  foreach(link IN LISTS links)
    if(link MATCHES "^PkgConfig::(.+)")
      set(name ${CMAKE_MATCH_1})
      list(APPEND finds "find_dependency(PkgConfig)"
        "pkg_check_modules(${name} REQUIRED IMPORTED_TARGET ${${name}_MODULE_NAME})")
    else()
      string(REGEX REPLACE "::.*$" "" package ${link})
      list(APPEND finds "find_dependency(${package})")
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES finds)
list(JOIN finds "\n" UNDERBRUSH_FIND_DEPENDENCIES)

# The real scan that `underbrush demo` looks for beside the program.
install(DIRECTORY share/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/underbrush)

install(EXPORT underbrush NAMESPACE underbrush:: FILE underbrushTargets.cmake
  DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/underbrushConfig.cmake.in
  ${PROJECT_BINARY_DIR}/underbrushConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/underbrushConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/underbrushConfig.cmake
              ${PROJECT_BINARY_DIR}/underbrushConfigVersion.cmake DESTINATION ${package_dir})
