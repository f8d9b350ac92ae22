#pragma once

#include "model/background_task.h"
#include "model/history.h"
#include "model/pin_tool.h"
#include "model/puppet_edits.h"
#include "model/rest_finder.h"
#include "model/shape_maker.h"
#include "model/worker.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace puppetwarp::ui {

//! One line for the person at the screen.
struct Message {
    enum class Kind { none, info, error } kind = Kind::none;
    std::string text;
};

//! The editor without its window: one puppet, its file, its history, and the shape that the worker makes of it.
//! All calls come from one thread. What the library refuses becomes a message, never an exception.
class Editor {
public:
    //! \param longest_side_px  how large a picture the screen's memory takes.
    //! \param wake             called from other threads when `update()` has something to take.
    Editor(int longest_side_px, std::function<void()> wake, const Pace& pace = {});

    // The file.

    //! Reads a picture or a puppet file; it takes the place of what is open once its picture is there. When that
    //! fails, what was open stays.
    void open(const std::filesystem::path& path);
    bool opening() const { return opening_.has_value(); }
    bool has_document() const { return has_document_; }
    bool modified() const { return history_.modified(); }
    //! The puppet file; empty when there is none yet.
    const std::filesystem::path& file() const { return file_; }
    //! \return true when the file is written.
    bool save_as(const std::filesystem::path& path);
    //! Draws the picture at full size, as the command does, and writes it.
    void export_picture(const std::filesystem::path& path);
    bool exporting() const { return export_ != nullptr; }
    double export_fraction() const { return export_ ? export_->fraction() : 0; }
    std::filesystem::path suggested_puppet_path() const;
    std::filesystem::path suggested_export_path() const;
    //! The name of what is open; empty: nothing.
    std::string document_name() const;

    // The puppet.

    const Puppet& puppet() const { return history_.current(); }
    const History<Puppet>& history() const { return history_; }
    bool can_edit() const { return has_document_ && !opening_ && !history_.editing(); }
    bool can_undo() const { return can_edit() && history_.can_undo(); }
    bool can_redo() const { return can_edit() && history_.can_redo(); }
    void undo();
    void redo();
    void set_method(Method method);
    //! Options of the method at hand. \param name  of the step, as the menu shows it.
    void set_method_options(const std::string& name, const MethodOptions& options);
    void remove_pin(const std::string& id);
    void clear_pose();
    //! The pose that is shown and edited: the chosen one, else the one that the command would take.
    std::string pose_name() const;
    Pose pose() const { return pose_or_rest(puppet(), pose_name()); }
    void choose_pose(const std::string& name);

    // The pointer, in image space.

    void press(const Point& image, double image_px_per_point);
    void move(const Point& image);
    void release();
    //! Gives up a drag.
    void cancel();
    PinTool& tool() { return tool_; }
    const PinTool& tool() const { return tool_; }

    //! A press at `image` would set a pin.
    bool can_set_pin(const Point& image) {
        return can_edit() && rest_finder_.rest_from_moved(shape_, image).has_value();
    }

    // What came of it.

    //! Takes what other threads have finished. \return true when there was something.
    bool update();
    //! The newest shape; null before the first.
    const std::shared_ptr<const Shape>& shape() const { return shape_; }
    //! `shape()` is one of the puppet as it stands; while a pin is dragged maybe not the last.
    bool up_to_date() const { return shape_ && shape_->revision == revision_ && !opening_; }
    //! `shape()` is what the command would render of the puppet as it stands.
    bool settled() const { return up_to_date() && !shape_->live; }
    bool busy() const { return opening_ || !worker_->idle(); }
    //! Counts the documents that were opened.
    int document_number() const { return document_number_; }
    const Message& message() const { return message_; }
    //! Shows what the library said, or anything else that failed.
    void report_error(const std::string& text) { message_ = {Message::Kind::error, text}; }

private:
    struct Opening {
        std::filesystem::path path;
        std::filesystem::path file;  // empty for a picture
        Puppet puppet;
        std::uint64_t revision;
    };

    // A shape that will say what belongs into the pose of the step that asked for it.
    struct Awaited {
        std::uint64_t revision;
        History<Puppet>::Snapshot step;
        std::string pose;
    };
    enum class Ask { what_is_rendered, live, keep_way };

    void request(Ask ask);
    void follow(PinTool::Change change, Ask when_settled);
    void take_turns();
    void finish_opening(const std::shared_ptr<const Shape>& shape);
    void change(const std::string& name, const std::function<void(Puppet&)>& how, Ask ask = Ask::what_is_rendered);
    std::filesystem::path document_folder() const;

    std::function<void()> wake_;
    History<Puppet> history_;
    PinTool tool_;
    bool has_document_ = false;
    int document_number_ = 0;
    std::filesystem::path file_;
    std::string chosen_pose_;
    Message message_;
    std::optional<Opening> opening_;
    std::optional<Awaited> awaited_;
    std::uint64_t revision_ = 0;
    std::shared_ptr<const Shape> shape_;
    std::shared_ptr<const Shape> seen_;  // the last one that was taken from the worker
    RestFinder rest_finder_;
    std::unique_ptr<BackgroundTask> export_;
    std::unique_ptr<Worker> worker_;
};

}  // namespace puppetwarp::ui
