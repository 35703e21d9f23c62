# Installs the build BUILD, builds the consumer of SOURCE against it, and runs it.
#   cmake -DBUILD=... -DSOURCE=... -P package_test.cmake
set(scratch "${BUILD}/package-test")
file(REMOVE_RECURSE "${scratch}")
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY OUTPUT_QUIET)
endfunction()
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${scratch}/installed")
run("${CMAKE_COMMAND}" -S "${SOURCE}/samples/consumer" -B "${scratch}/build" "-DCMAKE_PREFIX_PATH=${scratch}/installed")
run("${CMAKE_COMMAND}" --build "${scratch}/build")
execute_process(COMMAND "${scratch}/build/consumer" "${SOURCE}/samples/burion-cube/start.json"
  OUTPUT_VARIABLE told COMMAND_ERROR_IS_FATAL ANY)
message("the last sphere moves by ${told}")
if(NOT told MATCHES "-[0-9.e-]+ mm")
  message(FATAL_ERROR "pressed down, it should move down")
endif()
foreach(file bin/palpate share/man/man1/palpate.1 share/bash-completion/completions/palpate share/zsh/site-functions/_palpate
        share/palpate/schemas/compare.schema.json)
  if(NOT EXISTS "${scratch}/installed/${file}")
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
file(REMOVE_RECURSE "${scratch}")
