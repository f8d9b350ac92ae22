#pragma once

#include "model/editor.h"
#include "view/actions.h"
#include "view/canvas.h"
#include "view/dialogs.h"
#include "view/file_browser.h"
#include "view/theme.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace puppetwarp::ui {

//! Everything inside the window: the editor, what shows it, and what a person can do with it.
class App {
public:
    //! \param scale  points for one unit of the design.
    //! \param wake   called from other threads when there is something new to show.
    App(int longest_side_px, float scale, Fonts fonts, std::function<void()> wake);

    //! \param path  a picture or a puppet file.
    void open(const std::filesystem::path& path);
    //! Before ImGui's frame begins: what happened since the last one.
    void handle(const std::vector<InputEvent>& events);
    //! Within ImGui's frame: lays out and draws everything.
    void draw();
    //! Asks about unsaved changes, then ends.
    void request_close();
    bool closed() const { return closed_; }

    std::string title() const;
    Editor& editor() { return editor_; }
    const Editor& editor() const { return editor_; }
    const Canvas& canvas() const { return canvas_; }
    //! The dialog that is open, in a word; `none`.
    std::string dialog() const;

private:
    std::vector<Action> make_actions();
    void with_saved(std::function<void()> then);
    void save(std::function<void()> then);
    void save_as(std::function<void()> then);
    void choose_and_open();
    void choose_and_export();
    bool modal() const { return browser_.is_open() || question_.is_open() || show_help_; }

    Editor editor_;
    Canvas canvas_;
    FileBrowser browser_;
    UnsavedQuestion question_;
    float scale_;
    Fonts fonts_;
    bool show_help_ = false;
    bool popup_was_open_ = false;
    bool text_was_wanted_ = false;
    bool closed_ = false;
    ActionTable actions_;  // last: they act on all of the above
};

}  // namespace puppetwarp::ui
