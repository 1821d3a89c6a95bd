# Builds the fuzz target in BINARY_DIR and runs it for SECONDS; fails where it finds something.
foreach(command IN ITEMS "--preset fuzz -S ${SOURCE_DIR} -B ${BINARY_DIR}" "--build ${BINARY_DIR} --target product_fuzzer")
  separate_arguments(arguments UNIX_COMMAND "${command}")
  execute_process(COMMAND ${CMAKE_COMMAND} ${arguments} WORKING_DIRECTORY ${SOURCE_DIR} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(MAKE_DIRECTORY ${BINARY_DIR}/corpus)
execute_process(
  COMMAND ${BINARY_DIR}/bin/product_fuzzer -max_total_time=${SECONDS} -timeout=10 -rss_limit_mb=4096
          -dict=${SOURCE_DIR}/tests/fuzz/dialects.dict ${BINARY_DIR}/corpus
  WORKING_DIRECTORY ${BINARY_DIR} COMMAND_ERROR_IS_FATAL ANY)
