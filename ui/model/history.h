#pragma once

#include <cassert>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp::ui {

//! A value with undo: snapshots of the whole value, and where among them one stands.
template <typename T>
class History {
public:
    using Snapshot = std::shared_ptr<const T>;

    //! A change in the making. `History::current()` shows it already; it is rolled back unless it is committed.
    class Edit {
    public:
        Edit(Edit&& other) noexcept : history_(std::exchange(other.history_, nullptr)) {}
        Edit& operator=(Edit&&) = delete;
        ~Edit() {
            if (history_) history_->working_.reset();
        }

        //! What to change. \pre neither committed nor moved from.
        T& value() {
            assert(history_);
            return *history_->working_;
        }
        //! Makes the change one step that can be undone.
        void commit() {
            assert(history_);
            std::exchange(history_, nullptr)->commit();
        }

    private:
        friend class History;
        explicit Edit(History& history) : history_(&history) {}
        History* history_;
    };

    explicit History(T initial) { reset(std::move(initial)); }
    History(const History&) = delete;
    History& operator=(const History&) = delete;

    //! Begins anew: nothing to undo, nothing unsaved. \pre no edit is open.
    void reset(T value) {
        assert(!working_);
        steps_.clear();
        steps_.push_back({std::make_shared<const T>(std::move(value)), {}});
        present_ = 0;
        saved_ = steps_.front().snapshot;
    }

    //! The value as it stands, with an open edit's changes.
    const T& current() const { return working_ ? *working_ : *steps_[present_].snapshot; }
    //! `current()` to keep.
    Snapshot snapshot() const { return working_ ? std::make_shared<const T>(*working_) : steps_[present_].snapshot; }

    //! Opens an edit. \param name  what the person does, as the menu shows it. \pre no edit is open.
    [[nodiscard]] Edit edit(std::string name) {
        assert(!working_);
        working_ = std::make_unique<T>(*steps_[present_].snapshot);
        working_name_ = std::move(name);
        return Edit(*this);
    }
    bool editing() const { return working_ != nullptr; }

    bool can_undo() const { return !working_ && present_ > 0; }
    bool can_redo() const { return !working_ && present_ + 1 < steps_.size(); }
    //! What undo would take back; empty when there is nothing.
    std::string undo_name() const { return can_undo() ? steps_[present_].name : std::string(); }
    std::string redo_name() const { return can_redo() ? steps_[present_ + 1].name : std::string(); }
    void undo() {
        assert(can_undo());
        --present_;
    }
    void redo() {
        assert(can_redo());
        ++present_;
    }

    //! Puts into a step what belongs to it and was known only later; what was built on it since stays as it is.
    //! \return false when that step is gone.
    bool amend(const Snapshot& snapshot, T value) {
        for (Step& step : steps_) {
            if (step.snapshot != snapshot) continue;
            step.snapshot = std::make_shared<const T>(std::move(value));
            return true;
        }
        return false;
    }

    //! Whether something would be lost by closing.
    bool modified() const { return working_ || steps_[present_].snapshot != saved_; }
    //! \param written  the snapshot that is in the file now.
    void mark_saved(const Snapshot& written) { saved_ = written; }

private:
    struct Step {
        Snapshot snapshot;
        std::string name;  // of the edit that led here
    };

    void commit() {
        steps_.resize(present_ + 1);
        steps_.push_back({std::make_shared<const T>(std::move(*working_)), std::move(working_name_)});
        working_.reset();
        ++present_;
    }

    std::vector<Step> steps_;
    std::size_t present_ = 0;
    Snapshot saved_;
    std::unique_ptr<T> working_;
    std::string working_name_;
};

}  // namespace puppetwarp::ui
