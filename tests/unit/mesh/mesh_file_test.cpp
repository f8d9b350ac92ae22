#include <puppetwarp/mesh/mesh_file.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/mesh_text.h>

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>

#include <sys/stat.h>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

class MeshFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ =
            fs::path(testing::TempDir()) /
            ("puppetwarp_mesh_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }

    std::string message_of(const fs::path& path) const {
        try {
            read_mesh(path);
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "read without complaint";
    }

    fs::path folder_;
};

TriangleMesh two_triangles() {
    TriangleMesh mesh{Eigen::MatrixX2d(4, 2), Eigen::MatrixX3i(2, 3)};
    mesh.V << 0.1, 1.0 / 3, 1e6 + 0.7, -2e-9, 12345.678901234567, 1e4, -5.5, 77.25;
    mesh.F << 0, 1, 2, 0, 2, 3;
    return mesh;
}

}  // namespace

TEST_F(MeshFile, GivesBackEveryBitOfWhatItWrote) {
    const TriangleMesh mesh = two_triangles();
    for (const char* name : {"mesh.off", "mesh.obj", "MESH.OFF"}) {
        write_mesh(mesh, folder_ / name);
        const TriangleMesh again = read_mesh(folder_ / name);
        EXPECT_EQ(again.V, mesh.V) << name;
        EXPECT_EQ(again.F, mesh.F) << name;
    }
}

TEST_F(MeshFile, ReadsPolygonsAsFansAndEverySpellingOfCorners) {
    const fs::path path = write("a.obj",
                                "# comment\r\nv 0 0 0\r\nv 2 0 0\r\nvt 0 0\r\nv 2 2 0\r\nv 1 3 0\r\nv 0 2 0\r\n"
                                "g group\r\nf 1/1 2/1/1 3//1 4 -1");
    const TriangleMesh mesh = read_mesh(path);
    Eigen::MatrixX3i expected(3, 3);
    expected << 0, 1, 2, 0, 2, 3, 0, 3, 4;
    EXPECT_EQ(mesh.F, expected);
}

TEST_F(MeshFile, NamesTheLineAtFault) {
    EXPECT_THAT(message_of(write("a.off", "OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n")), testing::HasSubstr("line 4"));
    EXPECT_THAT(message_of(write("a.obj", "v 0 0\n\n# c\nv 1 nan\n")), testing::HasSubstr("line 4"));
}

TEST_F(MeshFile, RefusesWhatIsNoMeshFile) {
    EXPECT_THAT(message_of(folder_ / "none.off"), testing::HasSubstr("no such file"));
    EXPECT_THAT(message_of(write("mesh.ply", "ply\n")), testing::HasSubstr(".off or .obj"));
    fs::create_directory(folder_ / "folder.off");
    EXPECT_THAT(message_of(folder_ / "folder.off"), testing::HasSubstr("is a folder"));
    ASSERT_EQ(::mkfifo((folder_ / "pipe.off").c_str(), 0600), 0);
    EXPECT_THAT(message_of(folder_ / "pipe.off"), testing::HasSubstr("is not a regular file"));
    EXPECT_THAT(message_of(write("empty.off", "")), testing::HasSubstr("empty"));
}

TEST_F(MeshFile, RefusesToWriteWhereItCannot) {
    EXPECT_THROW(write_mesh(two_triangles(), folder_ / "mesh.png"), InvalidInput);
    EXPECT_THROW(write_mesh(two_triangles(), folder_ / "none" / "mesh.off"), InvalidInput);
}

TEST_F(MeshFile, DrawsEachEdgeOnceInSvg) {
    write_mesh_svg(two_triangles(), {0, 0, 40, 30}, folder_ / "mesh.svg");
    std::stringstream text;
    text << std::ifstream(folder_ / "mesh.svg").rdbuf();
    EXPECT_THAT(text.str(), testing::HasSubstr("viewBox=\"0 0 40 30\""));
    const std::string drawing = text.str();
    EXPECT_EQ(std::count(drawing.begin(), drawing.end(), 'M'), 5);
}

TEST(MeshText, SurvivesAnyBytes) {
    std::mt19937 random(17);
    const std::string sound = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
    const std::string alphabet = "OFfv 0123456789-+.e/#\n\r\tnaninf\0\xff";
    for (int round = 0; round < 2000; ++round) {
        std::string text = sound;
        for (int k = 0; k < 4; ++k) text[random() % text.size()] = alphabet[random() % alphabet.size()];
        for (const auto read : {&mesh_from_off, &mesh_from_obj}) {
            try {
                const TriangleMesh mesh = read(text, "any");
                ASSERT_TRUE(mesh.V.allFinite());
                if (mesh.F.rows() == 0) continue;
                ASSERT_LT(mesh.F.maxCoeff(), mesh.V.rows());
                ASSERT_GE(mesh.F.minCoeff(), 0);
            } catch (const InvalidInput&) {
            }
        }
    }
}

}  // namespace puppetwarp
