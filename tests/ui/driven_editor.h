#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/point.h>

#include <sys/types.h>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace puppetwarp::tests {

//! A program that ends with this object at the latest, and one pipe from it.
class ChildProcess {
public:
    //! \param descriptor   which of the program's descriptors the pipe is.
    //! \param environment  set beside what this process has, `NAME=value`.
    ChildProcess(const std::vector<std::string>& arguments, int descriptor,
                 const std::vector<std::string>& environment = {});
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    //! The next line from the pipe. \return false at its end, or when a minute passes without one.
    bool read_line(std::string& line);
    //! \return the exit code, -1 for a signal.
    int wait_for_exit();

private:
    pid_t process_ = -1;
    int pipe_ = -1;
    std::string unread_;
};

//! A display of its own without a screen (Xvfb), on a number that was free.
class VirtualDisplay {
public:
    VirtualDisplay();
    const std::string& name() const { return name_; }  //!< `:7`

private:
    ChildProcess server_;
    std::string name_;
};

//! What the editor's `STATE` line says (ui/view/test_log.h), by key.
using EditorState = std::map<std::string, std::string>;

//! The editor in a window on a virtual display, with mouse and keys from xdotool.
//! Every wait is for what the editor says, up to a minute; a failure throws with the last state.
class DrivenEditor {
public:
    DrivenEditor(const VirtualDisplay& display, const std::filesystem::path& screenshots,
                 const std::vector<std::string>& arguments);

    //! Waits until the state says all of `wanted`, `key=value` each.
    void wait_for(const std::vector<std::string>& wanted);
    void wait_until(const std::string& what, const std::function<bool(const EditorState&)>& holds);
    const EditorState& state() const { return state_; }

    //! Runs `xdotool` with these words.
    void xdotool(const std::vector<std::string>& words) const;
    //! Words for xdotool that move the pointer to a point of the picture, or of the window.
    std::vector<std::string> to_image(const Point& image) const;
    std::vector<std::string> to_window(const Point& window) const;
    void click(const Point& image) const;
    void key(const std::string& name) const { xdotool({"key", name}); }

    //! What the window shows now. 8-bit RGB
    Image screenshot();
    //! Where a point of the picture is in a screenshot.
    Point window_from_image(const Point& image) const;

    //! Waits for the end of the program. \return its exit code, -1 for a signal.
    int wait_for_exit();

private:
    std::string xdotool_output(const std::vector<std::string>& words) const;
    void take(const std::string& line);

    std::string display_;
    ChildProcess program_;
    std::string window_;
    std::string last_screenshot_;
    EditorState state_;
};

}  // namespace puppetwarp::tests
