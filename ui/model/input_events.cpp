#include "model/input_events.h"

namespace puppetwarp::ui {

std::vector<InputEvent> EventQueue::take_frame() {
    std::vector<InputEvent> frame;
    while (!events_.empty()) {
        frame.push_back(std::move(events_.front()));
        events_.pop_front();
        if (frame.back().kind != InputEvent::Kind::move) break;
    }
    return frame;
}

}  // namespace puppetwarp::ui
