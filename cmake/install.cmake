# Installs the program, the library's modules with their public headers (each module's HEADERS), and
# what find_package(underbrush) needs. A consumer links the modules it uses: underbrush::simulate.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/underbrush)

install(TARGETS underbrush RUNTIME)
get_property(modules GLOBAL PROPERTY UNDERBRUSH_MODULES)
set(packages "")
foreach(module IN LISTS modules)
  install(TARGETS underbrush_${module} EXPORT underbrush ARCHIVE FILE_SET HEADERS)
  # The modules are static, so what they link privately a consumer's linker needs as well. A target
  # Package::name comes from that package; our own modules and PkgConfig's targets are not such.
  get_target_property(links underbrush_${module} LINK_LIBRARIES)
  list(FILTER links EXCLUDE REGEX "^(underbrush|PkgConfig)::|^-|NOTFOUND$")
  list(TRANSFORM links REPLACE "::.*$" "")
  list(APPEND packages ${links})
endforeach()
list(REMOVE_DUPLICATES packages)
list(SORT packages)
list(TRANSFORM packages REPLACE "(.+)" "find_dependency(\\1)" OUTPUT_VARIABLE UNDERBRUSH_FIND_DEPENDENCIES)
list(JOIN UNDERBRUSH_FIND_DEPENDENCIES "\n" UNDERBRUSH_FIND_DEPENDENCIES)

install(EXPORT underbrush NAMESPACE underbrush:: FILE underbrushTargets.cmake
  DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/underbrushConfig.cmake.in
  ${PROJECT_BINARY_DIR}/underbrushConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/underbrushConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/underbrushConfig.cmake
              ${PROJECT_BINARY_DIR}/underbrushConfigVersion.cmake DESTINATION ${package_dir})
