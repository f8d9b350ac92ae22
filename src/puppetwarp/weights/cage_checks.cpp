#include <puppetwarp/weights/cage_checks.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/segment_grid.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/rig/region.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace puppetwarp {

namespace {

struct Cage {
    const std::string& id;
    const Polyline& points;
    Eigen::AlignedBox2d box;
};

std::vector<Cage> cages_of(const Rig& rig) {
    std::vector<Cage> cages;
    for (const Handle& handle : rig.handles) {
        const auto* cage = std::get_if<CageHandle>(&handle.shape);
        if (cage == nullptr) continue;
        cages.push_back({handle.id, cage->points, {}});
        for (const Point& corner : cage->points) cages.back().box.extend(corner);
    }
    return cages;
}

std::string place_text(const Point& p) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "(%.5g, %.5g)", p.x(), p.y());
    return text.data();
}

// Corners that no double can tell apart where they stand, or an area that is all round-off.
constexpr double no_size = 1e-9;

void require_corners(const Cage& cage) {
    const double size = cage.box.diagonal().norm();
    for (std::size_t k = 0; k < cage.points.size(); ++k) {
        const std::size_t next = (k + 1) % cage.points.size();
        if ((cage.points[next] - cage.points[k]).norm() > no_size * size) continue;
        throw InvalidInput("handle '" + cage.id + "'",
                           "corners " + std::to_string(k) + " and " + std::to_string(next) +
                               " of the cage are in one place, at " + place_text(cage.points[k]),
                           "remove one of them");
    }
    double area = 0;  // with what crosses itself, where shares of a signed area would cancel
    for (std::size_t k = 1; k + 1 < cage.points.size(); ++k) {
        const Point a = cage.points[k] - cage.points[0], b = cage.points[k + 1] - cage.points[0];
        area += std::abs(a.x() * b.y() - a.y() * b.x());
    }
    if (area <= no_size * size * size) {
        throw InvalidInput("handle '" + cage.id + "'", "the cage has no area", "draw it around the subject");
    }
}

// Cages that neither cross nor touch themselves or each other.
void require_apart(const std::vector<Cage>& cages) {
    std::vector<Segment> edges;
    std::vector<std::size_t> owner;
    for (std::size_t c = 0; c < cages.size(); ++c) {
        const Polyline& points = cages[c].points;
        for (std::size_t k = 0; k < points.size(); ++k) {
            edges.push_back({points[k], points[(k + 1) % points.size()]});
            owner.push_back(c);
        }
    }
    const auto refuse = [&](std::size_t one, std::size_t other, const Point& place) {
        if (owner[one] == owner[other]) {
            throw InvalidInput("handle '" + cages[owner[one]].id + "'",
                               "the cage crosses or touches itself at " + place_text(place),
                               "move its corners apart there");
        }
        throw InvalidInput("handles '" + cages[owner[one]].id + "' and '" + cages[owner[other]].id + "'",
                           "the cages cross or touch each other at " + place_text(place), "move them apart");
    };
    for (const auto& [one, other] : meeting_pairs(edges)) {
        refuse(one, other, meeting_point(edges[one], edges[other]));
    }
    // Edges that share an end exactly do not count as meeting: neighbours do, and others must not.
    for (std::size_t one = 0; one < edges.size(); ++one) {
        for (std::size_t other = 0; other < one; ++other) {
            if (edges[one].a == edges[other].a) refuse(other, one, edges[one].a);
        }
    }
}

// Farther away, numbers lose what the mesh is made of, or overflow.
void require_near(const TriangleMesh& mesh, const Cage& cage) {
    const Point middle = mesh.V.colwise().mean().transpose();
    const double farthest = farthest_move * bounding_diagonal(mesh.V);
    for (const Point& corner : cage.points) {
        if ((corner - middle).norm() <= farthest) continue;
        throw InvalidInput("handle '" + cage.id + "'", "the corner at " + place_text(corner) + " is too far away",
                           "stay within a million times the subject's size");
    }
}

void require_to_hold(const TriangleMesh& mesh, const Cage& cage) {
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if (cage.box.contains(p) && inside(cage.points, p)) return;
    }
    throw InvalidInput("handle '" + cage.id + "'",
                       "the cage leaves the subject outside: no vertex of the mesh lies in it",
                       "draw it around the subject, or around a part of it");
}

}  // namespace

void require_sound_cages(const TriangleMesh& mesh, const Rig& rig) {
    const std::vector<Cage> cages = cages_of(rig);
    for (const Cage& cage : cages) {
        require_near(mesh, cage);
        require_corners(cage);
    }
    require_apart(cages);
    for (const Cage& cage : cages) require_to_hold(mesh, cage);
}

void require_a_cage(const Rig& rig) {
    if (!cages_of(rig).empty()) return;
    throw InvalidInput("weights 'harmonic-cage'", "the rig has no cage", "add one, or use harmonic");
}

}  // namespace puppetwarp
