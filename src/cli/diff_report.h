#pragma once

#include "report.h"

#include <puppetwarp/diff/compare.h>

namespace puppetwarp::cli {

//! The report of `diff`.
Json report_json(const Comparison& comparison);

}  // namespace puppetwarp::cli
