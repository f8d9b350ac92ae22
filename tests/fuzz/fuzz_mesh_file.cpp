// Reads whatever bytes as OFF and as OBJ: a mesh with valid indices or a clear refusal, nothing else.

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/mesh_text.h>

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace puppetwarp;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    for (const auto read : {&mesh_from_off, &mesh_from_obj}) {
        try {
            const TriangleMesh mesh = read(text, "fuzz");
            if (!mesh.V.allFinite()) std::abort();
            if (mesh.F.size() > 0 && (mesh.F.minCoeff() < 0 || mesh.F.maxCoeff() >= mesh.V.rows())) std::abort();
        } catch (const InvalidInput&) {
        }
    }
    return 0;
}
