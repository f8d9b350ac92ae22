#include "view/panels.h"

#include "view/method_panel.h"

#include <imgui.h>

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace puppetwarp::ui {

namespace {

constexpr ImGuiWindowFlags fixed_window = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;

void begin_fixed(const char* name, ImVec2 min, ImVec2 max, ImVec2 padding, ImGuiWindowFlags flags = 0) {
    ImGui::SetNextWindowPos(min);
    ImGui::SetNextWindowSize({max.x - min.x, max.y - min.y});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin(name, nullptr, fixed_window | flags);
    ImGui::PopStyleVar(4);
}

void line_between(ImVec2 a, ImVec2 b) {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    draw.PushClipRectFullScreen();
    draw.AddLine(a, b, ImGui::GetColorU32(colours::line));
    draw.PopClipRect();
}

void draw_menu(const ActionTable& actions) {
    using Menu = std::pair<const char*, std::vector<const char*>>;
    static const std::array<Menu, 4> menus{{
        {"File", {"open", "", "save", "save-as", "export", "", "quit"}},
        {"Edit", {"undo", "redo", "", "remove", "reset-pose"}},
        {"View", {"fit", "one-to-one", "zoom-in", "zoom-out", "", "mesh", "pins"}},
        {"Help", {"help"}},
    }};
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    const bool shown = ImGui::BeginMainMenuBar();
    ImGui::PopStyleVar();
    if (!shown) return;
    for (const auto& [name, items] : menus) {
        if (!ImGui::BeginMenu(name)) continue;
        for (const std::string id : items) {
            if (id.empty()) {
                ImGui::Separator();
            } else {
                menu_item(actions.find(id));
            }
        }
        ImGui::EndMenu();
    }
    ImGui::EndMainMenuBar();
}

void draw_toolbar(const ActionTable& actions) {
    bool first = true;
    for (const std::string id : {"open", "save", "export", "", "undo", "redo", "", "remove", "", "fit", "one-to-one",
                                 "", "mesh", "pins", "", "help"}) {
        if (!first) ImGui::SameLine();
        first = false;
        if (id.empty()) {
            const ImVec2 at = ImGui::GetCursorScreenPos();
            const float height = ImGui::GetFrameHeight();
            line_between({at.x, at.y + height * 0.2f}, {at.x, at.y + height * 0.8f});
            ImGui::Dummy({1, height});
        } else {
            tool_button(actions.find(id));
        }
    }
}

void heading(const char* text) {
    ImGui::Dummy({0, 4});
    ImGui::TextColored(colours::dim_text, "%s", text);
}

void draw_pose(Editor& editor, const ActionTable& actions) {
    heading("POSE");
    const std::string now = editor.pose_name();
    ImGui::SetNextItemWidth(-1);
    if (ImGui::BeginCombo("##pose", now.c_str())) {
        for (const Pose& pose : editor.puppet().poses)
            if (ImGui::Selectable(pose.name.c_str(), pose.name == now)) editor.choose_pose(pose.name);
        ImGui::EndCombo();
    }
    const Action& reset = actions.find("reset-pose");
    ImGui::BeginDisabled(!reset.enabled());
    if (ImGui::Button(reset.brief.c_str(), {-1, 0})) reset.run();
    ImGui::EndDisabled();
}

// One line of the list. \return true when the pin shall go.
bool draw_pin_row(Editor& editor, const Pin& pin, float scale) {
    ImGui::PushID(pin.id.c_str());
    const float height = ImGui::GetFrameHeight();
    const bool selected = pin.id == editor.tool().selected();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    if (ImGui::Selectable("##pin", selected, ImGuiSelectableFlags_AllowItemOverlap, {0, height}))
        editor.tool().select(pin.id);
    ImGui::SetItemAllowOverlap();
    const bool hovered = ImGui::IsItemHovered();
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const float middle = at.y + height / 2;
    draw.AddCircleFilled({at.x + 10 * scale, middle}, 4.5f * scale,
                         ImGui::GetColorU32(selected ? colours::accent : colours::pin), 24);
    const float text_y = middle - ImGui::GetFontSize() / 2;
    draw.AddText({at.x + 24 * scale, text_y}, ImGui::GetColorU32(colours::text), pin.id.c_str());
    bool remove = false;
    if (hovered || selected) {
        ImGui::SameLine(width - height);
        ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
        remove = ImGui::Button("×", {height, height});
        ImGui::PopStyleColor();
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("Remove this pin   Del");
    } else if (pin.to != pin.at) {
        char text[48];
        std::snprintf(text, sizeof text, "%+.0f, %+.0f px", pin.to.x() - pin.at.x(), pin.to.y() - pin.at.y());
        draw.AddText({at.x + width - ImGui::CalcTextSize(text).x - 8 * scale, text_y},
                     ImGui::GetColorU32(colours::dim_text), text);
    }
    ImGui::PopID();
    return remove;
}

void draw_pin_list(Editor& editor, float scale) {
    const std::vector<Pin> list = pins(editor.puppet(), editor.pose());
    heading(list.empty() ? "PINS" : ("PINS  " + std::to_string(list.size())).c_str());
    if (list.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, colours::dim_text);
        ImGui::TextWrapped("None yet. Click on the picture.");
        ImGui::PopStyleColor();
    }
    std::string gone;
    ImGui::BeginChild("pins");
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(8 * scale, 2 * scale));
    for (const Pin& pin : list)
        if (draw_pin_row(editor, pin, scale)) gone = pin.id;
    const std::size_t others = editor.puppet().rig.handles.size() - list.size();
    if (others > 0) ImGui::TextDisabled("and %zu handles of other kinds", others);
    ImGui::PopStyleVar();
    ImGui::EndChild();
    if (!gone.empty()) editor.remove_pin(gone);
}

