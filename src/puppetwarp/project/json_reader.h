#pragma once
// Private header: JSON does not appear in the installed ones.

#include <puppetwarp/base/point.h>

#include <nlohmann/json.hpp>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp {

using Json = nlohmann::ordered_json;

//! Parses JSON. \throw InvalidInput  not JSON (says where), or nested deeper than any puppet file.
Json parse_json(std::string_view text, const std::string& subject);

//! A number as a person writes it: whole numbers without a fraction.
std::string short_number(double value);

//! A JSON value that knows where in the document it stands, so that every complaint names its field.
class JsonReader {
public:
    //! \param json     must outlive the reader.
    //! \param subject  how errors name the document.
    //! \param path     of this value inside it, such as `handles[2].at`; empty for the document itself.
    JsonReader(const Json& json, std::string subject, std::string path = {})
        : json_(&json), subject_(std::move(subject)), path_(std::move(path)) {}

    //! The member `key`, or nothing when it is absent. \throw InvalidInput  this is not an object.
    std::optional<JsonReader> find(const char* key) const;
    //! \throw InvalidInput  absent.
    JsonReader at(const char* key) const;
    //! The elements of an array. \throw InvalidInput  not an array.
    std::vector<JsonReader> elements() const;
    //! The members of an object with their keys. \throw InvalidInput  not an object.
    std::vector<std::pair<std::string, JsonReader>> members() const;

    // Each throws InvalidInput when the value is of another type; numbers are finite.
    double number() const;
    double number_in(double least, double most) const;
    double positive() const;
    int integer() const;
    std::string text() const;
    Point point() const;
    Polyline points(std::size_t at_least) const;
    std::array<double, 6> affine() const;

    const std::string& path() const { return path_; }
    //! Complains about this value: `subject: path reason (advice)`.
    [[noreturn]] void fail(const std::string& reason, const std::string& advice = {}) const;

private:
    void require_object() const;

    const Json* json_;
    std::string subject_;
    std::string path_;
};

}  // namespace puppetwarp
