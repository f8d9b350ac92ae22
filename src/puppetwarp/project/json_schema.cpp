#include <puppetwarp/project/json_schema.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <stdexcept>
#include <string_view>

namespace puppetwarp {

namespace {

// What only tells people something.
constexpr std::array<std::string_view, 6> annotations{"$schema",     "$defs",   "title",
                                                      "description", "default", "examples"};

bool is_of_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "number") return value.is_number();
    if (type == "integer") return value.is_number() && value.get<double>() == std::floor(value.get<double>());
    throw std::logic_error("the schema names the type " + type);
}

// One value held against one schema of a document. Each function tells what one keyword finds wrong, or nothing.
class SchemaCheck {
public:
    SchemaCheck(const Json& root, const Json& schema, const Json& value, std::string path)
        : root_(root), schema_(schema), value_(value), path_(std::move(path)) {}

    std::string fault() const {
        if (schema_.is_boolean()) return schema_.get<bool>() ? "" : complaint("cannot stand here");
        for (const auto& [keyword, operand] : schema_.items()) {
            std::string found = fault_of(keyword, operand);
            if (!found.empty()) return found;
        }
        return "";
    }

private:
    using Keyword = std::string (SchemaCheck::*)(const Json& operand) const;
    struct Named {
        std::string_view name;
        Keyword check;
    };

    std::string fault_of(const std::string& keyword, const Json& operand) const;

    std::string complaint(const std::string& reason) const { return path_.empty() ? reason : path_ + " " + reason; }
    std::string unless(bool good, const std::string& reason) const { return good ? "" : complaint(reason); }

    std::string inside(const Json& schema) const { return inside(schema, value_, path_); }
    std::string inside(const Json& schema, const Json& value, const std::string& path) const {
        return SchemaCheck(root_, schema, value, path).fault();
    }
    std::string member_path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

    std::string reference(const Json& operand) const {  // `#/$defs/NAME`
        return inside(root_.at(Json::json_pointer(operand.get<std::string>().substr(1))));
    }

    std::string type(const Json& operand) const {
        return unless(is_of_type(value_, operand), "must be of the type " + operand.get<std::string>());
    }
    std::string constant(const Json& operand) const { return unless(value_ == operand, "must be " + operand.dump()); }
    std::string one_of(const Json& operand) const {
        return unless(std::find(operand.begin(), operand.end(), value_) != operand.end(),
                      "must be one of " + operand.dump());
    }

    std::string minimum(const Json& operand) const {
        return unless(!value_.is_number() || value_ >= operand, "must be at least " + operand.dump());
    }
    std::string maximum(const Json& operand) const {
        return unless(!value_.is_number() || value_ <= operand, "must be at most " + operand.dump());
    }
    std::string exclusive_minimum(const Json& operand) const {
        return unless(!value_.is_number() || value_ > operand, "must be above " + operand.dump());
    }

    // Of ASCII alone could lengths in bytes be lengths in characters; the schema asks only for that.
    std::string min_length(const Json& operand) const {
        return unless(!value_.is_string() || text().size() >= operand.get<std::size_t>(), "must not be so short");
    }
    std::string max_length(const Json& operand) const {
        return unless(!value_.is_string() || text().size() <= operand.get<std::size_t>(), "must not be so long");
    }
    std::string pattern(const Json& operand) const {
        return unless(!value_.is_string() || std::regex_search(text(), std::regex(operand.get<std::string>())),
                      "must match " + operand.get<std::string>());
    }

    std::string min_items(const Json& operand) const {
        return unless(!value_.is_array() || value_.size() >= operand, "must hold at least " + operand.dump());
    }
    std::string max_items(const Json& operand) const {
        return unless(!value_.is_array() || value_.size() <= operand, "must hold at most " + operand.dump());
    }
    std::string prefix_items(const Json& operand) const {
        return elements(0, operand.size(), [&](std::size_t i) -> const Json& { return operand[i]; });
    }
    std::string items(const Json& operand) const {
        const auto prefix = schema_.find("prefixItems");
        return elements(prefix == schema_.end() ? 0 : prefix->size(), value_.size(),
                        [&](std::size_t) -> const Json& { return operand; });
    }
    template <typename SchemaOf>
    std::string elements(std::size_t first, std::size_t last, SchemaOf schema_of) const {
        for (std::size_t i = first; value_.is_array() && i < std::min(last, value_.size()); ++i) {
            std::string found = inside(schema_of(i), value_[i], path_ + "[" + std::to_string(i) + "]");
            if (!found.empty()) return found;
        }
        return "";
    }

