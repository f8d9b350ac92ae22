#include <puppetwarp/project/json_reader.h>

#include <puppetwarp/base/errors.h>

#include <cmath>
#include <limits>

namespace puppetwarp {

namespace {

// A document nested deeper than this cannot be a puppet file, and could exhaust the stack of who walks through it.
constexpr int max_depth = 64;

std::string type_of(const Json& json) {
    if (json.is_null()) return "null";
    if (json.is_boolean()) return "true or false";
    if (json.is_number()) return "a number";
    if (json.is_string()) return "text";
    return json.is_array() ? "a list" : "an object";
}

}  // namespace

std::string short_number(double value) {
    std::string text = Json(value).dump();
    if (text.size() > 2 && text.ends_with(".0")) text.resize(text.size() - 2);
    return text;
}

Json parse_json(std::string_view text, const std::string& subject) {
    bool too_deep = false;
    const auto limit_depth = [&](int depth, Json::parse_event_t, Json&) {
        too_deep = too_deep || depth > max_depth;
        return !too_deep;
    };
    try {
        Json json = Json::parse(text.begin(), text.end(), limit_depth);
        if (too_deep) throw InvalidInput(subject, "is nested deeper than a puppet file can be");
        return json;
    } catch (const Json::parse_error& error) {
        // The library's text begins with its own error number and ends with the cause; the place is what helps.
        const std::string_view before = text.substr(0, std::min(text.size(), error.byte));
        const auto line = std::count(before.begin(), before.end(), '\n') + 1;
        throw InvalidInput(subject, "is not JSON: the text breaks off or goes wrong in line " + std::to_string(line));
    } catch (const Json::exception&) {
        throw InvalidInput(subject, "is not JSON: a number is too large");
    }
}

void JsonReader::fail(const std::string& reason, const std::string& advice) const {
    throw InvalidInput(subject_, path_.empty() ? reason : path_ + " " + reason, advice);
}

void JsonReader::require_object() const {
    if (!json_->is_object()) fail("must be an object, but is " + type_of(*json_));
}

std::optional<JsonReader> JsonReader::find(const char* key) const {
    require_object();
    const auto member = json_->find(key);
    if (member == json_->end()) return std::nullopt;
    return JsonReader(*member, subject_, path_.empty() ? key : path_ + "." + key);
}

JsonReader JsonReader::at(const char* key) const {
    if (std::optional<JsonReader> member = find(key)) return *member;
    fail("lacks the field `" + std::string(key) + "`");
}

std::vector<JsonReader> JsonReader::elements() const {
    if (!json_->is_array()) fail("must be a list, but is " + type_of(*json_));
    std::vector<JsonReader> result;
    result.reserve(json_->size());
    for (const Json& element : *json_) {
        result.emplace_back(element, subject_, path_ + "[" + std::to_string(result.size()) + "]");
    }
    return result;
}

std::vector<std::pair<std::string, JsonReader>> JsonReader::members() const {
    require_object();
    std::vector<std::pair<std::string, JsonReader>> result;
    result.reserve(json_->size());
    for (const auto& [key, value] : json_->items()) {
        result.emplace_back(key, JsonReader(value, subject_, path_ + "." + key));
    }
    return result;
}

double JsonReader::number() const {
    if (!json_->is_number()) fail("must be a number, but is " + type_of(*json_));
    const double value = json_->get<double>();
    if (!std::isfinite(value)) fail("must be a finite number");
    return value;
}

double JsonReader::number_in(double least, double most) const {
    const double value = number();
    if (value < least || value > most) {
        const std::string range = std::isfinite(most) ? "between " + short_number(least) + " and " + short_number(most)
                                                      : "at least " + short_number(least);
        fail("must be " + range + ", but is " + short_number(value));
    }
    return value;
}

double JsonReader::positive() const {
    const double value = number();
    if (value <= 0) fail("must be above 0, but is " + short_number(value));
    return value;
}

int JsonReader::integer() const {
    const double value = number();
    if (value != std::floor(value)) fail("must be a whole number, but is " + short_number(value));
    if (std::abs(value) > std::numeric_limits<int>::max()) fail("is too large a number: " + short_number(value));
    return static_cast<int>(value);
}

std::string JsonReader::text() const {
    if (!json_->is_string()) fail("must be text, but is " + type_of(*json_));
    return json_->get<std::string>();
}

Point JsonReader::point() const {
    if (!json_->is_array() || json_->size() != 2) fail("must be a point [x, y]");
    const std::vector<JsonReader> coordinates = elements();
    return {coordinates[0].number(), coordinates[1].number()};
}

Polyline JsonReader::points(std::size_t at_least) const {
    Polyline result;
    for (const JsonReader& element : elements()) result.push_back(element.point());
    if (result.size() < at_least) fail("must hold at least " + std::to_string(at_least) + " points");
    return result;
}

std::array<double, 6> JsonReader::affine() const {
    const std::vector<JsonReader> numbers = elements();
    if (numbers.size() != 6) fail("must be six numbers [a, b, c, d, e, f]");
    std::array<double, 6> result{};
    for (std::size_t i = 0; i < 6; ++i) result[i] = numbers[i].number();
    return result;
}

}  // namespace puppetwarp
