# cmake -DSOURCE=… -DBUILD=… -DSECONDS=… -P run.cmake: builds the fuzz targets with clang and runs each
# for a few seconds. Prints SKIPPED and ends well where there is no clang.
find_program(clang NAMES clang++ clang++-14 clang++-15 clang++-16)
if(NOT clang)
  message("SKIPPED: fuzzing needs clang++, which is not installed")
  return()
endif()
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD} -G Ninja -DCMAKE_CXX_COMPILER=${clang}
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DUNDERBRUSH_FUZZ=ON -DUNDERBRUSH_TESTS=OFF
    -DUNDERBRUSH_BENCH=OFF -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
    "-DCMAKE_CXX_FLAGS=-fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all"
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BUILD} --target fuzz
  OUTPUT_VARIABLE log RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "cannot build the fuzz targets:\n${log}")
endif()
foreach(reader IN ITEMS log ply pcd numpy csv kitti poses)
  set(corpus ${BUILD}/corpus/${reader})
  file(MAKE_DIRECTORY ${corpus})
  execute_process(
    COMMAND ${BUILD}/bin/fuzz_${reader} -max_total_time=${SECONDS} -rss_limit_mb=2048 -seed=1
      -max_len=4096 -print_final_stats=1 -verbosity=0 -artifact_prefix=${BUILD}/ ${corpus}
    RESULT_VARIABLE failed ERROR_VARIABLE log)
  string(REGEX MATCH "number_of_executed_units: *([0-9]+)" runs "${log}")
  message("fuzz_${reader}: ${CMAKE_MATCH_1} runs")
  if(failed)
    message(FATAL_ERROR "fuzz_${reader} found a fault:\n${log}")
  endif()
endforeach()
