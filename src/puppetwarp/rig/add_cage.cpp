#include <puppetwarp/rig/add_cage.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/automatic_cage.h>

#include <Eigen/Geometry>

#include <cmath>
#include <string>
#include <utility>

namespace puppetwarp {

namespace {

// Numbers of as many decimals as it takes to tell a ten-thousandth of the diagonal.
void shorten(Polyline& points) {
    Eigen::AlignedBox2d box;
    for (const Point& p : points) box.extend(p);
    const double decimals = 4 - std::floor(std::log10(box.diagonal().norm()));
    // Powers of ten with a negative exponent are not exact: then, the other is.
    const double ten = std::pow(10.0, std::abs(decimals));
    const auto round = [&](double x) { return decimals >= 0 ? std::round(x * ten) / ten : std::round(x / ten) * ten; };
    for (Point& p : points) p = {round(p.x()), round(p.y())};
}

void require_no_cage(const Rig& rig) {
    for (const Handle& handle : rig.handles) {
        if (!std::holds_alternative<CageHandle>(handle.shape)) continue;
        throw InvalidInput("automatic cage", "there is the cage '" + handle.id + "' already", "leave one of them away");
    }
}

template <class Subject>
void add_cage(Rig& rig, const Subject& subject, int corners) {
    require_no_cage(rig);
    Polyline cage = automatic_cage(subject, corners);
    shorten(cage);
    std::string id = "cage";
    for (int number = 2; find_handle(rig, id) != nullptr; ++number) id = "cage" + std::to_string(number);
    rig.handles.push_back({id, CageHandle{std::move(cage)}});
}

}  // namespace

void add_automatic_cage(Rig& rig, const Outline& subject, int corners) {
    add_cage(rig, subject, corners);
}

void add_automatic_cage(Rig& rig, const TriangleMesh& subject, int corners) {
    add_cage(rig, subject, corners);
}

}  // namespace puppetwarp
