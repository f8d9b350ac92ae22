// Puppet files: whatever the bytes, parsing gives a puppet or InvalidInput, and what it gives can be saved and read
// again; what the reader accepts agrees with the schema.

#include <puppetwarp/base/errors.h>
#include <puppetwarp/project/json_schema.h>
#include <puppetwarp/project/puppet.h>
#include <puppetwarp/project/puppet_json.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace puppetwarp;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    Puppet puppet;
    try {
        const Json json = parse_json(text, "fuzz");
        puppet_from_json(JsonReader(json, "fuzz"));
        if (!schema_fault(json, json_of_puppet_schema()).empty()) std::abort();
        puppet = parse_puppet(text, "fuzz");
    } catch (const InvalidInput&) {
        return 0;
    }
    const std::string saved = to_json(puppet);
    if (to_json(parse_puppet(saved, "saved")) != saved) std::abort();
    return 0;
}
