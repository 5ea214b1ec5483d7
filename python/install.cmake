# What the wheel holds beside the Python files, from the build folder UNDERBRUSH_PYTHON_FROM. With that
# option, `pip wheel` packs what another build has made and compiles nothing.
set(package ${UNDERBRUSH_PYTHON_FROM}/python/package/underbrush)
if(NOT TARGET underbrush_python)
  add_custom_target(underbrush_python)
endif()
install(FILES ${package}/_core.abi3.so ${package}/_core.pyi DESTINATION underbrush COMPONENT python EXCLUDE_FROM_ALL)
install(PROGRAMS ${UNDERBRUSH_PYTHON_FROM}/bin/underbrush DESTINATION underbrush/bin COMPONENT python EXCLUDE_FROM_ALL)
foreach(folder IN ITEMS configs examples live schemas)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/share/${folder} DESTINATION underbrush/share/underbrush
    COMPONENT python EXCLUDE_FROM_ALL)
endforeach()
if(SKBUILD_DATA_DIR)   # pip puts this beside its commands: `man underbrush` finds it there
  install(FILES ${UNDERBRUSH_PYTHON_FROM}/pages/underbrush.1.gz DESTINATION ${SKBUILD_DATA_DIR}/share/man/man1
    COMPONENT python EXCLUDE_FROM_ALL)
endif()
if(SKBUILD_METADATA_DIR)   # the wheel's folder .dist-info
  install(DIRECTORY ${UNDERBRUSH_PYTHON_FROM}/python/licenses/
    DESTINATION ${SKBUILD_METADATA_DIR}/licenses/libraries COMPONENT python EXCLUDE_FROM_ALL)
endif()
