#include "model/editor.h"

#include "model/folder_listing.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/pipeline.h>

#include <exception>
#include <map>
#include <system_error>
#include <utility>

namespace puppetwarp::ui {

namespace {

namespace fs = std::filesystem;

std::string shown_name(const fs::path& path) {
    return path.filename().string();
}

std::string joined(const std::vector<std::string>& phrases) {
    std::string text;
    for (const std::string& phrase : phrases) text += (text.empty() ? "" : ", ") + phrase;
    return text;
}

// The command refuses to write over the picture it reads; so does the editor.
void require_not_the_source(const Puppet& puppet, const fs::path& target) {
    std::error_code ignored;
    if (fs::equivalent(resolve(puppet, puppet.image), target, ignored))
        throw InvalidInput(target.string(), "is the picture that is being warped", "choose another name");
}

std::string render_to_file(const Puppet& puppet, const Pose& pose, const fs::path& path, Progress& progress) {
    require_not_the_source(puppet, path);
    RenderOptions options;
    options.format = output_format(path);
    const Rendered rendered = render(puppet, pose, options, progress);
    progress.step("write", 0);
    write_image(rendered.image, path);
    std::string message = "Exported " + shown_name(path) + ", " + std::to_string(rendered.image.width()) + " × " +
                          std::to_string(rendered.image.height());
    if (!rendered.report.lost.empty()) message += "; this format cannot hold " + joined(rendered.report.lost);
    return message;
}

}  // namespace

Editor::Editor(int longest_side_px, std::function<void()> wake, const Pace& pace)
    : wake_(std::move(wake)),
      history_(Puppet{}),
      tool_(history_),
      worker_(std::make_unique<Worker>(
          [maker = std::make_shared<ShapeMaker>(longest_side_px, pace)](
              const ShapeRequest& request, Progress& progress) { return maker->make(request, progress); },
          wake_)) {}

void Editor::open(const fs::path& path) {
    cancel();
    try {
        Opening opening{path, {}, {}, 0};
        if (is_puppet_file(path)) {
            opening.puppet = read_puppet(path);
            opening.file = path;
        } else {
            opening.puppet.folder = fs::absolute(path).parent_path();
            opening.puppet.image = shown_name(path);
        }
        opening.revision = ++revision_;
        const Pose pose = default_pose(opening.puppet);
        worker_->submit({opening.revision, std::make_shared<const Puppet>(opening.puppet), pose});
        opening_ = std::move(opening);
        message_ = {Message::Kind::info, "Opening " + shown_name(path)};
    } catch (const std::exception& error) {
        report_error(error.what());
    }
}

void Editor::finish_opening(const std::shared_ptr<const Shape>& shape) {
    const Opening opening = *std::exchange(opening_, std::nullopt);
    if (!shape->subject) {
        report_error(shape->error);
        if (has_document_) request(Ask::what_is_rendered);
        return;
    }
    history_.reset(opening.puppet);
    tool_.select({});
    has_document_ = true;
    ++document_number_;
    file_ = opening.file;
    chosen_pose_.clear();
    shape_ = shape;
    message_ = {};
}

bool Editor::save_as(const fs::path& path) {
    cancel();
    take_turns();
    try {
        const auto snapshot = history_.snapshot();
        require_not_the_source(*snapshot, path);
        write_puppet(*snapshot, path);
        history_.mark_saved(snapshot);
        file_ = path;
        message_ = {Message::Kind::info, "Saved " + shown_name(path)};
        return true;
    } catch (const std::exception& error) {
        report_error(error.what());
        return false;
    }
}

void Editor::export_picture(const fs::path& path) {
    if (!can_edit() || export_) return;
    take_turns();
    message_ = {Message::Kind::info, "Exporting " + shown_name(path)};
    export_ = std::make_unique<BackgroundTask>(
        [puppet = history_.snapshot(), pose = pose(), path](Progress& progress) {
            return render_to_file(*puppet, pose, path, progress);
        },
        wake_);
}

fs::path Editor::document_folder() const {
    return file_.empty() ? puppet().folder : fs::absolute(file_).parent_path();
}

fs::path Editor::suggested_puppet_path() const {
    if (!file_.empty()) return file_;
    return document_folder() / (fs::path(puppet().image).stem().string() + ".puppet.json");
}

fs::path Editor::suggested_export_path() const {
    return document_folder() / (fs::path(puppet().image).stem().string() + "-warped.png");
}

std::string Editor::document_name() const {
    if (!has_document_) return {};
    return shown_name(file_.empty() ? fs::path(puppet().image) : file_);
}

void Editor::change(const std::string& name, const std::function<void(Puppet&)>& how, Ask ask) {
    if (!can_edit()) return;
    auto edit = history_.edit(name);
    how(edit.value());
    edit.commit();
    message_ = {};
    request(ask);
}

void Editor::undo() {
    if (!can_undo()) return;
    message_ = {Message::Kind::info, "Undone: " + history_.undo_name()};
    history_.undo();
    request(Ask::what_is_rendered);
}

void Editor::redo() {
    if (!can_redo()) return;
    message_ = {Message::Kind::info, "Redone: " + history_.redo_name()};
    history_.redo();
    request(Ask::what_is_rendered);
}

void Editor::set_method(Method method) {
    if (puppet().method.method == method) return;
    change("Choose method", [&](Puppet& puppet) { puppet.method.method = method; });
}

void Editor::set_method_options(const std::string& name, const MethodOptions& options) {
    change(name, [&](Puppet& puppet) { puppet.method = options; });
}

void Editor::remove_pin(const std::string& id) {
    if (!find_handle(puppet().rig, id)) return;
    change(
        "Remove " + id, [&](Puppet& puppet) { remove_handle(puppet, id); }, Ask::keep_way);
}

void Editor::clear_pose() {
    change("Reset pose", [&](Puppet& puppet) { ui::clear_pose(puppet, pose_name()); });
}

std::string Editor::pose_name() const {
    const auto& poses = puppet().poses;
    if (poses.empty()) return "pose";
    for (const Pose& pose : poses)
        if (pose.name == chosen_pose_) return chosen_pose_;
    return poses.front().name;
}

void Editor::choose_pose(const std::string& name) {
    if (!can_edit()) return;
    chosen_pose_ = name;
    request(Ask::what_is_rendered);
}

void Editor::press(const Point& image, double image_px_per_point) {
    if (!can_edit()) return;
    follow(tool_.press(image, rest_finder_.rest_from_moved(shape_, image), pose_name(), image_px_per_point),
           Ask::keep_way);
}

void Editor::move(const Point& image) {
    follow(tool_.move(image), Ask::keep_way);
}

void Editor::release() {
    // The pointer may be ahead of the newest shape; `take_turns` brings what is missing when that has come to its end.
    follow(tool_.release(shape_ && shape_->live ? shape_->turns : std::map<std::string, double>{}), Ask::keep_way);
}

void Editor::cancel() {
    follow(tool_.cancel(), Ask::what_is_rendered);
}

void Editor::follow(PinTool::Change change, Ask when_settled) {
    if (change == PinTool::Change::none) return;
    message_ = {};
    request(change == PinTool::Change::live ? Ask::live : when_settled);
}

void Editor::request(Ask ask) {
    take_turns();
    ++revision_;
    const History<Puppet>::Snapshot step = history_.snapshot();
    awaited_.reset();
    if (ask == Ask::keep_way) awaited_ = Awaited{revision_, step, pose_name()};
    worker_->submit({revision_, step, pose(), ask == Ask::live, ask == Ask::keep_way});
}

void Editor::take_turns() {
    const std::shared_ptr<const Shape> newest = worker_->newest();
    if (!awaited_ || !newest || newest->revision != awaited_->revision) return;
    const Awaited awaited = *std::exchange(awaited_, std::nullopt);
    Puppet kept = *awaited.step;
    keep_turns(kept, awaited.pose, newest->turns);
    // A step that says all there is to say stays the one that is saved.
    if (to_json(kept) != to_json(*awaited.step)) history_.amend(awaited.step, std::move(kept));
}

bool Editor::update() {
    bool news = false;
    if (export_ && export_->done()) {
        message_ = {export_->failed() ? Message::Kind::error : Message::Kind::info, export_->message()};
        export_.reset();
        news = true;
    }
    take_turns();
    std::shared_ptr<const Shape> newest = worker_->newest();
    if (newest == seen_) return news;
    seen_ = newest;
    if (opening_ && newest->revision == opening_->revision) {
        finish_opening(newest);
    } else if (newest->subject) {
        shape_ = std::move(newest);
    } else {
        // The picture went away under an open document: what is on the screen is still the best there is.
        report_error(newest->error);
    }
    return true;
}

}  // namespace puppetwarp::ui
