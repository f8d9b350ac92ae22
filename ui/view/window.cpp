#include "view/window.h"

#include <puppetwarp/base/errors.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

namespace puppetwarp::ui {

namespace {

// GLFW tells by a callback without user data; the last thing it said.
std::string& last_glfw_error() {
    static std::string text;
    return text;
}

Modifiers modifiers_from_glfw(int mods) {
    return {(mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_ALT) != 0};
}

int glfw_from_modifiers(const Modifiers& modifiers) {
    return (modifiers.shift ? GLFW_MOD_SHIFT : 0) | (modifiers.control ? GLFW_MOD_CONTROL : 0) |
           (modifiers.alt ? GLFW_MOD_ALT : 0);
}

// GLFW names keys by their place on a US keyboard; people by what is printed on theirs.
int key_as_printed(int key, int scancode) {
    const char* name = glfwGetKeyName(key, scancode);
    if (name && name[1] == '\0' && name[0] >= 'a' && name[0] <= 'z') return name[0] - 'a' + GLFW_KEY_A;
    return key == GLFW_KEY_KP_ADD ? GLFW_KEY_EQUAL : key == GLFW_KEY_KP_SUBTRACT ? GLFW_KEY_MINUS : key;
}

Window& window_of(GLFWwindow* handle) {
    return *static_cast<Window*>(glfwGetWindowUserPointer(handle));
}

}  // namespace

Window::Window() {
    glfwSetErrorCallback([](int, const char* text) { last_glfw_error() = text; });
    if (!glfwInit())
        throw MachineFault("display", "cannot be opened: " + last_glfw_error(), "start it from a graphical session");
    try {
        make_window();
    } catch (...) {
        glfwTerminate();
        throw;
    }
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    fonts_ = apply_theme(content_scale_);
    install_callbacks();
    ImGui_ImplGlfw_InitForOpenGL(window_, false);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::make_window() {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "puppetwarp");
    window_ = glfwCreateWindow(1280, 800, "puppetwarp", nullptr, nullptr);
    if (!window_) throw MachineFault("OpenGL 3.3", "is not there: " + last_glfw_error(), "update the graphics driver");
    glfwSetWindowUserPointer(window_, this);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    float y_scale = 1;
    glfwGetWindowContentScale(window_, &content_scale_, &y_scale);
}

InputEvent Window::event_here(InputEvent::Kind kind) const {
    InputEvent event;
    event.kind = kind;
    event.screen = pointer_;
    event.modifiers = modifiers_;
    return event;
}

void Window::install_callbacks() {
    using Kind = InputEvent::Kind;
    glfwSetCursorPosCallback(window_, [](GLFWwindow* handle, double x, double y) {
        Window& w = window_of(handle);
        w.pointer_ = {x, y};
        w.events_.push(w.event_here(Kind::move));
    });
    glfwSetCursorEnterCallback(window_, [](GLFWwindow* handle, int entered) {
        Window& w = window_of(handle);
        const bool held = std::find(w.buttons_.begin(), w.buttons_.end(), true) != w.buttons_.end();
        if (entered || held) return;
        w.pointer_ = {-1e6, -1e6};
        w.events_.push(w.event_here(Kind::move));
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* handle, int button, int action, int mods) {
        Window& w = window_of(handle);
        if (button >= static_cast<int>(w.buttons_.size())) return;
        w.modifiers_ = modifiers_from_glfw(mods);
        w.buttons_[static_cast<std::size_t>(button)] = action == GLFW_PRESS;
        InputEvent event = w.event_here(action == GLFW_PRESS ? Kind::press : Kind::release);
        event.code = button;
        w.events_.push(std::move(event));
    });
    glfwSetScrollCallback(window_, [](GLFWwindow* handle, double x, double y) {
        Window& w = window_of(handle);
        InputEvent event = w.event_here(Kind::scroll);
        event.scroll = {x, y};
        w.events_.push(std::move(event));
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* handle, int key, int scancode, int action, int mods) {
        Window& w = window_of(handle);
        w.modifiers_ = modifiers_from_glfw(mods);
        InputEvent event = w.event_here(action == GLFW_PRESS     ? Kind::key_press
                                        : action == GLFW_RELEASE ? Kind::key_release
                                                                 : Kind::key_repeat);
        event.code = key_as_printed(key, scancode);
        event.scancode = scancode;
        w.events_.push(std::move(event));
    });
    glfwSetCharCallback(window_, [](GLFWwindow* handle, unsigned character) {
        Window& w = window_of(handle);
        InputEvent event = w.event_here(Kind::text);
        event.code = static_cast<int>(character);
        w.events_.push(std::move(event));
    });
    glfwSetDropCallback(window_, [](GLFWwindow* handle, int count, const char** paths) {
        Window& w = window_of(handle);
        InputEvent event = w.event_here(Kind::drop);
        event.paths.assign(paths, paths + count);
        w.events_.push(std::move(event));
    });
    glfwSetWindowFocusCallback(window_, ImGui_ImplGlfw_WindowFocusCallback);
}

void Window::wait(bool patient) {
    if (patient) {
        glfwWaitEventsTimeout(0.5);
    } else {
        glfwPollEvents();
    }
}

void Window::wake() {
    glfwPostEmptyEvent();
}

void Window::begin_frame(const std::vector<InputEvent>& events) {
    using Kind = InputEvent::Kind;
    for (const InputEvent& event : events) {
        const int mods = glfw_from_modifiers(event.modifiers);
        gui_pointer_ = event.screen;
        switch (event.kind) {
            case Kind::press:
            case Kind::release: gui_buttons_[static_cast<std::size_t>(event.code)] = event.kind == Kind::press; break;
            case Kind::scroll: ImGui_ImplGlfw_ScrollCallback(window_, event.scroll.x(), event.scroll.y()); break;
            case Kind::key_press:
                ImGui_ImplGlfw_KeyCallback(window_, event.code, event.scancode, GLFW_PRESS, mods);
                break;
            case Kind::key_release:
                ImGui_ImplGlfw_KeyCallback(window_, event.code, event.scancode, GLFW_RELEASE, mods);
                break;
            case Kind::text: ImGui_ImplGlfw_CharCallback(window_, static_cast<unsigned>(event.code)); break;
            case Kind::move:
            case Kind::key_repeat:
            case Kind::drop: break;
        }
    }
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    // The backend has asked where the pointer is now; what counts is where it was then.
    ImGuiIO& io = ImGui::GetIO();
    const bool outside = gui_pointer_.x() < -1e5;
    io.MousePos = outside ? ImVec2(-FLT_MAX, -FLT_MAX)
                          : ImVec2(static_cast<float>(gui_pointer_.x()), static_cast<float>(gui_pointer_.y()));
    for (std::size_t button = 0; button < gui_buttons_.size(); ++button) io.MouseDown[button] = gui_buttons_[button];
    ImGui::NewFrame();
}

void Window::draw_gui() {
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::show() {
    glfwSwapBuffers(window_);
}

bool Window::close_requested() {
    const bool requested = glfwWindowShouldClose(window_);
    glfwSetWindowShouldClose(window_, GLFW_FALSE);
    return requested;
}

void Window::set_title(const std::string& title) {
    if (title == title_) return;
    title_ = title;
    glfwSetWindowTitle(window_, title.c_str());
}

Point Window::size() const {
    int width = 0;
    int height = 0;
    glfwGetWindowSize(window_, &width, &height);
    return {std::max(width, 1), std::max(height, 1)};
}

Point Window::framebuffer_size() const {
    int width = 0;
    int height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return {width, height};
}

}  // namespace puppetwarp::ui
