#include "ui/driven_editor.h"

#include "support/run_command.h"

#include <puppetwarp/image/read.h>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace puppetwarp::tests {

namespace {

constexpr auto patience = std::chrono::seconds(60);

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

std::vector<std::string> with_program(const std::string& program, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
}

[[noreturn]] void become(const std::vector<std::string>& arguments) {
    std::vector<char*> words;
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execvp(words[0], words.data());
    _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, int descriptor,
                           const std::vector<std::string>& environment) {
    std::vector<std::string> words = with_program("env", environment);
    words.insert(words.end(), arguments.begin(), arguments.end());
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
        dup2(ends[1], descriptor);
        become(words);
    }
    close(ends[1]);
    pipe_ = ends[0];
    if (process_ < 0) throw std::runtime_error("no process");
}

ChildProcess::~ChildProcess() {
    if (process_ > 0) {
        kill(process_, SIGTERM);
        wait_for_exit();
    }
    close(pipe_);
}

bool ChildProcess::read_line(std::string& line) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    std::size_t end = 0;
    while ((end = unread_.find('\n')) == std::string::npos) {
        const std::chrono::duration<double, std::milli> left = deadline - std::chrono::steady_clock::now();
        pollfd poller{pipe_, POLLIN, 0};
        if (poll(&poller, 1, std::max(0, static_cast<int>(left.count()))) <= 0) return false;
        char buffer[4096];
        const ssize_t count = read(pipe_, buffer, sizeof buffer);
        if (count <= 0) return false;
        unread_.append(buffer, static_cast<std::size_t>(count));
    }
    line = unread_.substr(0, end);
    unread_.erase(0, end + 1);
    return true;
}

int ChildProcess::wait_for_exit() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

VirtualDisplay::VirtualDisplay()
    : server_({"Xvfb", "-displayfd", "9", "-screen", "0", "1280x800x24", "-nolisten", "tcp"}, 9) {
    std::string number;
    if (!server_.read_line(number)) throw std::runtime_error("Xvfb does not start (package xvfb)");
    name_ = ":" + number;
}

DrivenEditor::DrivenEditor(const VirtualDisplay& display, const std::filesystem::path& screenshots,
                           const std::vector<std::string>& arguments)
    : display_(display.name()),
      program_(with_program(PUPPETWARP_BINARY_DIR "/puppetwarp-ui", arguments), STDOUT_FILENO,
               {"DISPLAY=" + display_, "LIBGL_ALWAYS_SOFTWARE=1", "LC_ALL=C.UTF-8", "PUPPETWARP_UI_TEST_LOG=1",
                "PUPPETWARP_UI_SCREENSHOT=" + (screenshots / "shot").string()}) {
    std::string line;
    if (!program_.read_line(line) || !line.starts_with("READY"))
        throw std::runtime_error("the editor does not start: " + line);
    window_ = first_line(xdotool_output({"search", "--sync", "--onlyvisible", "--name", "puppetwarp"}));
    // There is no window manager that would hand out the keyboard.
    xdotool({"windowfocus", "--sync", window_});
}

void DrivenEditor::take(const std::string& line) {
    if (line.starts_with("SHOT ")) last_screenshot_ = line.substr(5);
    if (!line.starts_with("STATE ")) return;
    state_.clear();
    const std::size_t message = line.find(" message=");
    state_["message"] = line.substr(message + 9);
    std::istringstream words(line.substr(6, message - 6));
    for (std::string word; words >> word;) state_[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
}

void DrivenEditor::wait_until(const std::string& what, const std::function<bool(const EditorState&)>& holds) {
    std::string line;
    while (state_.empty() || !holds(state_)) {
        if (!program_.read_line(line)) {
            std::string now;
            for (const auto& [key, value] : state_) now += key + "=" + value + " ";
            throw std::runtime_error("waited in vain for " + what + "; the state is " + now);
        }
        take(line);
    }
}

void DrivenEditor::wait_for(const std::vector<std::string>& wanted) {
    std::string all;
    for (const std::string& word : wanted) all += word + " ";
    wait_until(all, [&](const EditorState& state) {
        for (const std::string& word : wanted) {
            const std::size_t equals = word.find('=');
            const auto found = state.find(word.substr(0, equals));
            if (found == state.end() || found->second != word.substr(equals + 1)) return false;
        }
        return true;
    });
}

std::string DrivenEditor::xdotool_output(const std::vector<std::string>& words) const {
    std::vector<std::string> arguments{"/usr/bin/env", "DISPLAY=" + display_, "LC_ALL=C.UTF-8", "xdotool"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const CommandResult result = run_command(arguments);
    if (result.exit_code != 0) throw std::runtime_error("xdotool: " + result.errors);
    return result.output;
}

void DrivenEditor::xdotool(const std::vector<std::string>& words) const {
    xdotool_output(words);
}

Point DrivenEditor::window_from_image(const Point& image) const {
    return image * std::stod(state_.at("scale")) + Point(std::stod(state_.at("x")), std::stod(state_.at("y")));
}

std::vector<std::string> DrivenEditor::to_window(const Point& window) const {
    return {"mousemove", "--window", window_, std::to_string(std::lround(window.x())),
            std::to_string(std::lround(window.y()))};
}

std::vector<std::string> DrivenEditor::to_image(const Point& image) const {
    return to_window(window_from_image(image));
}

void DrivenEditor::click(const Point& image) const {
    std::vector<std::string> words = to_image(image);
    words.insert(words.end(), {"click", "1"});
    xdotool(words);
}

Image DrivenEditor::screenshot() {
    last_screenshot_.clear();
    key("F12");
    wait_until("a screenshot", [this](const EditorState&) { return !last_screenshot_.empty(); });
    return read_image(last_screenshot_);
}

int DrivenEditor::wait_for_exit() {
    std::string line;
    while (program_.read_line(line)) take(line);
    return program_.wait_for_exit();
}

}  // namespace puppetwarp::tests
