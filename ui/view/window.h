#pragma once

#include "model/input_events.h"
#include "view/theme.h"

#include <puppetwarp/base/point.h>

#include <memory>
#include <string>
#include <vector>

struct GLFWwindow;

namespace puppetwarp::ui {

//! The window on the screen with its OpenGL context, Dear ImGui, and what comes in from mouse and keyboard.
class Window {
public:
    //! \throw MachineFault  no display, or no OpenGL 3.3.
    Window();
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    //! Waits until something happens or a moment has passed. \param patient  false: looks only.
    void wait(bool patient);
    //! Ends a `wait`; from any thread.
    static void wake();

    EventQueue& events() { return events_; }
    //! Tells ImGui what happened and begins its frame.
    void begin_frame(const std::vector<InputEvent>& events);
    //! Draws ImGui's frame over what is there. \pre `ImGui::Render` was called.
    void draw_gui();
    void show();

    bool close_requested();
    void set_title(const std::string& title);
    Point size() const;              //!< window coordinates
    Point framebuffer_size() const;  //!< pixels
    float content_scale() const { return content_scale_; }
    const Fonts& fonts() const { return fonts_; }

private:
    void make_window();
    void install_callbacks();
    InputEvent event_here(InputEvent::Kind kind) const;

    GLFWwindow* window_ = nullptr;
    float content_scale_ = 1;
    Fonts fonts_;
    EventQueue events_;
    std::string title_;
    Point pointer_{-1e6, -1e6};                                    // as of the last event
    Point gui_pointer_{-1e6, -1e6};                                // as of the events that ImGui has heard of
    std::vector<bool> buttons_ = std::vector<bool>(5, false);      // held, as of the last event
    std::vector<bool> gui_buttons_ = std::vector<bool>(5, false);  // held, as ImGui knows
    Modifiers modifiers_;
};

}  // namespace puppetwarp::ui
