#include "view/canvas.h"

#include "view/theme.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/background.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

namespace puppetwarp::ui {

namespace {

ImVec2 im(const Point& point) {
    return {static_cast<float>(point.x()), static_cast<float>(point.y())};
}

ImU32 colour(ImVec4 c, float alpha = 1) {
    c.w *= alpha;
    return ImGui::ColorConvertFloat4ToU32(c);
}

void draw_pin(ImDrawList& draw, ImVec2 at, bool hovered, bool selected, float scale) {
    const float radius = (hovered ? 7.5f : 6.5f) * scale;
    draw.AddCircleFilled({at.x, at.y + scale}, radius + 2.5f * scale, colour({0, 0, 0, 0.35f}), 40);
    if (selected) draw.AddCircle(at, radius + 4 * scale, colour(colours::accent), 40, 2 * scale);
    draw.AddCircleFilled(at, radius + 1.5f * scale, colour({1, 1, 1, 1}), 40);
    draw.AddCircleFilled(at, radius, colour(selected ? colours::accent : colours::pin), 40);
    draw.AddCircleFilled(at, 2 * scale, colour({0.1f, 0.1f, 0.12f, 0.85f}), 16);
}

}  // namespace

void Canvas::set_viewport(const ScreenRect& viewport) {
    view_.follow(viewport_, viewport);
    viewport_ = viewport;
    if (editor_.document_number() == shown_document_) return;
    shown_document_ = editor_.document_number();
    fit();
}

void Canvas::fit() {
    const auto& shape = editor_.shape();
    if (shape && shape->subject) view_.fit(shape->subject->image.width(), shape->subject->image.height(), viewport_);
}

void Canvas::handle(const InputEvent& event, bool blocked) {
    using Kind = InputEvent::Kind;
    const Point before = pointer_;
    pointer_ = event.screen;
    over_ = !blocked && viewport_.contains(event.screen);
    switch (event.kind) {
        case Kind::move:
            if (panning_) view_.pan(pointer_ - before);
            editor_.move(view_.image_from_screen(pointer_));
            break;
        case Kind::press:
            if (over_) press(event);
            break;
        case Kind::release:
            if (event.code == GLFW_MOUSE_BUTTON_LEFT) {
                editor_.move(view_.image_from_screen(pointer_));
                editor_.release();
            }
            panning_ = false;
            break;
        case Kind::scroll:
            if (over_) view_.zoom_about(pointer_, std::pow(1.2, event.scroll.y()));
            break;
        case Kind::key_press:
            if (event.code == GLFW_KEY_SPACE && !blocked) space_held_ = true;
            if (event.code == GLFW_KEY_ESCAPE && !blocked) {
                if (!editor_.tool().holding()) editor_.tool().select({});
                editor_.cancel();
            }
            break;
        case Kind::key_release:
            if (event.code == GLFW_KEY_SPACE) space_held_ = false;
            break;
        default: break;
    }
    const bool points = over_ && editor_.has_document();
    hovered_ = points
                   ? editor_.tool().pin_at(view_.image_from_screen(pointer_), editor_.pose_name(), image_px_per_point())
                   : std::string();
}

void Canvas::press(const InputEvent& event) {
    if (!editor_.has_document()) return;
    const Point image = view_.image_from_screen(event.screen);
    if (event.code == GLFW_MOUSE_BUTTON_MIDDLE || (event.code == GLFW_MOUSE_BUTTON_LEFT && space_held_)) {
        panning_ = true;
    } else if (event.code == GLFW_MOUSE_BUTTON_LEFT && show_pins) {
        editor_.press(image, image_px_per_point());
    } else if (event.code == GLFW_MOUSE_BUTTON_RIGHT && show_pins) {
        menu_pin_ = editor_.tool().pin_at(image, editor_.pose_name(), image_px_per_point());
        if (!menu_pin_.empty()) editor_.tool().select(menu_pin_);
        open_menu_ = !menu_pin_.empty();
    }
}

PictureRenderer::Frame Canvas::frame(const Point& window_size, double pixels_per_point) const {
    PictureRenderer::Frame frame;
    frame.viewport = viewport_;
    frame.window_size = window_size;
    frame.pixels_per_point = pixels_per_point;
    frame.view = view_;
    frame.show_mesh = show_mesh;
    frame.back_faces = editor_.puppet().back_faces == BackFaces::show;
    if (editor_.puppet().background) {
        try {
            const Background background = background_from_name(*editor_.puppet().background);
            frame.keep_picture = background.kind == Background::Kind::keep;
            frame.fill_picture = background.kind == Background::Kind::inpaint;
            if (background.kind == Background::Kind::colour) frame.background = background.rgba;
        } catch (const Error&) {
            // The export says what is wrong with it; until then it is as good as none.
        }
    }
    return frame;
}

void Canvas::draw(ImDrawList& draw, float scale) {
    if (!editor_.has_document() || !editor_.shape()) return;
    draw_outside(draw);
    if (show_pins) draw_pins(draw, scale);
    draw_context_menu();
    if (panning_ || editor_.tool().dragging()) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeAll);
    } else if (over_ && (space_held_ || !hovered_.empty())) {
        ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    }
}

