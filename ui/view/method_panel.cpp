#include "view/method_panel.h"

#include "view/theme.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp::ui {

namespace {

const char* about(Method method) {
    switch (method) {
        case Method::harmonic: return "Soft as rubber; peaks at each pin.";
        case Method::biharmonic: return "Smooth everywhere; wide curves.";
        case Method::triharmonic: return "Smoother still; swings wider.";
        case Method::tetraharmonic: return "The smoothest; swings widest.";
        case Method::thin_shell: return "A sheet that stretches and bends.";
        case Method::laplacian: return "Keeps details; they do not turn.";
        case Method::laplacian_rotated: return "Keeps details; they turn along.";
        case Method::laplacian_similarity: return "Details turn and grow along.";
        case Method::multiresolution: return "Details ride on a smooth base.";
        case Method::arap: return "As rigid as possible everywhere.";
        case Method::smooth_arap: return "Rigid limbs in smooth bends.";
        case Method::fold_free: return "Never folds, wherever pins go.";
        case Method::fast: return "Weighted mean whose points turn by themselves.";
        case Method::lbs: return "Weighted mean of the handles; joints shrink.";
        case Method::dual_complex: return "Weighted mean that keeps joints round.";
        case Method::intrinsic: return "Weighted mean that follows whole turns.";
        case Method::mls_affine: return "By near pins alone; may shear.";
        case Method::mls_similarity: return "By near pins alone; may grow.";
        case Method::mls_rigid: return "By near pins alone; rigid.";
    }
    return "";
}

const char* about(ArapEnergy energy) {
    switch (energy) {
        case ArapEnergy::elements: return "Each triangle for itself.";
        case ArapEnergy::spokes: return "Edges at a vertex turn as one.";
        case ArapEnergy::spokes_and_rims: return "Triangles at a vertex turn as one.";
    }
    return "";
}

void dim_line(const char* text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colours::dim_text);
    ImGui::TextWrapped("%s", text);
    ImGui::PopStyleColor();
}

// A list whose entries say below their names what they are for. \return true when another one was chosen.
template <typename Value, typename About>
bool choose(const char* id, const std::vector<std::string>& names, std::string& now,
            Value (*value_of)(std::string_view), About tell) {
    bool chosen = false;
    ImGui::SetNextItemWidth(-1);
    if (!ImGui::BeginCombo(id, now.c_str(), ImGuiComboFlags_HeightLargest)) return false;
    for (const std::string& name : names) {
        ImGui::PushID(name.c_str());
        const ImVec2 at = ImGui::GetCursorPos();
        const float height = 2 * ImGui::GetTextLineHeight() + ImGui::GetStyle().ItemSpacing.y / 2;
        if (ImGui::Selectable("##entry", name == now, 0, {0, height})) {
            chosen = name != now;
            now = name;
        }
        if (ImGui::IsWindowAppearing() && name == now) ImGui::SetScrollHereY();
        const ImVec2 after = ImGui::GetCursorPos();
        ImGui::SetCursorPos(at);
        ImGui::TextUnformatted(name.c_str());
        ImGui::SetCursorPos({at.x, at.y + ImGui::GetTextLineHeight()});
        ImGui::TextColored(colours::dim_text, "%s", tell(value_of(name)));
        ImGui::SetCursorPos(after);
        ImGui::PopID();
    }
    ImGui::EndCombo();
    return chosen;
}

// The number with the shortest decimals that are this float: 0.01, not 0.00999999978.
double as_typed(float value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    double number = 0;
    std::from_chars(text.data(), end, number);
    return std::isfinite(number) ? number : 0;
}

// A number that is typed. While it is typed, the field has it; it counts when the field is left.
// \return true when it has changed.
bool type_number(const char* label, double& value, double least) {
    ImGuiStorage& storage = *ImGui::GetStateStorage();
    const ImGuiID typed = ImGui::GetID((std::string(label) + " typed").c_str());
    const ImGuiID typing = ImGui::GetID((std::string(label) + " typing").c_str());
    auto shown = storage.GetBool(typing) ? storage.GetFloat(typed) : static_cast<float>(value);
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5);
    ImGui::InputFloat(label, &shown, 0, 0, "%g");
    storage.SetBool(typing, ImGui::IsItemActive());
    storage.SetFloat(typed, shown);
    if (!ImGui::IsItemDeactivatedAfterEdit()) return false;
    const double number = std::max(least, as_typed(shown));
    if (number == value) return false;
    value = number;
    return true;
}

void draw_arap_options(Editor& editor, MethodOptions options) {
    static const std::vector<std::string> names{arap_energy_name(ArapEnergy::elements),
                                                arap_energy_name(ArapEnergy::spokes),
                                                arap_energy_name(ArapEnergy::spokes_and_rims)};
    std::string now = arap_energy_name(options.arap_energy);
    const auto tell = [](ArapEnergy energy) { return about(energy); };
    if (!choose("##energy", names, now, &arap_energy_from_name, tell)) return;
    options.arap_energy = arap_energy_from_name(now);
    editor.set_method_options("Choose energy", options);
}

// Below a hundredth of a pixel nothing bends that a picture could show.
constexpr double least_bending_length_px = 0.01;

void draw_smooth_arap_options(Editor& editor, MethodOptions options) {
    bool own = options.bending_length_px.has_value();
    ImGui::BeginDisabled(!editor.shape() || !editor.shape()->mesh);
    const bool switched = ImGui::Checkbox("Choose bending length", &own);
    ImGui::EndDisabled();
    if (switched) {
        options.bending_length_px.reset();
        if (own) options.bending_length_px = std::round(10 * usual_bending_length_px(*editor.shape()->mesh)) / 10;
        editor.set_method_options("Choose bending length", options);
        return;
    }
    if (own && type_number("px bend together", *options.bending_length_px, least_bending_length_px))
        editor.set_method_options("Change bending length", options);
}

void draw_thin_shell_options(Editor& editor, MethodOptions options) {
    if (type_number("stretching", options.stretching, 0)) editor.set_method_options("Change stretching", options);
    if (type_number("bending", options.bending, 0)) editor.set_method_options("Change bending", options);
}

}  // namespace

void draw_method_panel(Editor& editor) {
    const MethodOptions& options = editor.puppet().method;
    std::string now = method_name(options.method);
    const auto tell = [](Method method) { return about(method); };
    if (choose("##method", method_names(), now, &method_from_name, tell)) editor.set_method(method_from_name(now));
    dim_line(about(options.method));
    switch (options.method) {
        case Method::arap: draw_arap_options(editor, options); break;
        case Method::smooth_arap: draw_smooth_arap_options(editor, options); break;
        case Method::thin_shell: draw_thin_shell_options(editor, options); break;
        default: break;
    }
}

}  // namespace puppetwarp::ui
