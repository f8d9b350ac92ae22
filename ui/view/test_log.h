#pragma once

#include "view/app.h"

#include <string>

namespace puppetwarp::ui {

//! What tests that drive the window read, on standard output, when the environment asks for it; else silent.
//!
//! - `PUPPETWARP_UI_TEST_LOG=1`: one line `READY WxH` after the first frame, then one line `STATE key=value ...`
//!   whenever one of its values differs. Values have no spaces but the last one, `message`.
//! - `PUPPETWARP_UI_SCREENSHOT=PREFIX`: F12 writes the window to `PREFIX-1.png`, `PREFIX-2.png`, ... and, with the
//!   log, a line `SHOT FILE`.
class TestLog {
public:
    TestLog();
    //! After a frame is drawn and before it is shown.
    void after_frame(const App& app, int framebuffer_width, int framebuffer_height);
    //! F12 was pressed.
    void ask_for_screenshot() { screenshot_wanted_ = !prefix_.empty(); }

private:
    void line(const std::string& text) const;

    bool logs_ = false;
    std::string prefix_;
    bool screenshot_wanted_ = false;
    int screenshots_ = 0;
    bool ready_ = false;
    std::string last_state_;
};

}  // namespace puppetwarp::ui