    std::string properties(const Json& operand) const {
        for (const auto& [key, schema] : operand.items()) {
            if (!value_.is_object() || !value_.contains(key)) continue;
            std::string found = inside(schema, value_[key], member_path(key));
            if (!found.empty()) return found;
        }
        return "";
    }
    // Of all members: the schema has no `properties` beside it.
    std::string additional_properties(const Json& operand) const {
        if (!value_.is_object()) return "";
        for (const auto& [key, member] : value_.items()) {
            std::string found = inside(operand, member, member_path(key));
            if (!found.empty()) return found;
        }
        return "";
    }
    std::string required(const Json& operand) const {
        for (const Json& key : operand) {
            if (value_.is_object() && !value_.contains(key)) return complaint("lacks the field " + key.dump());
        }
        return "";
    }
    std::string dependent_required(const Json& operand) const {
        for (const auto& [key, needed] : operand.items()) {
            if (value_.is_object() && value_.contains(key) && !required(needed).empty()) return required(needed);
        }
        return "";
    }

    std::string none_of(const Json& operand) const {
        return unless(!inside(operand).empty(), "must not agree with " + operand.dump());
    }
    std::string any_of(const Json& operand) const {
        const bool agrees =
            std::any_of(operand.begin(), operand.end(), [&](const Json& schema) { return inside(schema).empty(); });
        return unless(agrees, "is none of what it can be");
    }
    std::string all_of(const Json& operand) const {
        for (const Json& schema : operand) {
            std::string found = inside(schema);
            if (!found.empty()) return found;
        }
        return "";
    }
    std::string condition(const Json& operand) const {
        const auto consequence = schema_.find(inside(operand).empty() ? "then" : "else");
        return consequence == schema_.end() ? "" : inside(*consequence);
    }
    std::string part_of_condition(const Json& /*operand*/) const { return ""; }

    const std::string& text() const { return value_.get_ref<const std::string&>(); }

    const Json& root_;
    const Json& schema_;
    const Json& value_;
    std::string path_;
};

std::string SchemaCheck::fault_of(const std::string& keyword, const Json& operand) const {
    static constexpr std::array<Named, 24> keywords{{{"$ref", &SchemaCheck::reference},
                                                     {"type", &SchemaCheck::type},
                                                     {"const", &SchemaCheck::constant},
                                                     {"enum", &SchemaCheck::one_of},
                                                     {"minimum", &SchemaCheck::minimum},
                                                     {"maximum", &SchemaCheck::maximum},
                                                     {"exclusiveMinimum", &SchemaCheck::exclusive_minimum},
                                                     {"minLength", &SchemaCheck::min_length},
                                                     {"maxLength", &SchemaCheck::max_length},
                                                     {"pattern", &SchemaCheck::pattern},
                                                     {"minItems", &SchemaCheck::min_items},
                                                     {"maxItems", &SchemaCheck::max_items},
                                                     {"prefixItems", &SchemaCheck::prefix_items},
                                                     {"items", &SchemaCheck::items},
                                                     {"properties", &SchemaCheck::properties},
                                                     {"additionalProperties", &SchemaCheck::additional_properties},
                                                     {"required", &SchemaCheck::required},
                                                     {"dependentRequired", &SchemaCheck::dependent_required},
                                                     {"not", &SchemaCheck::none_of},
                                                     {"anyOf", &SchemaCheck::any_of},
                                                     {"allOf", &SchemaCheck::all_of},
                                                     {"if", &SchemaCheck::condition},
                                                     {"then", &SchemaCheck::part_of_condition},
                                                     {"else", &SchemaCheck::part_of_condition}}};
    if (std::find(annotations.begin(), annotations.end(), keyword) != annotations.end()) return "";
    const auto known =
        std::find_if(keywords.begin(), keywords.end(), [&](const Named& each) { return each.name == keyword; });
    if (known == keywords.end()) throw std::logic_error("the schema uses the keyword " + keyword);
    return (this->*known->check)(operand);
}

}  // namespace

std::string schema_fault(const Json& document, const Json& schema) {
    return SchemaCheck(schema, schema, document, "").fault();
}

}  // namespace puppetwarp
