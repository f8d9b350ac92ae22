#include "view/file_browser.h"

#include "view/theme.h"

#include <puppetwarp/base/errors.h>

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <system_error>
#include <utility>

namespace puppetwarp::ui {

namespace {

namespace fs = std::filesystem;

fs::path home_folder() {
    const char* home = std::getenv("HOME");
    return home && *home ? fs::path(home) : fs::path("/");
}

}  // namespace

void FileBrowser::open(Options options, std::function<void(const fs::path&)> chosen) {
    options_ = std::move(options);
    chosen_ = std::move(chosen);
    name_ = options_.name;
    to_replace_.clear();
    result_.clear();
    std::error_code error;
    fs::path start = fs::absolute(options_.folder, error);
    if (options_.folder.empty() || error || !fs::is_directory(start, error)) start = fs::current_path(error);
    go_to(start);
    open_ = appearing_ = true;
}

void FileBrowser::go_to(const fs::path& folder) {
    folder_ = folder.lexically_normal();
    // A trailing separator would make an empty last part.
    if (!folder_.has_filename() && folder_.has_relative_path()) folder_ = folder_.parent_path();
    error_.clear();
    entries_.clear();
    try {
        entries_ = list_folder(folder_, options_.kind);
    } catch (const std::exception& error) {
        error_ = error.what();
    }
}

void FileBrowser::accept(const fs::path& file) {
    std::error_code ignored;
    if (options_.writes && fs::exists(file, ignored)) {
        to_replace_ = file;
    } else {
        result_ = file;
    }
}

void FileBrowser::accept_name() {
    if (name_.empty()) return;
    fs::path file = name_.starts_with("~/") ? home_folder() / name_.substr(2) : folder_ / name_;
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) {
        go_to(file);
        name_.clear();
        return;
    }
    if (!options_.writes && !fs::exists(file, ignored)) {
        error_ = InvalidInput(name_, "there is no such file").what();
        return;
    }
    if (options_.writes && !file.has_extension()) file += options_.kind == FileKind::puppets ? ".puppet.json" : ".png";
    accept(file);
}

void FileBrowser::draw_places() {
    if (ImGui::Button("Home")) go_to(home_folder());
    ImGui::SameLine();
    ImGui::BeginDisabled(folder_ == folder_.root_path());
    if (ImGui::Button("↑ Up")) go_to(fs::path(folder_.parent_path()));
    ImGui::EndDisabled();
    // The parts of the path, each a way back up; the first ones go when there is no room.
    std::vector<fs::path> parts;
    for (fs::path part = folder_; parts.empty() || parts.back() != part; part = part.parent_path())
        parts.push_back(part);
    float room = ImGui::GetContentRegionAvail().x - ImGui::GetItemRectSize().x * 2 - 40;
    std::size_t shown = 0;
    const float padding = ImGui::GetStyle().FramePadding.x * 2;
    while (shown < parts.size()) {
        const float width = ImGui::CalcTextSize(parts[shown].filename().c_str()).x + padding;
        if (shown > 0 && width > room) break;
        room -= width;
        ++shown;
    }
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(0, ImGui::GetStyle().ItemSpacing.y));
    fs::path target;
    for (std::size_t i = shown; i-- > 0;) {
        ImGui::SameLine();
        const std::string name = parts[i].has_filename() ? parts[i].filename().string() : "/";
        ImGui::PushID(static_cast<int>(i));
        if (ImGui::Button(name.c_str())) target = parts[i];
        ImGui::PopID();
        if (i > 0) {
            ImGui::SameLine();
            ImGui::AlignTextToFramePadding();
            ImGui::TextDisabled("›");
        }
    }
    ImGui::PopStyleVar();
    ImGui::PopStyleColor();
    if (!target.empty()) go_to(target);
}

