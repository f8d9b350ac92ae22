#include "view/theme.h"

#include <filesystem>

namespace puppetwarp::ui {

namespace {

ImVec4 with_alpha(ImVec4 colour, float alpha) {
    colour.w = alpha;
    return colour;
}

ImFont* load_font(float size_px) {
    // Debian's fonts-dejavu-core; the font inside ImGui knows Latin-1 only and does not scale.
    static constexpr const char* path = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    static constexpr ImWchar ranges[] = {0x0020, 0x024F,  // Latin
                                         0x0370, 0x052F,  // Greek, Cyrillic
                                         0x2000, 0x206F,  // punctuation
                                         0x2190, 0x21FF,  // arrows
                                         0x2200, 0x22FF,  // mathematics
                                         0x25A0, 0x26FF,  // shapes and symbols
                                         0};
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) {
        ImFontConfig config;
        config.OversampleH = 2;
        config.PixelSnapH = true;
        if (ImFont* font = atlas.AddFontFromFileTTF(path, size_px, &config, ranges)) return font;
    }
    ImFontConfig config;
    config.SizePixels = size_px;
    return atlas.AddFontDefault(&config);
}

void set_spacing(ImGuiStyle& style) {
    style.WindowPadding = {14, 12};
    style.FramePadding = {10, 6};
    style.ItemSpacing = {8, 7};
    style.ItemInnerSpacing = {7, 5};
    style.IndentSpacing = 16;
    style.ScrollbarSize = 12;
    style.GrabMinSize = 12;
    style.WindowRounding = 8;
    style.ChildRounding = 6;
    style.FrameRounding = 5;
    style.PopupRounding = 6;
    style.ScrollbarRounding = 6;
    style.GrabRounding = 5;
    style.WindowBorderSize = 1;
    style.FrameBorderSize = 0;
    style.PopupBorderSize = 1;
    style.WindowTitleAlign = {0.5f, 0.5f};
    style.SelectableTextAlign = {0, 0.5f};
}

void set_colours(ImGuiStyle& style) {
    const ImVec4 field{0.200f, 0.208f, 0.231f, 1};
    const ImVec4 field_hovered{0.251f, 0.263f, 0.290f, 1};
    const ImVec4 field_active{0.294f, 0.310f, 0.345f, 1};
    const ImVec4 popup{0.173f, 0.180f, 0.200f, 1};
    ImVec4* c = style.Colors;
    c[ImGuiCol_Text] = colours::text;
    c[ImGuiCol_TextDisabled] = colours::dim_text;
    c[ImGuiCol_WindowBg] = colours::panel;
    c[ImGuiCol_ChildBg] = {0, 0, 0, 0};
    c[ImGuiCol_PopupBg] = popup;
    c[ImGuiCol_Border] = colours::line;
    c[ImGuiCol_BorderShadow] = {0, 0, 0, 0};
    c[ImGuiCol_FrameBg] = field;
    c[ImGuiCol_FrameBgHovered] = field_hovered;
    c[ImGuiCol_FrameBgActive] = field_active;
    c[ImGuiCol_TitleBg] = popup;
    c[ImGuiCol_TitleBgActive] = popup;
    c[ImGuiCol_TitleBgCollapsed] = popup;
    c[ImGuiCol_MenuBarBg] = colours::panel;
    c[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0};
    c[ImGuiCol_ScrollbarGrab] = field_active;
    c[ImGuiCol_ScrollbarGrabHovered] = {0.37f, 0.39f, 0.43f, 1};
    c[ImGuiCol_ScrollbarGrabActive] = {0.45f, 0.47f, 0.51f, 1};
    c[ImGuiCol_CheckMark] = colours::accent;
    c[ImGuiCol_SliderGrab] = colours::accent;
    c[ImGuiCol_SliderGrabActive] = colours::accent;
    c[ImGuiCol_Button] = field;
    c[ImGuiCol_ButtonHovered] = field_hovered;
    c[ImGuiCol_ButtonActive] = field_active;
    c[ImGuiCol_Header] = with_alpha(colours::accent, 0.28f);
    c[ImGuiCol_HeaderHovered] = with_alpha(colours::accent, 0.20f);
    c[ImGuiCol_HeaderActive] = with_alpha(colours::accent, 0.40f);
    c[ImGuiCol_Separator] = colours::line;
    c[ImGuiCol_SeparatorHovered] = colours::line;
    c[ImGuiCol_SeparatorActive] = colours::line;
    c[ImGuiCol_TextSelectedBg] = with_alpha(colours::accent, 0.40f);
    c[ImGuiCol_NavHighlight] = with_alpha(colours::accent, 0.80f);
    c[ImGuiCol_ModalWindowDimBg] = {0.04f, 0.04f, 0.05f, 0.55f};
    c[ImGuiCol_TableRowBgAlt] = {1, 1, 1, 0.02f};
}

}  // namespace

Fonts apply_theme(float scale) {
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    set_spacing(style);
    set_colours(style);
    style.ScaleAllSizes(scale);
    style.WindowBorderSize = style.PopupBorderSize = 1;
    return {load_font(15 * scale), load_font(21 * scale)};
}

}  // namespace puppetwarp::ui
