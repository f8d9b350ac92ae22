#pragma once

#include <puppetwarp/base/errors.h>

#include <functional>
#include <string>

namespace puppetwarp {

//! What a piece of work says when it refuses its input, or nothing when it does not.
inline std::string message_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

}  // namespace puppetwarp
