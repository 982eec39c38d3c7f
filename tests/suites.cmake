# SPDX-License-Identifier: GPL-3.0-or-later
# Writes a ctest entry for each suite of a test program, after it is linked:
#   cmake -D PROGRAM=... -D OUTPUT=... -P suites.cmake
# An entry for each test would start the program, with all its shared libraries, five times as often.
cmake_policy(SET CMP0057 NEW)  # IN_LIST
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listing COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" lines "${listing}")
# Together with the scripts of this label they take half of the time of all tests: make test-slow runs them.
set(slow_suites AbilitiesWalk Attribute CleanEngine Faults Import InterferometricRun Mcap Outlet SuiteAspects SuiteMotionAnswers Parts Pairs PathsRun
  PerfectEngine PowerCut ProductsByThreads Ranks RayRun RefractedReferenceRun RefractionRun ReliefRun Resume Scenes/TiledCommands
  SelectionRun Signals Stop)
set(entries "")
set(suite "")
set(tests 0)
macro(end_suite)
  if(suite)
    set(label "")
    if(suite IN_LIST slow_suites)
      set(label "LABELS slow ")
    endif()
    # Suites of many tests begin first, so that no processor waits for one of them at the end.
    string(APPEND entries "add_test([==[${suite}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==] --skipped-is-77)\n"
      "set_tests_properties([==[${suite}]==] PROPERTIES ${label}TIMEOUT 1800 SKIP_RETURN_CODE 77 COST ${tests})\n")
  endif()
endmacro()
foreach(line IN LISTS lines)
  if(line MATCHES "^([^ ]+)\\.( +#.*)?$")
    end_suite()
    set(suite ${CMAKE_MATCH_1})
    set(tests 0)
  elseif(line MATCHES "^  ")
    math(EXPR tests "${tests} + 1")
  endif()
endforeach()
end_suite()
if(NOT entries)
  message(FATAL_ERROR "${PROGRAM} lists no tests")
endif()
file(WRITE ${OUTPUT} "${entries}")
