// Automatic cages as handles of a rig.

#include "support/message_of.h"

#include <puppetwarp/mesh/automatic_cage.h>
#include <puppetwarp/rig/add_cage.h>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp {

namespace {

const Polyline& cage_of(const Rig& rig) {
    return std::get<CageHandle>(rig.handles.back().shape).points;
}

}  // namespace

TEST(AddCage, ComesLastUnderANameOfItsOwn) {
    Rig rig{{{"cage", PointHandle{{10, 10}, {}}}, {"cage2", PointHandle{{20, 10}, {}}}}, {}};
    add_automatic_cage(rig, rectangle_outline(640, 480), 10);
    ASSERT_EQ(rig.handles.size(), 3U);
    EXPECT_EQ(rig.handles.back().id, "cage3");
    EXPECT_EQ(cage_of(rig).size(), 10U);
    Rig empty;
    add_automatic_cage(empty, rectangle_outline(640, 480), 10);
    EXPECT_EQ(empty.handles.back().id, "cage");
}

TEST(AddCage, RoundsCornersToShortNumbers) {
    for (const double size : {1e-7, 0.003, 1.0, 37.0, 640.0, 1e6, 1e9}) {
        const Outline outline = rectangle_outline(size, 0.75 * size);
        Rig rig;
        add_automatic_cage(rig, outline, 10);
        const Polyline exact = automatic_cage(outline, 10);
        ASSERT_EQ(cage_of(rig).size(), exact.size());
        const double diagonal = 1.25 * size, step = std::pow(10.0, std::floor(std::log10(diagonal)) - 4);
        for (std::size_t k = 0; k < exact.size(); ++k) {
            const Point& corner = cage_of(rig)[k];
            EXPECT_LT((corner - exact[k]).norm(), 1e-4 * diagonal);
            for (const double x : {corner.x(), corner.y()}) EXPECT_NEAR(x / step, std::round(x / step), 1e-6) << size;
        }
    }
}

TEST(AddCage, RefusesASecondOne) {
    Rig rig{{{"hull", CageHandle{{{0, 0}, {9, 0}, {9, 9}}}}}, {}};
    EXPECT_EQ(message_of([&] { add_automatic_cage(rig, rectangle_outline(640, 480), 10); }),
              "automatic cage: there is the cage 'hull' already (leave one of them away)");
    EXPECT_EQ(rig.handles.size(), 1U);
}

}  // namespace puppetwarp
