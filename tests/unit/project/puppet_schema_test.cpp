// The schema that `puppetwarp schema` prints says what the reader reads: the same keys, the same verdicts.

#include "support/message_of.h"
#include "support/run_command.h"

#include <puppetwarp/project/json_schema.h>
#include <puppetwarp/project/puppet_json.h>
#include <puppetwarp/project/puppet_schema.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

namespace puppetwarp {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Keys = std::set<std::string>;

const Json& schema() {
    static const Json parsed = Json::parse(puppet_schema());
    return parsed;
}

std::string reader_fault(const Json& document) {
    return message_of([&] { puppet_from_json(JsonReader(document, "test")); });
}

// Documents that have every key that there is, between them.
std::vector<Json> complete_documents() {
    std::vector<Json> documents;
    for (const char* text : {R"({
        "format": "puppetwarp", "version": 1, "image": "a.png",
        "cutout": {"from": "polygon", "points": [[0, 0], [9, 0], [9, 9.5]], "holes": [[[1, 1], [2, 1], [2, 2]]]},
        "background": "#10203040", "back_faces": "show",
        "mesh": {"max_edge_px": 12, "min_angle_deg": 25, "expand_px": 2},
        "handles": [
            {"id": "p", "type": "point", "at": [1, 2], "radius_px": 3},
            {"id": "spine", "type": "bone", "from": [1, 2], "to": [3, 4]},
            {"id": "arm", "type": "bone", "from": [3, 4], "to": [5, 4], "parent": "spine", "length": "fixed"},
            {"id": "c", "type": "cage", "points": [[0, 0], [9, 0], [9, 9], [0, 9]]},
            {"id": "r", "type": "region", "points": [[0, 0], [9, 0], [9, 9]], "falloff": "geodesic"},
            {"id": "v", "type": "vertex", "index": 7}],
        "stiffness": [{"points": [[0, 0], [9, 0], [9, 9]], "value": 8}, {"image": "s.png", "max": 20}],
        "method": {"name": "smooth-arap", "arap_energy": "spokes", "bending_length_px": 4, "stretching": 0.5,
                   "bending": 0.1, "tolerance": 1e-6, "max_iterations": 5, "weights": "l1", "partition": "normalised",
                   "l1_budget": 0.5},
        "poses": [
            {"name": "w", "time_s": 1, "handles": {
                "p": {"to": [5, 6], "rotate_deg": 20, "scale": 1.2, "depth": 1},
                "spine": {"from": [1, 1], "to": [4, 4]},
                "c": {"to": [[0, 0], [9, 1], [9, 9], [0, 8]]},
                "r": {"affine": [1, 0, 0.5, 1, 10, -20]}}},
            {"name": "x", "handles": {"p": {"turn_deg": -400}, "arm": {"reach": [2, 6], "chain": 2}}}]})",
                             R"({"format": "puppetwarp", "version": 1, "cutout": {"from": "mask", "path": "m.png"},
                                 "background": "keep"})"}) {
        documents.push_back(Json::parse(text));
    }
    return documents;
}

// The keys that a text asks for by `pattern`, function by function.
std::map<std::string, Keys> keys_by_function(const fs::path& source, const std::regex& pattern) {
    std::map<std::string, Keys> found;
    std::string function;
    std::istringstream text(tests::bytes_of(source));
    const std::regex definition(R"(^[A-Za-z]\S* (?:\S+ )*(\w+)\(.*\{$)");
    for (std::string line; std::getline(text, line);) {
        std::smatch match;
        if (std::regex_match(line, match, definition)) function = match[1];
        for (std::sregex_iterator key(line.begin(), line.end(), pattern), end; key != end; ++key) {
            found[function].insert((*key)[1]);
        }
    }
    return found;
}

