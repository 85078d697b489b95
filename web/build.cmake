# Builds the dashboard: cmake -DWEB=DIR -DSTAMP=FILE -P build.cmake
#
# Packages are installed only where they are missing, so that a build needs no network twice.

if(NOT EXISTS "${WEB}/node_modules/.package-lock.json")
    execute_process(COMMAND npm ci --no-audit --no-fund --loglevel=error
        WORKING_DIRECTORY "${WEB}" COMMAND_ERROR_IS_FATAL ANY)
endif()
execute_process(COMMAND npm run --silent build
    WORKING_DIRECTORY "${WEB}" COMMAND_ERROR_IS_FATAL ANY)
file(WRITE "${STAMP}" "")
