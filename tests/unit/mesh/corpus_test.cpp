// Every file of the corpus is taken when its name begins with good_ and refused when it begins with bad_.

#include "shapes.h"

#include <fuzz/outline_text.h>
#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/mesh/triangulate.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> corpus(const char* folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(fs::path(PUPPETWARP_SOURCE_DIR) / "tests/fuzz/corpus" / folder)) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

bool is_good(const fs::path& path) {
    return path.filename().string().starts_with("good_");
}

}  // namespace

TEST(Corpus, OutlinesAreTriangulatedOrRefused) {
    const std::vector<fs::path> files = corpus("outline");
    ASSERT_GE(files.size(), 20U);
    for (const fs::path& path : files) {
        SCOPED_TRACE(path.filename());
        std::stringstream text;
        text << std::ifstream(path).rdbuf();
        const tests::OutlineText input = tests::parse_outline_text(text.str());
        if (!is_good(path)) {
            EXPECT_THROW(triangulate(input.outline, input.constraints), InvalidInput);
            continue;
        }
        const TriangleMesh mesh = triangulate(input.outline, input.constraints);
        double area = 0;
        for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
            const Eigen::RowVector2d a = mesh.V.row(mesh.F(t, 1)) - mesh.V.row(mesh.F(t, 0));
            const Eigen::RowVector2d b = mesh.V.row(mesh.F(t, 2)) - mesh.V.row(mesh.F(t, 0));
            area += 0.5 * (a.x() * b.y() - a.y() * b.x());
        }
        EXPECT_NEAR(area, tests::area_of(input.outline), 1e-9 * area);
    }
}

TEST(Corpus, MeshFilesAreReadOrRefused) {
    const std::vector<fs::path> files = corpus("mesh_file");
    ASSERT_GE(files.size(), 20U);
    for (const fs::path& path : files) {
        SCOPED_TRACE(path.filename());
        if (is_good(path)) {
            EXPECT_GT(read_mesh(path).F.rows(), 0);
        } else {
            EXPECT_THROW(read_mesh(path), InvalidInput);
        }
    }
}

}  // namespace puppetwarp
