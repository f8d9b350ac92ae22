#pragma once

#include <puppetwarp/diff/compare.h>
#include <puppetwarp/image/read.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

//! Two picture files compared.
struct ComparedFiles {
    Comparison comparison;
    Image expected;
    Image actual;
    Image heat_map;  //!< no pixels where it was not asked for, or the pictures are not comparable
    std::vector<std::pair<std::string, double>> timings_ms = {};  //!< of `read` and `compare`
};

//! How two files are read: the results are the same.
enum class PairReading {
    at_once,         //!< in two threads; of two that cannot be read, the expected one is complained of
    one_after_other  //!< for callers that are one of many threads
};

//! Reads two pictures and compares them. \param show  whether the heat map is wanted.
//! \throw InvalidInput  as `read_image` and `compare`.
ComparedFiles compare_files(const std::filesystem::path& expected, const std::filesystem::path& actual,
                            const CompareOptions& options, const ReadOptions& reading, bool show,
                            PairReading order = PairReading::at_once);

}  // namespace puppetwarp
