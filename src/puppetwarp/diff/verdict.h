#pragma once

#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/examine.h>

namespace puppetwarp {

//! Holds the figures against the rules: fills `same`, `reason` and `failed`.
void judge(const Incomparable& incomparable, const CompareOptions& options, Comparison& comparison);

//! One more thing that differs beside the pixels.
void fail_metadata(const std::string& difference, Comparison& comparison);

}  // namespace puppetwarp