void draw_side(Editor& editor, const ActionTable& actions, float scale) {
    ImGui::BeginDisabled(!editor.can_edit() && !editor.tool().dragging());
    const auto& shape = editor.shape();
    ImGui::TextColored(colours::dim_text, "PICTURE");
    if (editor.has_document() && shape) {
        ImGui::TextUnformatted(editor.document_name().c_str());
        ImGui::TextDisabled("%d × %d px", shape->subject->image.width(), shape->subject->image.height());
    } else {
        ImGui::TextDisabled("Nothing is open");
    }
    heading("METHOD");
    draw_method_panel(editor);
    draw_pose(editor, actions);
    draw_pin_list(editor, scale);
    ImGui::EndDisabled();
}

// What a person who sees this for the first time could do next; empty: they know.
const char* hint(const Editor& editor) {
    if (!editor.has_document() || !editor.shape() || !editor.shape()->mesh) return "";
    const std::vector<Pin> list = pins(editor.puppet(), editor.pose());
    if (list.empty()) return "Click on the picture to set a pin";
    if (editor.tool().dragging()) return "Let go to keep it, Esc to put it back";
    for (const Pin& pin : list)
        if (pin.to != pin.at) return "";
    return list.size() == 1 ? "Set more pins: one to pull, others to hold" : "Drag a pin to warp the picture";
}

std::string joined(const std::vector<std::string>& phrases) {
    std::string text;
    for (const std::string& phrase : phrases) text += (text.empty() ? "" : "; ") + phrase;
    return text;
}

