#include "view/app.h"

#include "view/panels.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <utility>

namespace puppetwarp::ui {

namespace {

namespace fs = std::filesystem;

constexpr Modifiers plain{};
constexpr Modifiers control{.control = true};
constexpr Modifiers control_shift{.shift = true, .control = true};

}  // namespace

App::App(int longest_side_px, float scale, Fonts fonts, std::function<void()> wake)
    : editor_(longest_side_px, std::move(wake)),
      canvas_(editor_),
      scale_(scale),
      fonts_(fonts),
      actions_(make_actions()) {}

std::vector<Action> App::make_actions() {
    const auto always = [] { return true; };
    const auto with_document = [this] { return editor_.has_document() && !editor_.opening(); };
    const auto can_export = [this, with_document] {
        return with_document() && !editor_.exporting() && !editor_.puppet().rig.handles.empty();
    };
    const auto pin_selected = [this, with_document] { return with_document() && !editor_.tool().selected().empty(); };
    return {
        {"open", "Open…", "Open", {{GLFW_KEY_O, control}}, always, [this] { choose_and_open(); }},
        {"save", "Save", "Save", {{GLFW_KEY_S, control}}, with_document, [this] { save([] {}); }},
        {"save-as", "Save as…", "Save as", {{GLFW_KEY_S, control_shift}}, with_document, [this] { save_as([] {}); }},
        {"export", "Export picture…", "Export", {{GLFW_KEY_E, control}}, can_export, [this] { choose_and_export(); }},
        {"quit", "Quit", "Quit", {{GLFW_KEY_Q, control}}, always, [this] { request_close(); }},
        {"undo",
         "Undo",
         "↶ Undo",
         {{GLFW_KEY_Z, control}},
         [this] { return editor_.can_undo(); },
         [this] { editor_.undo(); }},
        {"redo",
         "Redo",
         "↷ Redo",
         {{GLFW_KEY_Z, control_shift}, {GLFW_KEY_Y, control}},
         [this] { return editor_.can_redo(); },
         [this] { editor_.redo(); }},
        {"remove",
         "Remove pin",
         "Remove",
         {{GLFW_KEY_DELETE, plain}, {GLFW_KEY_BACKSPACE, plain}},
         pin_selected,
         [this] { editor_.remove_pin(editor_.tool().selected()); }},
        {"reset-pose",
         "Reset pose",
         "Reset pose",
         {},
         [this] { return editor_.can_edit() && !editor_.pose().handles.empty(); },
         [this] { editor_.clear_pose(); }},
        {"fit",
         "Fit picture",
         "Fit",
         {{GLFW_KEY_F, plain}, {GLFW_KEY_0, control}},
         with_document,
         [this] { canvas_.fit(); }},
        {"one-to-one", "Actual size", "1:1", {{GLFW_KEY_1, control}}, with_document, [this] { canvas_.one_to_one(); }},
        {"zoom-in",
         "Zoom in",
         "+",
         {{GLFW_KEY_EQUAL, plain}, {GLFW_KEY_EQUAL, control}},
         with_document,
         [this] { canvas_.zoom(1.25); }},
        {"zoom-out",
         "Zoom out",
         "-",
         {{GLFW_KEY_MINUS, plain}, {GLFW_KEY_MINUS, control}},
         with_document,
         [this] { canvas_.zoom(0.8); }},
        {"mesh",
         "Show mesh",
         "Mesh",
         {{GLFW_KEY_M, plain}},
         with_document,
         [this] { canvas_.show_mesh = !canvas_.show_mesh; },
         [this] { return canvas_.show_mesh; }},
        {"pins",
         "Show pins",
         "Pins",
         {{GLFW_KEY_P, plain}},
         with_document,
         [this] { canvas_.show_pins = !canvas_.show_pins; },
         [this] { return canvas_.show_pins; }},
        {"help",
         "Help",
         "Help",
         {{GLFW_KEY_F1, plain}},
         always,
         [this] { show_help_ = !show_help_; },
         [this] { return show_help_; }},
    };
}

void App::open(const fs::path& path) {
    with_saved([this, path] { editor_.open(path); });
}

void App::choose_and_open() {
    with_saved([this] {
        FileBrowser::Options options;
        options.title = "Open a picture or a puppet file";
        options.accept = "Open";
        options.folder = editor_.has_document() ? editor_.suggested_puppet_path().parent_path() : fs::path();
        browser_.open(options, [this](const fs::path& path) { editor_.open(path); });
    });
}

void App::choose_and_export() {
    FileBrowser::Options options;
    options.title = "Export the picture";
    options.accept = "Export";
    options.kind = FileKind::pictures;
    options.writes = true;
    options.folder = editor_.suggested_export_path().parent_path();
    options.name = editor_.suggested_export_path().filename().string();
    options.note = "At full size; the extension chooses the format.";
    browser_.open(options, [this](const fs::path& path) { editor_.export_picture(path); });
}

void App::save(std::function<void()> then) {
    if (editor_.file().empty()) {
        save_as(std::move(then));
    } else if (editor_.save_as(editor_.file())) {
        then();
    }
}

void App::save_as(std::function<void()> then) {
    FileBrowser::Options options;
    options.title = "Save the puppet file";
    options.accept = "Save";
    options.kind = FileKind::puppets;
    options.writes = true;
    options.folder = editor_.suggested_puppet_path().parent_path();
    options.name = editor_.suggested_puppet_path().filename().string();
    browser_.open(options, [this, then = std::move(then)](const fs::path& path) {
        if (editor_.save_as(path)) then();
    });
}

void App::with_saved(std::function<void()> then) {
    editor_.cancel();
    if (!editor_.has_document() || !editor_.modified()) {
        then();
        return;
    }
    question_.open(
        editor_.document_name(), [this, then] { save(then); }, then);
}

void App::request_close() {
    if (browser_.is_open() || question_.is_open()) return;
    with_saved([this] { closed_ = true; });
}

std::string App::title() const {
    const std::string name = editor_.document_name();
    if (name.empty()) return "puppetwarp";
    return name + (editor_.modified() ? " • " : " ") + "- puppetwarp";
}

std::string App::dialog() const {
    return question_.is_open() ? "unsaved" : browser_.is_open() ? "browser" : show_help_ ? "help" : "none";
}

void App::handle(const std::vector<InputEvent>& events) {
    const bool blocked = modal() || popup_was_open_;
    for (const InputEvent& event : events) {
        canvas_.handle(event, blocked || (text_was_wanted_ && event.kind == InputEvent::Kind::key_press));
        const bool key = event.kind == InputEvent::Kind::key_press || event.kind == InputEvent::Kind::key_repeat;
        if (key && show_help_ && event.code == GLFW_KEY_ESCAPE) show_help_ = false;
        if (key && !text_was_wanted_ && !browser_.is_open() && !question_.is_open()) actions_.press(event);
        if (event.kind == InputEvent::Kind::drop && !event.paths.empty() && !modal()) open(event.paths.front());
    }
}

void App::draw() {
    editor_.update();
    const ScreenRect viewport = draw_panels(editor_, canvas_, actions_, fonts_, scale_);
    canvas_.set_viewport(viewport);
    draw_canvas_window(editor_, canvas_, actions_, fonts_, scale_);
    if (show_help_) draw_help(actions_, fonts_, scale_, show_help_);
    browser_.draw(scale_);
    question_.draw(scale_);
    popup_was_open_ = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    text_was_wanted_ = ImGui::GetIO().WantTextInput;
}

}  // namespace puppetwarp::ui
