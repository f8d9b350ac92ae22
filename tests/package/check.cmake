# Installs this build, then configures, builds and runs a project that finds it.   Wants BUILD_DIR, SOURCE_DIR, CXX.
set(prefix "${BUILD_DIR}/package-test/prefix")
set(source "${BUILD_DIR}/package-test/source")
set(consumer "${BUILD_DIR}/package-test/consumer")
file(REMOVE_RECURSE "${BUILD_DIR}/package-test")
file(COPY "${SOURCE_DIR}/" DESTINATION "${source}")  # its golden pictures are written there
unset(ENV{UPDATE_GOLDENS})
unset(ENV{PUPPETWARP_GOLDEN_FOLDER})
unset(ENV{PUPPETWARP_IMAGE_TEST_OUTPUT})

# run(COMMAND...): must succeed.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
endfunction()

# test(NAME): that test of the project must pass.
function(test name)
  run("${CMAKE_CTEST_COMMAND}" --test-dir "${consumer}" --output-on-failure --no-tests=error -R "^${name}$")
endfunction()

# test_failing(NAME TEXT...): must fail and say each text.
function(test_failing name)
  execute_process(
    COMMAND "${CMAKE_CTEST_COMMAND}" --test-dir "${consumer}" --output-on-failure --no-tests=error -R "^${name}$"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result EQUAL 0)
    message(FATAL_ERROR "${name} passes, and should not\n${output}")
  endif()
  foreach(text IN LISTS ARGN)
    string(FIND "${output}" "${text}" at)
    if(at LESS 0)
      message(FATAL_ERROR "${name} does not say: ${text}\n${output}")
    endif()
  endforeach()
endfunction()

# left(NAME...): exactly these files are in image-tests/, which is then removed.
function(left)
  file(GLOB files RELATIVE "${consumer}/image-tests" "${consumer}/image-tests/*")
  list(SORT files)
  if(NOT "${files}" STREQUAL "${ARGN}")
    message(FATAL_ERROR "image-tests/ holds ${files}, not ${ARGN}")
  endif()
  file(REMOVE_RECURSE "${consumer}/image-tests")
endfunction()

run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${prefix}")
run("${CMAKE_COMMAND}" -S "${source}" -B "${consumer}" -G Ninja "-DCMAKE_PREFIX_PATH=${prefix}"
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}")
run("${CMAKE_COMMAND}" --build "${consumer}")
run("${consumer}/consumer")
foreach(file share/man/man1/puppetwarp.1 share/man/man1/puppetwarp-warp.1 share/man/man1/puppetwarp-diff.1
             share/bash-completion/completions/puppetwarp share/zsh/site-functions/_puppetwarp
             share/fish/vendor_completions.d/puppetwarp.fish)
  file(SIZE "${prefix}/${file}" size)  # fails where there is none
  if(size LESS 500)
    message(FATAL_ERROR "${file} has ${size} bytes")
  endif()
endforeach()

# No golden picture: a failure, until somebody accepts one.
test_failing(square "there is no golden picture yet" "UPDATE_GOLDENS=1" "${consumer}/image-tests/square.actual.png")
left(square.actual.png)
test_failing(Grey.Passes "there is no golden picture yet" "UPDATE_GOLDENS=1" "${consumer}/image-tests/grey.actual.png")
left(grey.actual.png)
set(ENV{UPDATE_GOLDENS} 1)
test(square)
test(Grey.Passes)
test_failing(writes_rubbish "the actual picture cannot be compared")
unset(ENV{UPDATE_GOLDENS})
file(GLOB goldens RELATIVE "${source}/goldens" "${source}/goldens/*")
if(NOT "${goldens}" STREQUAL "grey.png;square.png")
  message(FATAL_ERROR "goldens/ holds ${goldens}")
endif()
file(REMOVE_RECURSE "${consumer}/image-tests")

foreach(name square near own_place Grey.Passes)
  test(${name})
endforeach()
left()

# The picture changed: three pictures that show it.
test_failing(wrong "${source}/goldens/square.png: different" "UPDATE_GOLDENS=1"
             "${consumer}/image-tests/wrong.heatmap.png")
left(wrong.actual.png wrong.expected.png wrong.heatmap.png)
test_failing(wrong/own_place "${consumer}/image-tests/wrong_own_place.actual.png")
left(wrong_own_place.actual.png wrong_own_place.expected.png wrong_own_place.heatmap.png)
test_failing(Grey.Fails "${source}/goldens/grey.png: " "UPDATE_GOLDENS=1"
             "${consumer}/image-tests/grey.heatmap.png")
left(grey.actual.png grey.expected.png grey.heatmap.png)

test_failing(ends_badly "the command ended with: 3")
test_failing(writes_nothing "the command wrote no ${consumer}/image-tests/writes_nothing.actual.png")
test_failing(writes_rubbish "the actual picture cannot be compared" "writes_rubbish.actual.png")
test_failing(bad_option "--threshold 7")

# Where continuous integration wants them.
set(ENV{PUPPETWARP_IMAGE_TEST_OUTPUT} "${BUILD_DIR}/package-test/elsewhere")
test_failing(wrong "${BUILD_DIR}/package-test/elsewhere/wrong.heatmap.png")
test_failing(Grey.Fails "${BUILD_DIR}/package-test/elsewhere/grey.heatmap.png")

# Mistakes are found when the project is configured.
function(misuse text)
  execute_process(COMMAND "${CMAKE_COMMAND}" -S "${source}" -B "${consumer}" "-DMISUSED=${ARGN}"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  string(FIND "${output}" "${text}" at)
  if(result EQUAL 0 OR at LESS 0)
    message(FATAL_ERROR "puppetwarp_add_image_test(${ARGN}) does not say: ${text}\n${output}")
  endif()
endfunction()
misuse("GOLDEN is missing" NAME a COMMAND draw 1 <ACTUAL>)
misuse("NAME is missing" COMMAND draw 1 <ACTUAL> GOLDEN a.png)
misuse("where does the command write its picture?" NAME a COMMAND draw 1 a.png GOLDEN a.png)
misuse("two files of one format" NAME a COMMAND draw 1 a.tif ACTUAL a.tif GOLDEN a.png)
misuse("unknown argument GILDED" GILDED NAME a COMMAND draw 1 <ACTUAL> GOLDEN a.png)
