#pragma once

#include <puppetwarp/base/output_file.h>
#include <puppetwarp/diff/compare_folders.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp {

//! A page that shows compared pictures to a person: a table to sort and to search, and of each pair a slider, a
//! flicker, both beside each other, and the heat map. It is one file with everything in it, needs no network, and holds
//! names of files as text only. Longer sides over 2000 px are shown smaller; of many pictures the first 192 MB are
//! shown (as packed), the table has all.
class HtmlReport {
public:
    //! What a page shows of one pair: PNG files.
    struct Pictures {
        std::string expected;
        std::string actual;
        std::string heat_map;  //!< empty: there is none
        int shrunk = 1;        //!< shown smaller by so much

        std::size_t bytes() const { return expected.size() + actual.size() + heat_map.size(); }
    };
    //! Pictures go into a page as long as those before them are smaller than this, together.
    static constexpr std::size_t usual_room_bytes = std::size_t{192} << 20;

    static Pictures pictures_of(const ComparedFiles& files);

    //! \param expected, actual  what was compared, for the head of the page.
    HtmlReport(const std::filesystem::path& expected, const std::filesystem::path& actual,
               std::size_t room_bytes = usual_room_bytes);

    //! Adds a row, with its pictures where there is room.
    void add(const PairResult& pair, std::optional<Pictures> pictures);
    //! Writes the page, whole or not at all unless the target is a pipe. \throw InvalidInput, MachineFault
    void write(OutputFile& file) const;

private:
    struct Row {
        PairResult pair;
        std::optional<std::size_t> pictures;  // index
    };
    void write_place(std::string_view name, OutputFile& file) const;
    void write_rows(OutputFile& file) const;
    void write_pictures(OutputFile& file) const;
    std::string filters() const;
    std::size_t count(PairState state) const;

    std::string expected_;
    std::string actual_;
    std::vector<Row> rows_;
    std::vector<Pictures> pictures_;
    std::size_t room_bytes_;
    std::size_t bytes_ = 0;
};

}  // namespace puppetwarp
