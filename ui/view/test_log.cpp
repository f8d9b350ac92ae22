#include "view/test_log.h"

#include <puppetwarp/image/write.h>

#include <epoxy/gl.h>
#include <opencv2/core.hpp>

#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace puppetwarp::ui {

namespace {

std::string state(const App& app) {
    const Editor& editor = app.editor();
    const Point origin = app.canvas().view().screen_from_image({0, 0});
    std::ostringstream text;
    text << "document=" << editor.document_number() << " settled=" << (editor.settled() && !editor.busy())
         << " live=" << (editor.shape() && editor.shape()->live)
         << " resting=" << (editor.up_to_date() && editor.shape()->converged) << " modified=" << editor.modified()
         << " dragging=" << editor.tool().dragging() << " pins=" << editor.puppet().rig.handles.size()
         << " selected=" << (editor.tool().selected().empty() ? "-" : editor.tool().selected())
         << " undo=" << editor.can_undo() << " redo=" << editor.can_redo()
         << " method=" << method_name(editor.puppet().method.method) << " mesh=" << app.canvas().show_mesh
         << " vertices=" << (editor.shape() && editor.shape()->mesh ? editor.shape()->mesh->V.rows() : 0)
         << " exporting=" << editor.exporting() << " dialog=" << app.dialog()
         << " scale=" << app.canvas().view().scale() << " x=" << origin.x() << " y=" << origin.y()
         << " trouble=" << (editor.shape() && !editor.shape()->error.empty())
         << " error=" << (editor.message().kind == Message::Kind::error) << " message=" << editor.message().text;
    return text.str();
}

void write_framebuffer(int width, int height, const std::string& path) {
    cv::Mat bottom_up(height, width, CV_8UC3);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bottom_up.data);
    Image image;
    cv::flip(bottom_up, image.pixels, 0);
    write_image(image, path);
}

}  // namespace

TestLog::TestLog() {
    const char* log = std::getenv("PUPPETWARP_UI_TEST_LOG");
    logs_ = log && *log;
    const char* prefix = std::getenv("PUPPETWARP_UI_SCREENSHOT");
    if (prefix) prefix_ = prefix;
}

void TestLog::line(const std::string& text) const {
    if (!logs_) return;
    std::puts(text.c_str());
    std::fflush(stdout);
}

void TestLog::after_frame(const App& app, int framebuffer_width, int framebuffer_height) {
    if (!ready_) line("READY " + std::to_string(framebuffer_width) + "x" + std::to_string(framebuffer_height));
    ready_ = true;
    if (screenshot_wanted_) {
        screenshot_wanted_ = false;
        const std::string path = prefix_ + "-" + std::to_string(++screenshots_) + ".png";
        write_framebuffer(framebuffer_width, framebuffer_height, path);
        line("SHOT " + path);
    }
    if (!logs_) return;
    std::string now = state(app);
    if (now == last_state_) return;
    last_state_ = std::move(now);
    line("STATE " + last_state_);
}

}  // namespace puppetwarp::ui
