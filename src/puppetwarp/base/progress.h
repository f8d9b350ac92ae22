#pragma once

#include <exception>
#include <string_view>

namespace puppetwarp {

//! Thrown by `Progress::step` when whoever asked for the work no longer wants it. Nothing has been written.
class Cancelled : public std::exception {
public:
    const char* what() const noexcept override { return "cancelled"; }
};

//! How long work reports where it is, and hears that it is no longer wanted.
//! The base class neither shows nor cancels anything. Calls come one at a time, from the thread that called the library
//! or, for pictures that are drawn while they are written (`warp_rows`), from one that it waits for.
class Progress {
public:
    virtual ~Progress() = default;

    //! \param stage     what is being done, as `timings_ms` of reports name it: `read`, `bind`, `weights`, `warp`, ...
    //! \param fraction  how much of this stage is done, in [0, 1].
    //! \throw Cancelled  when `cancelled()`.
    void step(std::string_view stage, double fraction) {
        if (cancelled()) throw Cancelled();
        show(stage, fraction);
    }

    virtual bool cancelled() const { return false; }

protected:
    virtual void show(std::string_view /*stage*/, double /*fraction*/) {}
};

}  // namespace puppetwarp
