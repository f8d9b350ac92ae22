#pragma once
// For tests with GoogleTest: link puppetwarp::testing (find_package(puppetwarp COMPONENTS testing)).

#include <puppetwarp/testing/golden.h>

#include <gtest/gtest.h>

#include <iostream>

//! The folder of golden pictures for one target: target_compile_definitions(T PRIVATE PUPPETWARP_GOLDEN_FOLDER="...").
#ifndef PUPPETWARP_GOLDEN_FOLDER
#define PUPPETWARP_GOLDEN_FOLDER ""
#endif

//! EXPECT_IMAGE_NEAR(actual, golden[, options]): the picture `actual` (a puppetwarp::Image) is that of the file
//! `golden`, as `puppetwarp::check_golden` tells with `options` (puppetwarp::GoldenOptions):
//!     EXPECT_IMAGE_NEAR(draw(), "star.png", {.compare = {.threshold = 2 / 255.0}});
//! UPDATE_GOLDENS=1 in the environment accepts what differs, and standard output says so.
#define EXPECT_IMAGE_NEAR(actual, ...)                  \
    EXPECT_PRED_FORMAT1(::puppetwarp::golden_assertion, \
                        ::puppetwarp::golden_result(PUPPETWARP_GOLDEN_FOLDER, actual, __VA_ARGS__))
//! The same, and the test ends where it fails.
#define ASSERT_IMAGE_NEAR(actual, ...)                  \
    ASSERT_PRED_FORMAT1(::puppetwarp::golden_assertion, \
                        ::puppetwarp::golden_result(PUPPETWARP_GOLDEN_FOLDER, actual, __VA_ARGS__))

namespace puppetwarp {

//! `check_golden` with its arguments in the order of the macros.
inline GoldenResult golden_result(const std::filesystem::path& usual_folder, const Image& actual,
                                  const std::filesystem::path& golden, const GoldenOptions& options = {}) {
    return check_golden(actual, golden, options, usual_folder);
}

//! What GoogleTest makes of a result. \param expression  as typed; the message says more.
inline ::testing::AssertionResult golden_assertion(const char* /*expression*/, const GoldenResult& result) {
    if (result.updated) std::cout << "[ GOLDEN   ] " << result.message << std::endl;
    return result.passed ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << result.message;
}

}  // namespace puppetwarp
