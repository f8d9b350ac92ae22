// Puppet files: whatever the bytes, parsing gives a puppet or InvalidInput, and what it gives can be saved and read
// again.

#include <puppetwarp/base/errors.h>
#include <puppetwarp/project/puppet.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace puppetwarp;
    Puppet puppet;
    try {
        puppet = parse_puppet({reinterpret_cast<const char*>(data), size}, "fuzz");
    } catch (const InvalidInput&) {
        return 0;
    }
    const std::string saved = to_json(puppet);
    if (to_json(parse_puppet(saved, "saved")) != saved) std::abort();
    return 0;
}
