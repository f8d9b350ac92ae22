#include "support/run_command.h"

#include <puppetwarp/base/input_file.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/project/weights_cache.h>

#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

namespace fs = std::filesystem;

// Counts how often weights are computed.
class Heard : public Progress {
public:
    int computed = 0;

protected:
    void show(std::string_view stage, double fraction) override { computed += stage == "weights" && fraction == 1; }
};

class WeightsCache : public testing::Test {
protected:
    WeightsCache() : mesh_(triangulate(rectangle_outline(200, 100), {}, {20})) {
        options_.kind = WeightKind::monotonic;
        rig_.handles = {{"a", PointHandle{{20, 50}, {}}}, {"b", PointHandle{{180, 50}, {}}}};
    }

    Weights get() { return cached_weights(mesh_, rig_, options_, file_, heard_); }
    // Whether weights are what they are without a file, and whether they were computed to be so.
    bool computed_anew() {
        const int before = heard_.computed;
        const Weights found = get();
        const int after = heard_.computed;
        Progress progress;
        const Weights expected = compute_weights(mesh_, rig_, options_, progress);
        EXPECT_EQ(found.W, expected.W);
        EXPECT_EQ(found.columns, expected.columns);
        EXPECT_EQ(found.warnings, expected.warnings);
        EXPECT_EQ(found.iterations, expected.iterations);
        EXPECT_EQ(found.converged, expected.converged);
        EXPECT_EQ(found.kkt_residual, expected.kkt_residual);
        EXPECT_EQ(found.partition_error, expected.partition_error);
        return after > before;
    }

    tests::TemporaryFolder folder_;
    fs::path file_ = folder_ / "subject.puppet.weights";
    TriangleMesh mesh_;
    Rig rig_;
    WeightOptions options_;
    Heard heard_;
};

TEST_F(WeightsCache, LiesBesideThePuppetFile) {
    EXPECT_EQ(weights_cache_path("some/cat.puppet.json"), fs::path("some/cat.puppet.weights"));
}

TEST_F(WeightsCache, IsUsedTheSecondTime) {
    EXPECT_TRUE(computed_anew());
    EXPECT_FALSE(computed_anew());
}

TEST_F(WeightsCache, NeverMeetsAnotherQuestion) {
    EXPECT_TRUE(computed_anew());
    mesh_.V(0, 0) -= 1e-9;
    EXPECT_TRUE(computed_anew()) << "a moved vertex";
    rig_.handles[1].shape = PointHandle{{160, 50}, {}};
    EXPECT_TRUE(computed_anew()) << "a moved handle";
    rig_.handles[1].shape = BoneHandle{{160, 50}, {190, 50}, ""};
    EXPECT_TRUE(computed_anew()) << "a handle of another kind";
    rig_.stiffness.emplace_back(StiffnessRegion{{{80, 0}, {120, 0}, {120, 100}, {80, 100}}, 50});
    EXPECT_TRUE(computed_anew()) << "stiffness";
    options_.tolerance = 1e-6;
    EXPECT_TRUE(computed_anew()) << "another tolerance";
    rig_.handles.push_back({"c", PointHandle{{100, 20}, {}}});
    EXPECT_TRUE(computed_anew()) << "one more handle";
    std::swap(rig_.handles[0], rig_.handles[2]);
    EXPECT_TRUE(computed_anew()) << "another order";
    EXPECT_FALSE(computed_anew());
}

// Weights of a cage around the subject depend on what lies between them, where the mesh has no triangles.
TEST_F(WeightsCache, NeverMeetsOtherStiffnessBesideTheSubject) {
    rig_.handles = {{"hull", CageHandle{{{-60, -60}, {260, -60}, {260, 160}, {-60, 160}}}}};
    EXPECT_TRUE(computed_anew());
    const Polyline beside{{-50, -50}, {250, -50}, {250, -10}, {-50, -10}};
    rig_.stiffness.emplace_back(StiffnessRegion{beside, 200});
    EXPECT_TRUE(computed_anew()) << "a stiff part";
    std::get<StiffnessRegion>(rig_.stiffness[0]).value = 2000;
    EXPECT_TRUE(computed_anew()) << "a stiffer one";
    cv::Mat grey = cv::Mat::zeros(4, 4, CV_32FC1);
    rig_.stiffness.emplace_back(StiffnessPicture{"stiff.png", 50, grey, 200, 100});
    EXPECT_TRUE(computed_anew()) << "a picture";
    grey.at<float>(1, 2) = 1;
    EXPECT_TRUE(computed_anew()) << "another picture";
    EXPECT_FALSE(computed_anew());
}

TEST_F(WeightsCache, PassesOverFilesThatAreBroken) {
    EXPECT_TRUE(computed_anew());
    const std::string whole = read_file(file_, 1 << 20);
    for (std::size_t keep : {std::size_t{0}, std::size_t{1}, std::size_t{30}, whole.size() / 2, whole.size() - 1}) {
        write_file(file_, whole.substr(0, keep));
        EXPECT_TRUE(computed_anew()) << keep;
    }
    for (std::size_t at : {std::size_t{0}, std::size_t{40}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 4);
        write_file(file_, flipped);
        EXPECT_TRUE(computed_anew()) << at;
    }
    EXPECT_EQ(read_file(file_, 1 << 20), whole) << "mended";
}

TEST_F(WeightsCache, DoesWithoutAFileWhereThereCannotBeOne) {
    file_ = folder_ / "missing/subject.puppet.weights";
    EXPECT_TRUE(computed_anew());
    EXPECT_FALSE(fs::exists(file_));
    file_ = fs::path();
    EXPECT_TRUE(computed_anew());
}

TEST_F(WeightsCache, QuickKindsAreNotKept) {
    options_.kind = WeightKind::harmonic;
    EXPECT_TRUE(computed_anew());
    EXPECT_FALSE(fs::exists(file_));
}

}  // namespace
}  // namespace puppetwarp
