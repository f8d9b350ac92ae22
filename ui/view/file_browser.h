#pragma once

#include "model/folder_listing.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace puppetwarp::ui {

//! A dialog in which a file is chosen, to read or to write.
class FileBrowser {
public:
    struct Options {
        std::string title;   //!< of the dialog, its identity too
        std::string accept;  //!< what the button says
        FileKind kind = FileKind::openable;
        bool writes = false;           //!< the file may be new; one that is there is asked about
        std::filesystem::path folder;  //!< where to begin
        std::string name;              //!< suggested; empty: none
        std::string note = {};         //!< one line below the list
    };

    //! \param chosen  called with the file, after the dialog has closed.
    void open(Options options, std::function<void(const std::filesystem::path&)> chosen);
    bool is_open() const { return open_; }
    //! Draws the dialog while it is open; calls `chosen`.
    void draw(float scale);

private:
    void draw_places();
    void draw_entries(float height);
    void draw_name_row();
    void draw_replace_question();
    void go_to(const std::filesystem::path& folder);
    void accept(const std::filesystem::path& file);
    void accept_name();

    Options options_;
    std::function<void(const std::filesystem::path&)> chosen_;
    bool open_ = false;
    bool appearing_ = false;
    std::filesystem::path folder_;
    std::vector<FolderEntry> entries_;
    std::string error_;
    std::string name_;
    std::filesystem::path to_replace_;  // what is asked about; empty: nothing
    std::filesystem::path result_;      // empty: not yet
};

}  // namespace puppetwarp::ui
