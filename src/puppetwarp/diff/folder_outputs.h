#pragma once

#include <puppetwarp/diff/compare_folders.h>
#include <puppetwarp/diff/html_report.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace puppetwarp {

//! Writes pictures of the pairs that differ while two folders are compared, and keeps what a page shall show of them.
//! A pair's files have its path in the folders, with `.heatmap.png` or `.side-by-side.png` at its end; folders are made
//! where they are missing. A name that becomes too long for a file is cut, and then has `~` and the pair's index.
class FolderOutputs final : public PairObserver {
public:
    struct Folders {
        std::filesystem::path heat_maps;      //!< empty: none are wanted
        std::filesystem::path side_by_sides;  //!< likewise
    };
    //! \param page  whether pictures are kept for one.
    FolderOutputs(Folders folders, bool page);

    //! \throw InvalidInput, MachineFault  as `write_image`; a folder cannot be made.
    void see(std::size_t pair, const std::string& path, const ComparedFiles& files) override;
    void settle(std::size_t first, std::size_t last) override;

    //! The page of the finished comparison.
    HtmlReport page(const std::filesystem::path& expected, const std::filesystem::path& actual,
                    const FolderComparison& comparison);

private:
    void write_pictures(std::size_t pair, const std::string& path, const ComparedFiles& files) const;

    Folders folders_;
    bool page_;
    std::mutex mutex_;
    std::map<std::size_t, HtmlReport::Pictures> unsettled_;  // guarded by the mutex
    std::map<std::size_t, HtmlReport::Pictures> kept_;       // the first that have room; changes between pairs only
    std::size_t kept_bytes_ = 0;
};

}  // namespace puppetwarp
