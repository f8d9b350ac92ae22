# What every target of this project is built with.

add_library(puppetwarp_build_flags INTERFACE)
target_compile_features(puppetwarp_build_flags INTERFACE cxx_std_20)
# Same input, same bytes: no fused multiply-add that one build has and the next has not (DESIGN.md section 2).
target_compile_options(puppetwarp_build_flags INTERFACE -ffp-contract=off)
if(PROJECT_IS_TOP_LEVEL)
  target_compile_options(puppetwarp_build_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # g++ 12 sees overlaps in std::string's operator+ that are none (GCC bug 105651).
    target_compile_options(puppetwarp_build_flags INTERFACE -Wno-restrict)
  endif()
endif()
if(PUPPETWARP_SANITIZE)
  target_compile_options(puppetwarp_build_flags INTERFACE -fsanitize=${PUPPETWARP_SANITIZE} -fno-omit-frame-pointer
                                                          -fno-sanitize-recover=all)
  target_link_options(puppetwarp_build_flags INTERFACE -fsanitize=${PUPPETWARP_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # With sanitizers g++ 12 sees std::regex use what it has not set (GCC bug 105562).
    target_compile_options(puppetwarp_build_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()
if(PUPPETWARP_COVERAGE)
  target_compile_options(puppetwarp_build_flags INTERFACE --coverage)
  target_link_options(puppetwarp_build_flags INTERFACE --coverage)
endif()

if(PROJECT_IS_TOP_LEVEL)
  find_program(PUPPETWARP_CCACHE ccache)
  if(PUPPETWARP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${PUPPETWARP_CCACHE}")
  endif()
endif()

# puppetwarp_add_test(NAME SOURCES file... [LIBRARIES target...])
# One GoogleTest program; ctest lists each of its tests.
function(puppetwarp_add_test NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${NAME} ${ARG_SOURCES})
  # GTest::gmock_main brings GoogleTest and GoogleMock with it.
  target_link_libraries(${NAME} PRIVATE puppetwarp::puppetwarp puppetwarp_build_flags puppetwarp_private ${ARG_LIBRARIES}
                                        GTest::gmock_main)
  target_include_directories(${NAME} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  target_compile_definitions(${NAME} PRIVATE PUPPETWARP_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                             PUPPETWARP_BINARY_DIR="${PROJECT_BINARY_DIR}")
  gtest_discover_tests(${NAME} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 300)
endfunction()
