#include <puppetwarp/weights/weight_text.h>

#include "cages.h"
#include "reference/test_meshes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <sstream>

namespace puppetwarp {
namespace {

using testing::ElementsAre;

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::vector<double> numbers_of(const std::string& line) {
    std::vector<double> numbers;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) numbers.push_back(std::strtod(cell.c_str(), nullptr));
    return numbers;
}

// Three vertices, a point and a bone, in this order.
class WeightText : public testing::Test {
protected:
    WeightText() {
        rig.handles = {{"hand", PointHandle{{0, 0}, {}}}, {"arm", BoneHandle{{1, 0}, {2, 0}, ""}}};
        weights.columns = {{0, -1}, {1, -1}};
        weights.W.resize(3, 2);
        weights.W << 1, 0, 1.0 / 3, 2.0 / 3, 0, 1;
    }

    Rig rig;
    Weights weights;
};

TEST_F(WeightText, IsAHeaderOfIdsAndARowAVertex) {
    EXPECT_THAT(lines_of(weights_csv(rig, weights)),
                ElementsAre("hand,arm", "1,0", "0.33333333333333331,0.66666666666666663", "0,1"));
    EXPECT_EQ(weights_csv(rig, weights).back(), '\n');
}

// As libigl's writeDMAT has it: columns before rows, then column by column, a value a line.
TEST_F(WeightText, DmatIsColumnByColumn) {
    EXPECT_EQ(weights_dmat(weights), "2 3\n1\n0.33333333333333331\n0\n0\n0.66666666666666663\n1\n");
}

TEST_F(WeightText, NumbersComeBackToTheBit) {
    const std::vector<double> values{0.1,   1e-300,      std::numeric_limits<double>::denorm_min(),
                                     -1e-9, 1 - 0x1p-53, 0.7000000000000001};
    weights.W = Eigen::Map<const Eigen::MatrixXd>(values.data(), 3, 2);
    const std::vector<std::string> rows = lines_of(weights_csv(rig, weights));
    const std::vector<std::string> entries = lines_of(weights_dmat(weights));
    for (Eigen::Index v = 0; v < 3; ++v) {
        for (Eigen::Index c = 0; c < 2; ++c) {
            EXPECT_EQ(numbers_of(rows.at(static_cast<std::size_t>(v) + 1)).at(static_cast<std::size_t>(c)),
                      weights.W(v, c));
            EXPECT_EQ(std::strtod(entries.at(static_cast<std::size_t>(1 + c * 3 + v)).c_str(), nullptr),
                      weights.W(v, c));
        }
    }
}

// RFC 4180, sections 2.5 to 2.7.
TEST_F(WeightText, IdsAreQuotedWhereTheyWouldBreakTheTable) {
    rig.handles[0].id = "left, lower";
    rig.handles[1].id = "the \"arm\"";
    EXPECT_EQ(lines_of(weights_csv(rig, weights)).front(), R"("left, lower","the ""arm""")");
    rig.handles[0].id = "two\nlines";
    rig.handles[1].id = "plain id";
    EXPECT_TRUE(weights_csv(rig, weights).starts_with("\"two\nlines\",plain id\n"));
}

TEST_F(WeightText, CornersOfCagesStandAmongTheOthersInTheRigsOrder) {
    rig.handles = {
        {"a", PointHandle{{0, 0}, {}}}, {"hull", CageHandle{{{0, 0}, {1, 0}, {0, 1}}}}, {"b", PointHandle{{1, 1}, {}}}};
    weights.columns = {{0, -1}, {1, 0}, {1, 1}, {1, 2}, {2, -1}};
    weights.W = Eigen::MatrixXd::Zero(1, 5);
    EXPECT_THAT(weight_headers(rig, weights), ElementsAre("a", "hull[0]", "hull[1]", "hull[2]", "b"));
    EXPECT_EQ(weights_csv(rig, weights), "a,hull[0],hull[1],hull[2],b\n0,0,0,0,0\n");
}

// Green coordinates reproduce the rest pose: what is read back from the text must do so too, real and imaginary parts
// in the places that the header says.
TEST_F(WeightText, ComplexWeightsAreReadBackAsWhatTheyAre) {
    const TriangleMesh mesh = reference::grid(4, 3, 40, 30);
    const Polyline cage = tests::star({20, 15}, 5, 40, 50, 3);
    rig.handles = {tests::cage_handle("hull", cage)};
    Progress progress;
    weights = compute_weights(mesh, rig, {.kind = WeightKind::green}, progress);
    const std::vector<std::string> lines = lines_of(weights_csv(rig, weights));
    ASSERT_EQ(lines.size(), static_cast<std::size_t>(mesh.V.rows()) + 1);
    EXPECT_TRUE(lines.front().starts_with("hull[0].re,hull[0].im,hull[1].re,"));
    const std::vector<std::string> entries = lines_of(weights_dmat(weights));
    EXPECT_EQ(entries.front(), "10 20");
    ASSERT_EQ(entries.size(), 201u);
    for (std::size_t v = 0; v < 20; ++v) {
        const std::vector<double> row = numbers_of(lines[v + 1]);
        ASSERT_EQ(row.size(), 10u);
        tests::Complex z = 0;
        for (std::size_t k = 0; k < 5; ++k) {
            z += tests::Complex(row[2 * k], row[2 * k + 1]) * tests::complex(cage[k]);
            EXPECT_EQ(std::strtod(entries[1 + (2 * k + 1) * 20 + v].c_str(), nullptr), row[2 * k + 1]);
        }
        EXPECT_NEAR(std::abs(z - tests::complex(mesh.V.row(static_cast<Eigen::Index>(v)).transpose())), 0, 1e-10);
    }
}

}  // namespace
}  // namespace puppetwarp