void draw_message(const Editor& editor) {
    const Message& message = editor.message();
    std::string trouble = editor.shape() ? editor.shape()->error : message.text;
    if (message.kind == Message::Kind::error) {
        ImGui::TextColored(colours::error, "⚠  %s", message.text.c_str());
    } else if (editor.exporting()) {
        ImGui::Text("%s  %.0f %%", message.text.c_str(), editor.export_fraction() * 100);
    } else if (editor.shape() && !trouble.empty()) {
        ImGui::TextColored(colours::error, "⚠  %s", trouble.c_str());
    } else if (message.kind == Message::Kind::info) {
        ImGui::TextUnformatted(message.text.c_str());
    } else if (editor.shape() && !editor.shape()->warnings.empty() && !editor.tool().dragging()) {
        trouble = joined(editor.shape()->warnings);
        ImGui::TextColored(colours::warning, "⚠  %s", trouble.c_str());
    } else {
        const bool waits = !editor.settled() && !editor.tool().dragging();
        ImGui::TextDisabled("%s", !editor.has_document() ? "" : waits ? "Working…" : "Ready");
    }
    const bool cut_off = ImGui::GetItemRectMax().x > ImGui::GetIO().DisplaySize.x;
    if (cut_off && ImGui::IsItemHovered()) {
        const bool own = message.kind == Message::Kind::error;
        ImGui::SetTooltip("%s", (own ? message.text : trouble).c_str());
    }
}

void draw_figures(const Editor& editor, const Canvas& canvas) {
    const auto& shape = editor.shape();
    if (!shape || !shape->mesh) return;
    char text[200];
    const double zoom = canvas.view().scale() * 100;
    if (editor.puppet().rig.handles.empty()) {
        std::snprintf(text, sizeof text, "%td vertices   %td triangles   %.0f %%", shape->mesh->V.rows(),
                      shape->mesh->F.rows(), zoom);
    } else {
        std::snprintf(text, sizeof text, "%td vertices   %td triangles   stretch %.2f   %.1f ms   %.0f %%",
                      shape->mesh->V.rows(), shape->mesh->F.rows(), shape->distortion.max_stretch, shape->deform_ms,
                      zoom);
    }
    char flips[64] = "";
    const int flipped = shape->distortion.flipped_triangles;
    if (flipped > 0) std::snprintf(flips, sizeof flips, "%d flipped   ", flipped);
    const float start = ImGui::GetWindowWidth() - ImGui::CalcTextSize(text).x - ImGui::CalcTextSize(flips).x - 24;
    // A long message is worth more than the figures.
    if (ImGui::GetItemRectMax().x > start - 16) return;
    ImGui::SameLine(start);
    if (flipped > 0) {
        ImGui::TextColored(colours::warning, "%s", flips);
        ImGui::SameLine(0, 0);
    }
    ImGui::TextDisabled("%s", text);
}

void draw_pill(const char* text, const ScreenRect& viewport, float scale) {
    const ImVec2 size = ImGui::CalcTextSize(text);
    const ImVec2 padding{16 * scale, 8 * scale};
    const ImVec2 at{static_cast<float>(viewport.centre().x()) - size.x / 2,
                    static_cast<float>(viewport.min.y() + viewport.size.y()) - size.y - 28 * scale};
    const ImVec2 a{at.x - padding.x, at.y - padding.y};
    const ImVec2 b{at.x + size.x + padding.x, at.y + size.y + padding.y};
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    draw.AddRectFilled(a, b, IM_COL32(18, 19, 22, 225), 20 * scale);
    draw.AddRect(a, b, ImGui::GetColorU32(colours::line), 20 * scale);
    draw.AddText(at, ImGui::GetColorU32(colours::text), text);
}

void draw_welcome(const Editor& editor, const ActionTable& actions, const Fonts& fonts, float scale) {
    const auto centred = [](const char* text) {
        ImGui::SetCursorPosX((ImGui::GetWindowWidth() - ImGui::CalcTextSize(text).x) / 2);
    };
    ImGui::SetCursorPosY(ImGui::GetWindowHeight() / 2 - 70 * scale);
    if (editor.opening()) {
        centred("Opening…");
        ImGui::TextDisabled("Opening…");
        return;
    }
    ImGui::PushFont(fonts.title);
    centred("Drop a picture here");
    ImGui::TextUnformatted("Drop a picture here");
    ImGui::PopFont();
    constexpr const char* more = "or a puppet file. Then set pins and drag them.";
    centred(more);
    ImGui::TextDisabled("%s", more);
    ImGui::Dummy({0, 10 * scale});
    const float width = 150 * scale;
    ImGui::SetCursorPosX((ImGui::GetWindowWidth() - width) / 2);
    ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_HeaderActive));
    if (ImGui::Button("Open…", {width, 36 * scale})) actions.find("open").run();
    ImGui::PopStyleColor();
}

}  // namespace

