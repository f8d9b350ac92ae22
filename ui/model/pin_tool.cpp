#include "model/pin_tool.h"

#include "model/puppet_edits.h"

#include <utility>

namespace puppetwarp::ui {

PinTool::Change PinTool::press(const Point& image, const std::optional<Point>& rest, const std::string& pose,
                               double image_px_per_point) {
    if (history_.editing()) return Change::none;
    const double slack_px = drag_slack * image_px_per_point;
    const std::string hit = pin_at(image, pose, image_px_per_point);
    if (!hit.empty()) {
        selected_ = hit;
        for (const Pin& pin : pins(history_.current(), pose_or_rest(history_.current(), pose)))
            if (pin.id == hit) held_ = Held{hit, pose, image, pin.to - image, slack_px};
        return Change::none;
    }
    selected_.clear();
    if (!rest) return Change::none;
    // Where the picture is not moved, rounding must not make a target that differs from the rest by a hair.
    const bool moved = (*rest - image).norm() > 1e-9 * (1 + image.norm());
    auto edit = history_.edit("Add pin");
    selected_ = add_pin(edit.value(), pose, moved ? *rest : image, image);
    edit.commit();
    held_ = Held{selected_, pose, image, Point(0, 0), slack_px};
    return Change::settled;
}

PinTool::Change PinTool::move(const Point& image) {
    if (!held_) return Change::none;
    if (!edit_) {
        if ((image - held_->pressed).norm() < held_->slack_px) return Change::none;
        edit_.emplace(history_.edit("Move pin"));
    }
    move_pin(edit_->value(), held_->pose, held_->id, image + held_->offset);
    return Change::live;
}

PinTool::Change PinTool::release(const std::map<std::string, double>& turns) {
    const std::optional<Held> held = std::exchange(held_, std::nullopt);
    if (!edit_) return Change::none;
    keep_turns(edit_->value(), held->pose, turns);
    edit_->commit();
    edit_.reset();
    return Change::settled;
}

PinTool::Change PinTool::cancel() {
    held_.reset();
    if (!edit_) return Change::none;
    edit_.reset();
    return Change::settled;
}

std::string PinTool::pin_at(const Point& image, const std::string& pose, double image_px_per_point) const {
    std::string nearest;
    double distance = grab_radius * image_px_per_point;
    for (const Pin& pin : pins(history_.current(), pose_or_rest(history_.current(), pose))) {
        // Of two pins at one place the later one is drawn on top.
        if ((pin.to - image).norm() > distance) continue;
        distance = (pin.to - image).norm();
        nearest = pin.id;
    }
    return nearest;
}

std::string PinTool::selected() const {
    return find_handle(history_.current().rig, selected_) ? selected_ : std::string();
}

}  // namespace puppetwarp::ui
