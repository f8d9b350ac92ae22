// Triangulates whatever polygons a text describes: a mesh that covers them or a clear refusal, nothing else.

#include <fuzz/outline_text.h>
#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/triangulate.h>

#include <cmath>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace puppetwarp;
    const tests::OutlineText input = tests::parse_outline_text({reinterpret_cast<const char*>(data), size});
    TriangulationOptions options;
    options.max_vertices = 5000;
    try {
        const TriangleMesh mesh = triangulate(input.outline, input.constraints, options);
        if (!mesh.V.allFinite() || mesh.F.rows() == 0) std::abort();
        if (mesh.F.minCoeff() < 0 || mesh.F.maxCoeff() >= mesh.V.rows()) std::abort();
    } catch (const InvalidInput&) {
    }
    return 0;
}
