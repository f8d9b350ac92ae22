# Image tests for ctest, of whatever program writes pictures:
#
#   puppetwarp_add_image_test(NAME <name> COMMAND <command> [<argument>...] GOLDEN <picture>
#                             [ACTUAL <picture>] [OPTIONS <option>...] [WORKING_DIRECTORY <folder>])
#
# Adds the test <name>: runs the command and compares the picture that it writes with the golden one, through
# `puppetwarp diff`. As in add_test(), the command may be a target of this project, and arguments may hold generator
# expressions; each `<ACTUAL>` in an argument becomes the path where the picture is wanted. A program that chooses the
# place itself is told by ACTUAL, relative to the folder in which it runs.
#
#   puppetwarp_add_image_test(NAME star COMMAND draw --shape star -o <ACTUAL> GOLDEN goldens/star.png
#                             OPTIONS --threshold 2/255)
#
# GOLDEN is relative to the current source folder, WORKING_DIRECTORY is the current binary folder by default, and
# OPTIONS go to `puppetwarp diff` (see there; by default nothing may differ; a relative --mask is sought in the working
# directory). Both pictures are of one file format.
#
# A failure leaves <name>.expected.EXT, <name>.actual.EXT and <name>.heatmap.png in image-tests/ of the current binary
# folder, or in the folder that PUPPETWARP_IMAGE_TEST_OUTPUT in the environment names. A golden picture that is missing
# is a failure. With UPDATE_GOLDENS=1 in the environment a picture that would fail becomes the golden one instead.

function(puppetwarp_add_image_test)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "NAME;GOLDEN;ACTUAL;WORKING_DIRECTORY" "COMMAND;OPTIONS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "puppetwarp_add_image_test: unknown argument ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  foreach(needed NAME COMMAND GOLDEN)
    if(NOT ARG_${needed})
      message(FATAL_ERROR "puppetwarp_add_image_test: ${needed} is missing")
    endif()
  endforeach()
  if(NOT TARGET puppetwarp::command)
    message(FATAL_ERROR "puppetwarp_add_image_test: this puppetwarp was built without its command")
  endif()
  if(NOT ARG_ACTUAL AND NOT "${ARG_COMMAND}" MATCHES "<ACTUAL>")
    message(FATAL_ERROR "puppetwarp_add_image_test(${ARG_NAME}): where does the command write its picture? "
                        "Pass it <ACTUAL>, or say it by ACTUAL")
  endif()

  cmake_path(ABSOLUTE_PATH ARG_GOLDEN BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" NORMALIZE)
  if(NOT ARG_WORKING_DIRECTORY)
    set(ARG_WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  if(ARG_ACTUAL)
    cmake_path(ABSOLUTE_PATH ARG_ACTUAL BASE_DIRECTORY "${ARG_WORKING_DIRECTORY}" NORMALIZE)
    cmake_path(GET ARG_GOLDEN EXTENSION LAST_ONLY golden_extension)
    cmake_path(GET ARG_ACTUAL EXTENSION LAST_ONLY actual_extension)
    if(NOT golden_extension STREQUAL actual_extension OR ARG_GOLDEN STREQUAL ARG_ACTUAL)
      message(FATAL_ERROR "puppetwarp_add_image_test(${ARG_NAME}): ACTUAL and GOLDEN must be two files of one format")
    endif()
  endif()

  # The first word may be a target, also one that is defined later; a semicolon in an argument is none between arguments.
  set(command "")
  foreach(word IN LISTS ARG_COMMAND)
    if(NOT command AND word MATCHES "^[A-Za-z0-9_.+:-]+$")
      set(word "$<$<TARGET_EXISTS:${word}>:$<TARGET_FILE:${word}>>$<$<NOT:$<TARGET_EXISTS:${word}>>:${word}>")
    endif()
    string(REPLACE ";" "\\;" word "${word}")
    list(APPEND command "${word}")
  endforeach()
  add_test(NAME "${ARG_NAME}" WORKING_DIRECTORY "${ARG_WORKING_DIRECTORY}" COMMAND "${CMAKE_COMMAND}"
    "-DNAME=${ARG_NAME}" "-DPUPPETWARP=$<TARGET_FILE:puppetwarp::command>" "-DGOLDEN=${ARG_GOLDEN}"
    "-DACTUAL=${ARG_ACTUAL}" "-DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/image-tests"
    -P "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/run_image_test.cmake" -- ${ARG_OPTIONS} --command ${command})
endfunction()
