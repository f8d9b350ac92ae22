#pragma once

#include "model/input_events.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp::ui {

//! A key with what must be held beside it.
struct Shortcut {
    int key = 0;  //!< as GLFW numbers it
    Modifiers modifiers;
};

//! `Ctrl+Shift+S`
std::string readable(const Shortcut& shortcut);

//! Something the editor can do. Menu, toolbar, shortcuts and help all come from it.
struct Action {
    std::string id;
    std::string name;                 //!< as the menu shows it
    std::string brief;                //!< as the toolbar shows it
    std::vector<Shortcut> shortcuts;  //!< the first one is shown
    std::function<bool()> enabled;
    std::function<void()> run;
    std::function<bool()> checked = {};  //!< for what is either on or off
};

//! All actions, by id.
class ActionTable {
public:
    explicit ActionTable(std::vector<Action> actions) : actions_(std::move(actions)) {}

    const std::vector<Action>& all() const { return actions_; }
    //! \pre there is one.
    const Action& find(std::string_view id) const;
    //! Runs what the key stands for, if that is possible now. \return true when the key stands for something.
    bool press(const InputEvent& key) const;

private:
    std::vector<Action> actions_;
};

//! A line of a menu. \pre within a menu
void menu_item(const Action& action);
//! A button of the toolbar, with the shortcut in its tooltip.
void tool_button(const Action& action);

}  // namespace puppetwarp::ui
