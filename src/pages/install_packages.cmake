# cmake -DNPM=… [-DWHICH=--omit=dev] -P: what package-lock.json names, into node_modules beside it. No package's own scripts run.
execute_process(COMMAND ${NPM} ci ${WHICH} --ignore-scripts --no-audit --no-fund --prefer-offline --loglevel=error
                RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "The packages of the pages could not be fetched from the npm registry. "
                      "-DBESPOKE_BUILD_PAGES=OFF builds everything but `bespoke view` and `bespoke pick`.")
endif()
