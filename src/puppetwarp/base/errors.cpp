#include <puppetwarp/base/errors.h>

#include <algorithm>

namespace puppetwarp {

namespace {

// Names and library messages may hold line breaks or control characters; the message stays one clean line.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
    return text;
}

std::string compose(const std::string& subject, const std::string& reason, const std::string& advice) {
    std::string message = one_line(subject) + ": " + one_line(reason);
    if (!advice.empty()) message += " (" + one_line(advice) + ")";
    return message;
}

}  // namespace

Error::Error(const std::string& subject, const std::string& reason, const std::string& advice)
    : std::runtime_error(compose(subject, reason, advice)), subject_(subject), reason_(reason), advice_(advice) {}

}  // namespace puppetwarp