void Canvas::draw_outside(ImDrawList& draw) const {
    // What leaves the picture's own canvas is cut off by the export: dim it.
    const Image& image = editor_.shape()->subject->image;
    const ImVec2 a = im(viewport_.min);
    const ImVec2 b = im(viewport_.min + viewport_.size);
    const ImVec2 p = im(view_.screen_from_image({0, 0}));
    const ImVec2 q = im(view_.screen_from_image(Point(image.width(), image.height())));
    const ImU32 veil = colour(colours::canvas, 0.72f);
    draw.AddRectFilled(a, {b.x, p.y}, veil);
    draw.AddRectFilled({a.x, q.y}, b, veil);
    draw.AddRectFilled({a.x, p.y}, {p.x, q.y}, veil);
    draw.AddRectFilled({q.x, p.y}, {b.x, q.y}, veil);
    draw.AddRect({p.x - 1, p.y - 1}, {q.x + 1, q.y + 1}, colour({0.35f, 0.37f, 0.42f, 1}));
}

void Canvas::draw_pins(ImDrawList& draw, float scale) const {
    const std::string selected = editor_.tool().selected();
    for (const Pin& pin : pins(editor_.puppet(), editor_.pose())) {
        const ImVec2 at = im(view_.screen_from_image(pin.to));
        if (pin.id == selected && editor_.tool().dragging()) {
            const ImVec2 from = im(view_.screen_from_image(pin.at));
            draw.AddLine(from, at, colour({0, 0, 0, 0.45f}), 4 * scale);
            draw.AddLine(from, at, colour(colours::accent), 2 * scale);
            draw.AddCircleFilled(from, 5 * scale, colour({0, 0, 0, 0.45f}), 24);
            draw.AddCircleFilled(from, 3.5f * scale, colour(colours::accent), 24);
        }
        draw_pin(draw, at, pin.id == hovered_, pin.id == selected, scale);
    }
    const bool ghost = over_ && hovered_.empty() && !space_held_ && !panning_ && !editor_.tool().holding();
    if (ghost && editor_.can_set_pin(view_.image_from_screen(pointer_))) {
        draw.AddCircleFilled(im(pointer_), 6.5f * scale, colour(colours::pin, 0.25f), 40);
        draw.AddCircle(im(pointer_), 7.5f * scale, colour({1, 1, 1, 0.55f}), 40, 1.5f * scale);
    }
}

void Canvas::draw_context_menu() {
    if (std::exchange(open_menu_, false)) ImGui::OpenPopup("pin");
    if (!ImGui::BeginPopup("pin")) return;
    ImGui::TextDisabled("%s", menu_pin_.c_str());
    if (ImGui::MenuItem("Remove", "Del")) editor_.remove_pin(menu_pin_);
    ImGui::EndPopup();
}

}  // namespace puppetwarp::ui
