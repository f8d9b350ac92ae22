#pragma once

#include <functional>
#include <string>

namespace puppetwarp::ui {

//! Asks what shall become of unsaved changes.
class UnsavedQuestion {
public:
    //! \param save     the changes shall be saved first.
    //! \param discard  they shall go.
    void open(std::string document, std::function<void()> save, std::function<void()> discard);
    bool is_open() const { return open_; }
    void draw(float scale);

private:
    std::string document_;
    std::function<void()> save_;
    std::function<void()> discard_;
    bool open_ = false;
    bool appearing_ = false;
};

}  // namespace puppetwarp::ui
