# cmake -D EXECUTABLE=<file> -D FILTER=<gtest filter> -D PROPERTIES=<of each> -D OUT=<file> -P suites.cmake
# Writes the tests of an executable for ctest, a suite in one process. scripts/test.sh runs them so: to begin a process takes
# longer than most tests.

cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${EXECUTABLE} --gtest_list_tests --gtest_filter=${FILTER} OUTPUT_VARIABLE listed
                COMMAND_ERROR_IS_FATAL ANY)
get_filename_component(target ${EXECUTABLE} NAME)
string(REGEX MATCHALL "(^|\n)[^ \n]+\\.[^\n]*" suites "${listed}")
list(JOIN PROPERTIES " " properties)
set(script "")
foreach(line IN LISTS suites)
  string(REGEX REPLACE "^\n?([^ ]*)\\..*" "\\1" suite "${line}")
  if(NOT suite MATCHES "^DISABLED_|/DISABLED_")
    string(APPEND script "add_test([=[${suite}]=] ${EXECUTABLE} [=[--gtest_filter=${suite}.*:${FILTER}]=])\n"
                         "set_tests_properties([=[${suite}]=] PROPERTIES ${properties})\n")
  endif()
endforeach()
file(WRITE ${OUT} "${script}")
