#include "view/dialogs.h"

#include <imgui.h>

#include <utility>

namespace puppetwarp::ui {

void UnsavedQuestion::open(std::string document, std::function<void()> save, std::function<void()> discard) {
    document_ = std::move(document);
    save_ = std::move(save);
    discard_ = std::move(discard);
    open_ = appearing_ = true;
}

void UnsavedQuestion::draw(float scale) {
    if (!open_) return;
    constexpr const char* title = "Unsaved changes";
    if (std::exchange(appearing_, false)) ImGui::OpenPopup(title);
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    constexpr ImGuiWindowFlags flags =
        ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;
    std::function<void()> answer;
    if (ImGui::BeginPopupModal(title, nullptr, flags)) {
        ImGui::Text("%s has changes that are not saved.", document_.c_str());
        ImGui::TextDisabled("They are lost if you go on without saving.");
        ImGui::Dummy({0, 6 * scale});
        ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_HeaderActive));
        if (ImGui::Button("Save", {110 * scale, 0})) answer = save_;
        ImGui::PopStyleColor();
        ImGui::SameLine();
        if (ImGui::Button("Don't save", {110 * scale, 0})) answer = discard_;
        ImGui::SameLine();
        const bool escape = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
        if (ImGui::Button("Cancel", {110 * scale, 0}) || escape || answer) {
            open_ = false;
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndPopup();
    }
    if (answer) answer();
}

}  // namespace puppetwarp::ui
