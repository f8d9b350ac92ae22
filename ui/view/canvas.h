#pragma once

#include "gl/picture_renderer.h"
#include "model/editor.h"
#include "model/input_events.h"
#include "model/view_transform.h"

#include <imgui.h>

#include <string>

namespace puppetwarp::ui {

//! The picture with its pins: takes the pointer's events for them and draws them.
class Canvas {
public:
    explicit Canvas(Editor& editor) : editor_(editor) {}

    //! Where the canvas is; what was in its middle stays there.
    void set_viewport(const ScreenRect& viewport);
    const ScreenRect& viewport() const { return viewport_; }
    const ViewTransform& view() const { return view_; }

    void fit();
    void one_to_one() { view_.set_scale(1, viewport_); }
    void zoom(double factor) { view_.zoom_about(viewport_.centre(), factor); }

    //! \param blocked  something lies over the canvas: only what has begun may end.
    void handle(const InputEvent& event, bool blocked);
    //! Pins, the picture's frame and the pointer's shape. \pre within an ImGui window over the viewport
    void draw(ImDrawList& draw, float scale);
    //! What the renderer shall draw below.
    PictureRenderer::Frame frame(const Point& window_size, double pixels_per_point) const;

    bool show_mesh = false;
    bool show_pins = true;

private:
    void press(const InputEvent& event);
    void draw_outside(ImDrawList& draw) const;
    void draw_pins(ImDrawList& draw, float scale) const;
    void draw_context_menu();
    double image_px_per_point() const { return view_.image_length_from_screen(1); }

    Editor& editor_;
    ViewTransform view_;
    ScreenRect viewport_;
    int shown_document_ = 0;
    Point pointer_{-1, -1};
    bool over_ = false;  // the pointer is over the canvas and nothing lies between
    bool space_held_ = false;
    bool panning_ = false;
    std::string hovered_;
    std::string menu_pin_;
    bool open_menu_ = false;
};

}  // namespace puppetwarp::ui
