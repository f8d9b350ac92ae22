#include <puppetwarp/base/errors.h>

#include <algorithm>

namespace puppetwarp {

namespace {

// Names and library messages may hold line breaks or control characters; the message stays one clean line.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    return text;
}

// What libraries say may end in a full stop. A name keeps its own: the folder `..` is called so.
std::string clause(const std::string& text) {
    std::string line = one_line(text);
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line;
}

std::string compose(const std::string& subject, const std::string& reason, const std::string& advice) {
    std::string message = one_line(subject) + ": " + clause(reason);
    if (!advice.empty()) message += " (" + clause(advice) + ")";
    return message;
}

}  // namespace

Error::Error(const std::string& subject, const std::string& reason, const std::string& advice)
    : std::runtime_error(compose(subject, reason, advice)), subject_(subject), reason_(reason), advice_(advice) {}

}  // namespace puppetwarp