// The keys of every object that a schema describes, whatever its conditions.
void collect_keys(const Json& part, Keys& keys) {
    if (part.contains("properties")) {
        for (const auto& [key, value] : part["properties"].items()) keys.insert(key);
    }
    for (const char* branch : {"if", "then", "else"}) {
        if (part.contains(branch)) collect_keys(part[branch], keys);
    }
    if (part.contains("allOf")) {
        for (const Json& branch : part["allOf"]) collect_keys(branch, keys);
    }
}

Keys keys_of(const std::string& definition) {
    Keys keys;
    collect_keys(definition.empty() ? schema() : schema()["$defs"][definition], keys);
    return keys;
}

TEST(PuppetSchema, HasTheKeysOfTheReader) {
    std::map<std::string, Keys> read =
        keys_by_function(PUPPETWARP_SOURCE_DIR "/src/puppetwarp/project/puppet_from_json.cpp",
                         std::regex(R"re((?:find|at)\("(\w+)"\))re"));
    read["puppet_from_json"].merge(read["require_version"]);
    read.erase("require_version");
    const std::map<std::string, Keys> described{
        {"puppet_from_json", keys_of("")},        {"read_cutout", keys_of("cutout")},
        {"read_mesh_settings", keys_of("mesh")},  {"read_handle", keys_of("handle")},
        {"read_stiffness", keys_of("stiffness")}, {"read_method", keys_of("method")},
        {"read_pose", keys_of("pose")},           {"read_handle_pose", keys_of("handle_pose")}};
    EXPECT_EQ(read, described);
}

// Values that are right somewhere and wrong elsewhere, and both ends of every range.
std::vector<Json> odd_values() {
    return Json::parse(R"([null, true, "", "x", "rest", "auto", "mask", "polygon", "point", "bone", "cage", "region",
        "vertex", "fixed", "arap", "spokes", "bbw", "coupled", "harmonic", "transparent", "inpaint", "hide", "#12345g", "#123456",
        "#1234567", "#123456789", " keep", -1, 0, 1e-7, 1e-6, 0.5, 1, 1.0, 2, 30, 30.5, 360000, 360001, -360000,
        -360001, 1e6, 1000001, 2147483647, 2147483648, -3e9, 1e300, [], [1], [1, 2], [1, "x"], [1, 2, 3], [[1, 2]],
        [[1, 2], [3, 4]], [[1, 2], [3, 4], [5, 0]], [[1, 2], [3, 4], [5]], [[1, 2], [3, 4], 5],
        [[1, 2], [3, 4], [5, 6], [7, 1]], [[[1, 2], [3, 4], [5, 0]]], [1, 0, 0, 1, 0, 0], [1, 0, 0, 1, 0, "x"],
        [1e7, 0, 0, 1, 0, 0], [1, 0, 0, 1, 1e7, 0], {}, {"to": [1, 2]}, {"reach": [1, 2], "to": [1, 2]},
        {"chain": 2}, {"id": "new", "type": "cage", "points": [[0, 0], [1, 0], [0, 1]]},
        {"affine": [1, 0, 0, 1, 0, 0], "scale": 2}, {"from": "grabcut"}, {"image": ""}, {"image": "i.png", "max": 0}])")
        .get<std::vector<Json>>();
}

// Calls `see` with the document with each of its values replaced by each odd value, left away, or beside an odd one.
template <typename See>
void mutate(const Json& document, const Json::json_pointer& at, const std::vector<Json>& odd, const See& see) {
    const Json& value = document[at];
    for (const Json& other : odd) {
        Json changed = document;
        changed[at] = other;
        see(changed, at);
    }
    if (!at.empty() && document[at.parent_pointer()].is_object()) {
        Json changed = document;
        changed[at.parent_pointer()].erase(at.back());
        see(changed, at);
    }
    if (value.is_object()) {
        for (const auto& [key, member] : value.items()) mutate(document, at / key, odd, see);
    } else if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) mutate(document, at / i, odd, see);
    }
}