ScreenRect draw_panels(Editor& editor, Canvas& canvas, const ActionTable& actions, const Fonts&, float scale) {
    draw_menu(actions);
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float menu = ImGui::GetFrameHeight();
    const float tools = menu + ImGui::GetFrameHeight() + 14 * scale;
    const float status = screen.y - ImGui::GetTextLineHeight() - 14 * scale;
    const float side = screen.x - 268 * scale;

    begin_fixed("toolbar", {0, menu}, {screen.x, tools}, {10 * scale, 7 * scale});
    draw_toolbar(actions);
    line_between({0, tools - 1}, {screen.x, tools - 1});
    ImGui::End();

    begin_fixed("side", {side, tools}, {screen.x, status}, {16 * scale, 14 * scale});
    line_between({side, tools}, {side, status});
    draw_side(editor, actions, scale);
    ImGui::End();

    begin_fixed("status", {0, status}, screen, {14 * scale, 6 * scale});
    line_between({0, status}, {screen.x, status});
    draw_message(editor);
    draw_figures(editor, canvas);
    ImGui::End();
    return {{0, tools}, {side, status - tools}};
}

void draw_canvas_window(Editor& editor, Canvas& canvas, const ActionTable& actions, const Fonts& fonts, float scale) {
    const ScreenRect& viewport = canvas.viewport();
    const ImVec2 min{static_cast<float>(viewport.min.x()), static_cast<float>(viewport.min.y())};
    const ImVec2 max{min.x + static_cast<float>(viewport.size.x()), min.y + static_cast<float>(viewport.size.y())};
    const bool empty = !editor.has_document();
    begin_fixed("canvas", min, max, {0, 0},
                ImGuiWindowFlags_NoBackground | (empty ? 0 : ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoNav));
    if (empty) {
        draw_welcome(editor, actions, fonts, scale);
    } else {
        canvas.draw(*ImGui::GetWindowDrawList(), scale);
        const char* text = editor.opening() ? "Opening…" : hint(editor);
        if (*text) draw_pill(text, viewport, scale);
    }
    ImGui::End();
}

void draw_help(const ActionTable& actions, const Fonts& fonts, float scale, bool& open) {
    static constexpr std::array<std::array<const char*, 2>, 7> pointer{{
        {"Click on the picture", "set a pin"},
        {"Drag a pin", "warp the picture; Esc puts it back"},
        {"Right click on a pin", "its menu"},
        {"Wheel", "zoom at the pointer"},
        {"Middle drag, Space + drag", "move the view"},
        {"Drop a file on the window", "open it"},
        {"Esc", "let go of the pin"},
    }};
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowFocus();
    ImGui::Begin("##help", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoMove);
    ImGui::PushFont(fonts.title);
    ImGui::TextUnformatted("How it works");
    ImGui::PopFont();
    ImGui::Dummy({0, 4 * scale});
    if (ImGui::BeginTable("pointer", 2)) {
        ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 230 * scale);
        for (const auto& [what, does] : pointer) {
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(what);
            ImGui::TableNextColumn();
            ImGui::TextDisabled("%s", does);
        }
        for (int column = 0; column < 2; ++column) {
            ImGui::TableNextColumn();
            ImGui::Dummy({0, 6 * scale});
        }
        for (const Action& action : actions.all()) {
            if (action.shortcuts.empty()) continue;
            std::string keys;
            for (const Shortcut& shortcut : action.shortcuts) keys += (keys.empty() ? "" : ", ") + readable(shortcut);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(keys.c_str());
            ImGui::TableNextColumn();
            ImGui::TextDisabled("%s", action.name.c_str());
        }
        ImGui::EndTable();
    }
    ImGui::Dummy({0, 4 * scale});
    if (ImGui::Button("Close", {-1, 0})) open = false;
    ImGui::End();
}

}  // namespace puppetwarp::ui
