#pragma once

#include <puppetwarp/base/progress.h>
#include <puppetwarp/diff/compare_files.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace puppetwarp {

//! How a picture of two folders came out.
enum class PairState {
    same,
    different,
    missing,       //!< of the actual folder
    extra,         //!< in the actual folder
    not_compared,  //!< a file cannot be read, or the options do not suit it
};

//! `same`, `different`, `missing`, `extra`, `not compared`.
std::string pair_state_name(PairState state);

//! One picture of two folders.
struct PairResult {
    std::string path;  //!< in either folder, with `/`
    PairState state = PairState::same;
    Comparison comparison;  //!< of `same` and `different`
    std::string error;      //!< of `not_compared`, one line
};

//! Two folders compared as trees.
struct FolderComparison {
    bool same = true;                //!< every pair is; nothing is missing, extra or not compared
    std::vector<PairResult> pairs;   //!< in the order of the bytes of their paths
    std::vector<std::string> loops;  //!< links to a folder that they lie in, of either folder: not followed

    std::size_t count(PairState state) const;
};

//! Sees pairs while they are compared: writes their pictures, say.
class PairObserver {
public:
    virtual ~PairObserver() = default;
    //! A pair was compared. Comes from many threads at once, each pair once.
    virtual void see(std::size_t /*pair*/, const std::string& /*path*/, const ComparedFiles& /*files*/) {}
    //! Pairs first to last - 1 are done and will not be seen again. From the calling thread, in order.
    virtual void settle(std::size_t /*first*/, std::size_t /*last*/) {}
};

//! Compares the pictures of two folders and of the folders below them that have the same path. All threads work on
//! pairs; neither the results nor their order depend on how many there are.
//! \param show  whether observers want the heat map of what differs.
//! \throw InvalidInput  a folder cannot be read, or neither has a picture; options that are not sound.
//!        What a single pair throws is its result.
FolderComparison compare_folders(const std::filesystem::path& expected, const std::filesystem::path& actual,
                                 const CompareOptions& options, const ReadOptions& reading, bool show,
                                 PairObserver& observer, Progress& progress);

}  // namespace puppetwarp
