#include "view/actions.h"

#include "view/theme.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cassert>

namespace puppetwarp::ui {

namespace {

std::string key_name(int key) {
    switch (key) {
        case GLFW_KEY_DELETE: return "Del";
        case GLFW_KEY_BACKSPACE: return "Backspace";
        case GLFW_KEY_ESCAPE: return "Esc";
        case GLFW_KEY_EQUAL: return "+";
        case GLFW_KEY_MINUS: return "-";
        default: break;
    }
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12)
        return std::string("F").append(std::to_string(key - GLFW_KEY_F1 + 1));
    return std::string(1, static_cast<char>(key));
}

bool is_checked(const Action& action) {
    return action.checked && action.checked();
}

}  // namespace

std::string readable(const Shortcut& shortcut) {
    std::string text;
    if (shortcut.modifiers.control) text += "Ctrl+";
    if (shortcut.modifiers.alt) text += "Alt+";
    if (shortcut.modifiers.shift) text += "Shift+";
    text += key_name(shortcut.key);
    return text;
}

const Action& ActionTable::find(std::string_view id) const {
    const auto found = std::find_if(actions_.begin(), actions_.end(), [&](const Action& a) { return a.id == id; });
    assert(found != actions_.end());
    return *found;
}

bool ActionTable::press(const InputEvent& key) const {
    for (const Action& action : actions_) {
        for (const Shortcut& shortcut : action.shortcuts) {
            if (shortcut.key != key.code || !(shortcut.modifiers == key.modifiers)) continue;
            if (action.enabled()) action.run();
            return true;
        }
    }
    return false;
}

void menu_item(const Action& action) {
    const std::string shortcut = action.shortcuts.empty() ? std::string() : readable(action.shortcuts.front());
    if (ImGui::MenuItem(action.name.c_str(), shortcut.c_str(), is_checked(action), action.enabled())) action.run();
}

void tool_button(const Action& action) {
    const bool enabled = action.enabled();
    ImGui::BeginDisabled(!enabled);
    ImGui::PushStyleColor(ImGuiCol_Button,
                          is_checked(action) ? ImGui::GetStyleColorVec4(ImGuiCol_Header) : ImVec4(0, 0, 0, 0));
    ImGui::PushID(action.id.c_str());
    if (ImGui::Button(action.brief.c_str())) action.run();
    ImGui::PopID();
    ImGui::PopStyleColor();
    ImGui::EndDisabled();
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
        std::string tip = action.name;
        if (!action.shortcuts.empty()) tip += "   " + readable(action.shortcuts.front());
        ImGui::SetTooltip("%s", tip.c_str());
    }
}

}  // namespace puppetwarp::ui
