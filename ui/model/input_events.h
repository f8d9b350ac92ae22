#pragma once

#include <puppetwarp/base/point.h>

#include <deque>
#include <string>
#include <vector>

namespace puppetwarp::ui {

struct Modifiers {
    bool shift = false;
    bool control = false;
    bool alt = false;
    bool operator==(const Modifiers&) const = default;
};

//! One thing that a person did, with everything that was true at that moment.
struct InputEvent {
    enum class Kind { move, press, release, scroll, key_press, key_repeat, key_release, text, drop };

    Kind kind = Kind::move;
    Point screen{0, 0};  //!< where the pointer was
    Modifiers modifiers;
    int code = 0;                    //!< mouse button or key, as GLFW numbers them; the character for `text`
    int scancode = 0;                //!< of a key, as the system numbers it
    Point scroll{0, 0};              //!< wheel steps, right and up positive
    std::vector<std::string> paths;  //!< of dropped files
};

//! What happened since the last frame, handed out so that no frame holds two changes of a button or a key.
//!
//! Dear ImGui 1.86 sees the state at the time of a frame only: of a press and a release in one frame it would miss
//! both, and a press that a move follows it would see at the wrong place.
class EventQueue {
public:
    void push(InputEvent event) { events_.push_back(std::move(event)); }
    bool empty() const { return events_.empty(); }
    //! The events of the next frame, oldest first: moves, up to and with the first event that is something else.
    std::vector<InputEvent> take_frame();

private:
    std::deque<InputEvent> events_;
};

}  // namespace puppetwarp::ui
