#pragma once

#include <string_view>

namespace puppetwarp {

//! report_page.html, with its `{{places}}`.
extern const std::string_view report_page;

}  // namespace puppetwarp