// What a schema cannot say: a value that is wrong only beside another place of the document.
bool is_contradiction(const std::string& complaint) {
    static const std::regex known(
        "the id is used twice|is not a bone of the rig|lead round in a loop|has no length|is no handle of this puppet|"
        "does not have '|has the name `.*` of another pose|a bone's to cannot stand beside|"
        R"(handles\.\w+\.to(\[0\])? must (be a point|hold [0-9]+ points|hold at least 4 points))");
    return std::regex_search(complaint, known);
}

TEST(PuppetSchema, AgreesWithTheReaderOnWhateverIsChangedInADocument) {
    int accepted = 0, refused = 0, contradictions = 0;
    for (const Json& document : complete_documents()) {
        ASSERT_EQ(reader_fault(document), "");
        mutate(document, Json::json_pointer(), odd_values(), [&](const Json& changed, const Json::json_pointer& at) {
            const std::string read = reader_fault(changed), fault = schema_fault(changed, schema());
            if (read.empty()) {
                EXPECT_EQ(fault, "") << at << " of " << changed;
                ++accepted;
            } else if (fault.empty()) {
                EXPECT_TRUE(is_contradiction(read)) << at << ": " << read;
                ++contradictions;
            } else {
                ++refused;
            }
        });
    }
    EXPECT_GT(accepted, 500);
    EXPECT_GT(refused, 5000);
    EXPECT_GT(contradictions, 100);
}

