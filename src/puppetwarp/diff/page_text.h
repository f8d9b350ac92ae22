#pragma once

#include <string>
#include <string_view>

namespace puppetwarp {

//! Text for HTML, between tags and in quoted attributes: readable (`printable`), with nothing that begins a tag, an
//! entity or an end of quotes.
std::string html_text(std::string_view text);

//! RFC 4648, section 4, one line.
std::string base64(std::string_view bytes);

}  // namespace puppetwarp
