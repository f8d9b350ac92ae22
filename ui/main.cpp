#include "gl/picture_renderer.h"
#include "view/app.h"
#include "view/test_log.h"
#include "view/window.h"

#include <puppetwarp/base/errors.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdio>
#include <exception>
#include <string>

namespace {

using namespace puppetwarp;
using namespace puppetwarp::ui;

constexpr const char* usage = R"(Usage: puppetwarp-ui [IMAGE|PUPPET]

The editor of puppetwarp: set pins on a picture, drag them, save the puppet file, export the warped picture.

  IMAGE       a picture to begin with
  PUPPET      a puppet file, NAME.puppet.json, to go on with
  -h, --help  show this and end
  --version   show the version and end

Example:  puppetwarp-ui photo.jpg
)";

void draw_picture(const Window& window, const App& app, PictureRenderer& renderer) {
    const Point pixels = window.framebuffer_size();
    const Point size = window.size();
    glViewport(0, 0, static_cast<GLsizei>(pixels.x()), static_cast<GLsizei>(pixels.y()));
    glClearColor(colours::canvas.x, colours::canvas.y, colours::canvas.z, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    if (app.editor().has_document())
        renderer.draw(app.canvas().frame(size, pixels.x() / size.x()), app.editor().shape());
}

// Draws until the window closes. ImGui needs a frame or two after an event to come to rest.
void run(Window& window, App& app, PictureRenderer& renderer, TestLog& log) {
    constexpr int frames_to_rest = 3;
    int restless = frames_to_rest;
    while (!app.closed()) {
        window.wait(restless == 0 && !app.editor().exporting());
        restless = window.events().empty() ? restless - 1 : frames_to_rest;
        if (restless < 0) restless = frames_to_rest;
        // Of several frames that wait only the last one is drawn; each hears its own events.
        do {
            const std::vector<InputEvent> events = window.events().take_frame();
            for (const InputEvent& event : events)
                if (event.kind == InputEvent::Kind::key_press && event.code == GLFW_KEY_F12) log.ask_for_screenshot();
            window.begin_frame(events);
            app.handle(events);
            app.draw();
            if (window.close_requested()) app.request_close();
            ImGui::Render();
        } while (!window.events().empty());
        window.set_title(app.title());
        draw_picture(window, app, renderer);
        window.draw_gui();
        const Point pixels = window.framebuffer_size();
        log.after_frame(app, static_cast<int>(pixels.x()), static_cast<int>(pixels.y()));
        window.show();
    }
}

int edit(const char* path) {
    Window window;
    PictureRenderer renderer;
    TestLog log;
    App app(longest_texture_side(), window.content_scale(), window.fonts(), &Window::wake);
    if (path) app.open(path);
    run(window, app, renderer, log);
    return 0;
}

int complain(const std::string& text, int code) {
    std::fprintf(stderr, "puppetwarp-ui: %s\n", text.c_str());
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string first = argc > 1 ? argv[1] : "";
    try {
        if (first == "--help" || first == "-h") {
            std::fputs(usage, stdout);
            return 0;
        }
        if (first == "--version") {
            std::puts("puppetwarp-ui " PUPPETWARP_VERSION);
            return 0;
        }
        if (argc > 2) return complain(std::string(argv[2]) + ": one file at a time (see --help)", 2);
        if (first.starts_with("-")) return complain(first + ": unknown option (see --help)", 2);
        return edit(argc > 1 ? argv[1] : nullptr);
    } catch (const InvalidInput& error) {
        return complain(error.what(), 2);
    } catch (const std::exception& error) {
        return complain(error.what(), 3);
    }
}
