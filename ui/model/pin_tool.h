#pragma once

#include "model/history.h"

#include <puppetwarp/base/point.h>
#include <puppetwarp/project/puppet.h>

#include <map>
#include <optional>
#include <string>

namespace puppetwarp::ui {

//! Sets, picks and drags pins with the pointer. Points are in image space.
//!
//! A press on a pin picks it; moving on drags it, one step of the history from press to release. A press on the
//! picture sets a new pin, where the picture then is, so that nothing moves by it.
class PinTool {
public:
    //! How far from a pin's middle it can be taken hold of, and how far the pointer goes before it drags.
    static constexpr double grab_radius = 11;  // screen points
    static constexpr double drag_slack = 3;    // screen points

    //! What a step of the pointer did to the puppet.
    enum class Change {
        none,
        live,    //!< a drag is under way
        settled  //!< a step was made, or a drag rolled back
    };

    explicit PinTool(History<Puppet>& history) : history_(history) {}

    //! \param pose    the name of the pose that is edited.
    //! \param rest    where the point of the subject that is seen at `image` rests; null: no subject is there.
    //! \param image_px_per_point  image pixels for one screen point.
    Change press(const Point& image, const std::optional<Point>& rest, const std::string& pose,
                 double image_px_per_point);
    Change move(const Point& image);
    //! \param turns  how far points have turned in the drag: a part of it (`with_turns`).
    Change release(const std::map<std::string, double>& turns = {});
    //! Gives up a drag: everything is as it was before the press.
    Change cancel();

    //! The pin under the pointer, the nearest one; empty: none.
    std::string pin_at(const Point& image, const std::string& pose, double image_px_per_point) const;

    //! The picked pin; empty: none, or it is gone.
    std::string selected() const;
    void select(std::string id) { selected_ = std::move(id); }
    bool dragging() const { return edit_.has_value(); }
    //! A button is held on a pin.
    bool holding() const { return held_.has_value(); }

private:
    struct Held {
        std::string id;
        std::string pose;
        Point pressed;  // where the pointer went down
        Point offset;   // from the pointer to the pin's middle
        double slack_px;
    };

    History<Puppet>& history_;
    std::string selected_;
    std::optional<Held> held_;
    std::optional<History<Puppet>::Edit> edit_;
};

}  // namespace puppetwarp::ui
