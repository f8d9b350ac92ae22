#pragma once

#include "report.h"

#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/compare_folders.h>

namespace puppetwarp::cli {

//! The report of `diff` of two pictures.
Json report_json(const Comparison& comparison);

//! The report of `diff` of two folders.
Json report_json(const FolderComparison& comparison);

//! For people: what is not the same, a line each, and a line with the counts.
void print_folders(const FolderComparison& comparison);

}  // namespace puppetwarp::cli