void FileBrowser::draw_entries(float height) {
    fs::path folder;
    ImGui::PushStyleColor(ImGuiCol_ChildBg, colours::canvas);
    ImGui::BeginChild("entries", {0, height}, true);
    if (entries_.empty())
        ImGui::TextDisabled(error_.empty() ? "Nothing here that can be used" : "This folder cannot be shown");
    for (const FolderEntry& entry : entries_) {
        ImGui::PushID(entry.name.c_str());
        const bool chosen = !entry.is_folder && entry.name == name_;
        const std::string label = entry.is_folder ? entry.name + "/" : entry.name;
        const bool clicked = ImGui::Selectable(
            "##entry", chosen, ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_DontClosePopups);
        const ImVec2 row = ImGui::GetItemRectMin();
        const float right = ImGui::GetItemRectMax().x;
        ImDrawList& draw = *ImGui::GetWindowDrawList();
        const ImVec2 at{row.x + ImGui::GetStyle().ItemSpacing.x, row.y + ImGui::GetStyle().ItemSpacing.y / 2};
        draw.AddText(at, ImGui::GetColorU32(entry.is_folder ? colours::accent : colours::text), label.c_str());
        if (!entry.is_folder) {
            const std::string size = readable_size(entry.size_bytes);
            const float width = ImGui::CalcTextSize(size.c_str()).x;
            draw.AddText({right - width - 8, at.y}, ImGui::GetColorU32(colours::dim_text), size.c_str());
        }
        ImGui::PopID();
        if (!clicked) continue;
        if (entry.is_folder) {
            folder = folder_ / entry.name;
        } else {
            name_ = entry.name;
            if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) accept(folder_ / entry.name);
        }
    }
    ImGui::EndChild();
    ImGui::PopStyleColor();
    if (!folder.empty()) go_to(folder);
}

void FileBrowser::draw_name_row() {
    const float buttons = ImGui::CalcTextSize((options_.accept + "Cancel").c_str()).x +
                          ImGui::GetStyle().FramePadding.x * 4 + ImGui::GetStyle().ItemSpacing.x * 2;
    if (appearing_) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - buttons);
    const bool entered = ImGui::InputTextWithHint(
        "##name", "Name or path", &name_, ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    ImGui::SameLine();
    ImGui::BeginDisabled(name_.empty());
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_HeaderActive));
    const bool pressed = ImGui::Button(options_.accept.c_str());
    ImGui::PopStyleColor();
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) open_ = false;
    if (entered || pressed) accept_name();
}

void FileBrowser::draw_replace_question() {
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(colours::warning, "%s is there already.", to_replace_.filename().c_str());
    ImGui::SameLine();
    if (ImGui::Button("Replace it")) result_ = to_replace_;
    ImGui::SameLine();
    if (ImGui::Button("Choose another name")) to_replace_.clear();
}

void FileBrowser::draw(float scale) {
    if (!open_) return;
    if (appearing_) ImGui::OpenPopup(options_.title.c_str());
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowSize({std::min(760 * scale, screen.x - 40), std::min(540 * scale, screen.y - 40)});
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    constexpr ImGuiWindowFlags flags =
        ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;
    if (ImGui::BeginPopupModal(options_.title.c_str(), nullptr, flags)) {
        draw_places();
        const float below = ImGui::GetTextLineHeightWithSpacing() + ImGui::GetFrameHeightWithSpacing() +
                            ImGui::GetStyle().ItemSpacing.y;
        draw_entries(ImGui::GetContentRegionAvail().y - below);
        if (!error_.empty()) {
            ImGui::TextColored(colours::error, "%s", error_.c_str());
        } else {
            ImGui::TextDisabled("%s", options_.note.c_str());
        }
        if (to_replace_.empty()) {
            draw_name_row();
        } else {
            draw_replace_question();
        }
        appearing_ = false;
        if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) open_ = false;
        if (!result_.empty()) open_ = false;
        if (!open_) ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
    if (!open_ && !result_.empty()) chosen_(fs::path(result_));
}

}  // namespace puppetwarp::ui