// Another validator's verdict on every tenth of those documents, where Debian's python3-jsonschema is installed.
TEST(PuppetSchema, MeansToOthersWhatItMeansHere) {
    const std::string begin =
        "import json, sys, jsonschema\nfrom jsonschema import Draft202012Validator as Validator\n";
    if (tests::run_command({"/usr/bin/env", "python3", "-c", begin}).exit_code != 0) {
        GTEST_SKIP() << "python3-jsonschema is not installed";
    }
    const tests::TemporaryFolder folder;
    std::string documents, verdicts;
    int count = 0;
    for (const Json& document : complete_documents()) {
        mutate(document, Json::json_pointer(), odd_values(), [&](const Json& changed, const Json::json_pointer&) {
            if (count++ % 10 != 0) return;
            documents += changed.dump() + "\n";
            verdicts += schema_fault(changed, schema()).empty() ? '1' : '0';
        });
    }
    tests::put_bytes(folder / "schema.json", puppet_schema());
    tests::put_bytes(folder / "documents", documents);
    const tests::CommandResult result = tests::run_command(
        {"/usr/bin/env", "python3", "-c",
         begin + "schema = json.load(open(sys.argv[1]))\n"
                 "Validator.check_schema(schema)\n"
                 "valid = Validator(schema).is_valid\n"
                 "print(''.join('01'[valid(json.loads(line))] for line in open(sys.argv[2])), end='')\n",
         folder / "schema.json", folder / "documents"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.output, verdicts);
    EXPECT_GT(verdicts.size(), 500u);
}

// The schema's own word where the reader's is about a whole document.
TEST(PuppetSchema, RefusesWhatIsWrongInOnePlace) {
    const auto with = [](const char* at, const char* value) {
        Json document = complete_documents()[0];
        document[Json::json_pointer(at)] = Json::parse(value);
        return schema_fault(document, schema());
    };
    EXPECT_THAT(with("/version", "2"), HasSubstr("version must be 1"));
    EXPECT_THAT(with("/mesh/min_angle_deg", "31"), HasSubstr("mesh.min_angle_deg must be at most 30"));
    EXPECT_THAT(with("/handles/0/at/1", "\"x\""), HasSubstr("handles[0].at[1] must be of the type number"));
    EXPECT_THAT(with("/handles/3/points", "[[0, 0], [1, 1]]"), HasSubstr("handles[3].points must hold at least 3"));
    EXPECT_THAT(with("/poses/1/name", "\"rest\""), HasSubstr("poses[1].name must not agree"));
    EXPECT_THAT(with("/poses/0/handles/r/to", "[1, 2]"), HasSubstr("poses[0].handles.r.to cannot stand here"));
    EXPECT_THAT(with("/poses/1/handles/p/chain", "2"), HasSubstr("poses[1].handles.p lacks the field \"reach\""));
    EXPECT_THAT(with("/background", "\"blue\""), HasSubstr("background is none of what it can be"));
}

TEST(PuppetSchema, AgreesWithTheReaderOnTheProjectsOwnFiles) {
    int count = 0;
    for (const char* folder : {"images", "tests/fuzz/corpus/puppet"}) {
        for (const auto& entry : fs::directory_iterator(fs::path(PUPPETWARP_SOURCE_DIR) / folder)) {
            if (entry.path().extension() != ".json") continue;
            const Json document = parse_json(tests::bytes_of(entry.path()), entry.path());
            EXPECT_EQ(schema_fault(document, schema()).empty(), reader_fault(document).empty()) << entry.path();
            ++count;
        }
    }
    EXPECT_GE(count, 9);
}

TEST(PuppetSchema, HasTheNamesAndDefaultsOfTheLibrary) {
    const Json& method = schema()["$defs"]["method"]["properties"];
    EXPECT_EQ(method["name"]["enum"].get<std::vector<std::string>>(), method_names());
    EXPECT_EQ(method["weights"]["enum"].get<std::vector<std::string>>(), weight_kind_names());
    const MethodOptions usual;
    EXPECT_EQ(method["name"]["default"], method_name(usual.method));
    EXPECT_EQ(method["arap_energy"]["default"], arap_energy_name(usual.arap_energy));
    EXPECT_EQ(method["stretching"]["default"], usual.stretching);
    EXPECT_EQ(method["bending"]["default"], usual.bending);
    EXPECT_EQ(method["tolerance"]["default"], usual.tolerance);
    EXPECT_EQ(method["max_iterations"]["default"], usual.max_iterations);
    EXPECT_EQ(method["weights"]["default"], weight_kind_name(usual.weights.kind));
    EXPECT_EQ(method["partition"]["default"], partition_name(usual.weights.partition));
    EXPECT_EQ(method["l1_budget"]["default"], usual.weights.l1_budget);
    EXPECT_EQ(schema()["$defs"]["cutout"]["properties"]["from"]["default"], CutoutSettings().from);
}

// Every key says what it means; every number says its range, or is one of those that can be any.
void expect_described(const Json& part, const std::string& at) {
    for (const auto& [key, value] : part.items()) {
        if (key == "properties") {
            for (const auto& [name, property] : value.items()) {
                if (property.is_boolean() || property.contains("const")) continue;  // of a condition
                const bool refined = property.size() == 1 && property.contains("minLength");
                const bool referred = property.contains("$ref") && at.empty();
                EXPECT_TRUE(property.contains("description") || refined || referred) << at << "." << name;
            }
        }
        if (value.is_structured() && key != "examples")
            expect_described(value, std::string(at).append("/").append(key));
    }
}

TEST(PuppetSchema, SaysWhatEveryKeyMeans) {
    EXPECT_EQ(schema()["$schema"], "https://json-schema.org/draft/2020-12/schema");
    expect_described(schema(), "");
    for (const auto& [name, definition] : schema()["$defs"].items()) {
        EXPECT_TRUE(definition.contains("description") || name == "matrix_entry") << name;
    }
    for (const Json& example : schema()["examples"]) {
        EXPECT_EQ(reader_fault(example), "");
        EXPECT_EQ(schema_fault(example, schema()), "");
    }
    EXPECT_EQ(puppet_schema(), schema().dump(2) + "\n");
}

TEST(PuppetSchema, PassesNoKeywordOverInSilence) {
    EXPECT_THROW(schema_fault(1, Json{{"multipleOf", 2}}), std::logic_error);
    EXPECT_THROW(schema_fault(1, Json{{"type", "null"}}), std::logic_error);
}

}  // namespace
}  // namespace puppetwarp
