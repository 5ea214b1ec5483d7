# `cpack -G DEB` (target deb): the programs, their data, manual page and shell completion; the
# library's headers and archives are not in it.
if(TARGET underbrush-reference)
  # Written by the programs that were built.
  set(pages ${PROJECT_BINARY_DIR}/pages)
  set(completions "")
  set(made "")
  foreach(shell IN ITEMS bash zsh fish)
    list(APPEND made COMMAND $<TARGET_FILE:underbrush> completion ${shell} > ${shell})
    list(APPEND completions ${pages}/${shell})
  endforeach()
  file(MAKE_DIRECTORY ${pages})
  add_custom_command(OUTPUT ${pages}/underbrush.1.gz ${completions}
    COMMAND $<TARGET_FILE:underbrush-reference> man > underbrush.1
    COMMAND gzip -9nf underbrush.1
    ${made}
    DEPENDS underbrush underbrush-reference WORKING_DIRECTORY ${pages} VERBATIM)
  add_custom_target(pages ALL DEPENDS ${pages}/underbrush.1.gz ${completions})
  if(TARGET underbrush_python)   # The wheel has the manual page, too.
    add_dependencies(underbrush_python pages)
  endif()
  install(FILES ${pages}/underbrush.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
    COMPONENT program OPTIONAL)
  install(FILES ${pages}/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
    RENAME underbrush COMPONENT program OPTIONAL)
  install(FILES ${pages}/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions
    RENAME _underbrush COMPONENT program OPTIONAL)
  install(FILES ${pages}/fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
    RENAME underbrush.fish COMPONENT program OPTIONAL)
endif()
foreach(folder IN ITEMS configs examples live schemas)
  if(EXISTS ${PROJECT_SOURCE_DIR}/share/${folder})
    install(DIRECTORY ${PROJECT_SOURCE_DIR}/share/${folder}
      DESTINATION ${CMAKE_INSTALL_DATADIR}/underbrush COMPONENT program)
  endif()
endforeach()

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/underbrush COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME underbrush)
set(CPACK_PACKAGE_VENDOR "The Underbrush developers")
set(CPACK_PACKAGE_CONTACT "The Underbrush developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
"Underbrush learns a model of off-road terrain (ground, plants, and how often they let a beam pass)
from lidar logs, simulates a lidar in it, and scores the simulation against logs held out.")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
include(CPack)
add_custom_target(deb COMMAND ${CMAKE_CPACK_COMMAND} -G DEB WORKING_DIRECTORY ${PROJECT_BINARY_DIR}
  COMMENT "Packing the programs for Debian")
add_dependencies(deb underbrush)
if(TARGET live_grpc)
  install(TARGETS live_grpc LIBRARY DESTINATION lib/underbrush COMPONENT program OPTIONAL)
  add_dependencies(deb live_grpc)
endif()
if(TARGET pages)
  add_dependencies(deb pages)
endif()
