#include "reference/test_meshes.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace puppetwarp::reference {

namespace {

TriangleMesh mesh_of(const std::vector<Point>& points, const std::vector<std::array<int, 3>>& triangles) {
    TriangleMesh mesh;
    mesh.V.resize(static_cast<Eigen::Index>(points.size()), 2);
    for (std::size_t i = 0; i < points.size(); ++i) mesh.V.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    mesh.F.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) mesh.F(static_cast<Eigen::Index>(t), k) = triangles[t][static_cast<std::size_t>(k)];
    }
    return mesh;
}

// Only the largest component, its vertices renumbered in their order.
TriangleMesh largest_part(const TriangleMesh& mesh) {
    const Eigen::VectorXi component = vertex_components(mesh);
    std::vector<int> sizes(static_cast<std::size_t>(component.maxCoeff()) + 1);
    for (int v = 0; v < component.size(); ++v) ++sizes[static_cast<std::size_t>(component(v))];
    const auto largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    std::vector<int> slot(static_cast<std::size_t>(mesh.V.rows()), -1);
    std::vector<Point> points;
    for (int v = 0; v < component.size(); ++v) {
        if (component(v) != largest) continue;
        slot[static_cast<std::size_t>(v)] = static_cast<int>(points.size());
        points.push_back(mesh.V.row(v).transpose());
    }
    std::vector<std::array<int, 3>> triangles;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        if (component(mesh.F(t, 0)) != largest) continue;
        std::array<int, 3> triangle{};
        for (int k = 0; k < 3; ++k) {
            triangle[static_cast<std::size_t>(k)] = slot[static_cast<std::size_t>(mesh.F(t, k))];
        }
        triangles.push_back(triangle);
    }
    return mesh_of(points, triangles);
}

}  // namespace

TriangleMesh grid(int nx, int ny, double width, double height, double jitter, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto offset = [&] { return 2.0 * (static_cast<double>(random()) / 4294967296.0) - 1.0; };
    std::vector<Point> points;
    for (int j = 0; j <= ny; ++j) {
        for (int i = 0; i <= nx; ++i) {
            Point p(i * width / nx, j * height / ny);
            if (i > 0 && i < nx && j > 0 && j < ny) {
                p.x() += jitter * width / nx * offset();
                p.y() += jitter * height / ny * offset();
            }
            points.push_back(p);
        }
    }
    std::vector<std::array<int, 3>> triangles;
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
            if ((i + j) % 2 == 0) {
                triangles.push_back({a, b, d});
                triangles.push_back({a, d, c});
            } else {
                triangles.push_back({a, b, c});
                triangles.push_back({b, d, c});
            }
        }
    }
    return mesh_of(points, triangles);
}

TriangleMesh annulus(int rings, int sectors, double inner, double outer) {
    std::vector<Point> points;
    for (int r = 0; r <= rings; ++r) {
        const double radius = inner * std::pow(outer / inner, static_cast<double>(r) / rings);
        for (int s = 0; s < sectors; ++s) {
            const double angle = 2 * std::numbers::pi * s / sectors;
            points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
        }
    }
    std::vector<std::array<int, 3>> triangles;
    for (int r = 0; r < rings; ++r) {
        for (int s = 0; s < sectors; ++s) {
            const int a = r * sectors + s, b = r * sectors + (s + 1) % sectors;
            const int c = a + sectors, d = b + sectors;
            triangles.push_back({a, c, d});
            triangles.push_back({a, d, b});
        }
    }
    return mesh_of(points, triangles);
}

TriangleMesh shape(const std::function<bool(double, double)>& inside, double size, double edge, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto offset = [&] { return 2.0 * (static_cast<double>(random()) / 4294967296.0) - 1.0; };
    const double row_height = edge * std::sqrt(3.0) / 2;
    const int nx = static_cast<int>(size / edge) + 3;
    const int ny = static_cast<int>(size / row_height) + 3;
    const auto id = [&](int i, int j) { return j * nx + i; };
    std::vector<Point> points;
    std::vector<bool> in;
    for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
            const Point p((i - 1 + 0.5 * (j % 2) + 0.2 * offset()) * edge,
                          (j - 1) * row_height + 0.2 * edge * offset());
            points.push_back(p);
            in.push_back(inside(p.x(), p.y()));
        }
    }
    std::vector<std::array<int, 3>> triangles;
    const auto add = [&](int a, int b, int c) {
        const auto holds = [&](int v) { return static_cast<bool>(in[static_cast<std::size_t>(v)]); };
        if (holds(a) && holds(b) && holds(c)) triangles.push_back({a, b, c});
    };
    for (int j = 0; j + 1 < ny; ++j) {
        for (int i = 0; i + 1 < nx; ++i) {
            const int a = id(i, j), b = id(i + 1, j), c = id(i, j + 1), d = id(i + 1, j + 1);
            if (j % 2 == 0) {
                add(a, b, c);
                add(b, d, c);
            } else {
                add(a, b, d);
                add(a, d, c);
            }
        }
    }
    return largest_part(mesh_of(points, triangles));
}

TriangleMesh figure(double size, double edge) {
    struct Capsule {
        double ax, ay, bx, by, radius;
    };
    static constexpr std::array<Capsule, 9> capsules{{{0.5, 0.70, 0.5, 0.40, 0.13},
                                                      {0.5, 0.17, 0.5, 0.15, 0.11},
                                                      {0.5, 0.40, 0.5, 0.17, 0.05},
                                                      {0.45, 0.38, 0.12, 0.28, 0.055},
                                                      {0.55, 0.38, 0.88, 0.45, 0.055},
                                                      {0.45, 0.73, 0.33, 0.93, 0.065},
                                                      {0.55, 0.73, 0.70, 0.93, 0.065},
                                                      {0.12, 0.28, 0.05, 0.14, 0.04},
                                                      {0.88, 0.45, 0.95, 0.58, 0.04}}};
    const auto inside = [size](double x, double y) {
        x /= size;
        y /= size;
        return std::any_of(capsules.begin(), capsules.end(), [&](const Capsule& c) {
            const double dx = c.bx - c.ax, dy = c.by - c.ay;
            const double t = std::clamp(((x - c.ax) * dx + (y - c.ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            return std::hypot(x - c.ax - t * dx, y - c.ay - t * dy) < c.radius;
        });
    };
    return shape(inside, size, edge);
}

TriangleMesh blob(double size, double edge, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::array<double, 4> amplitude{}, phase{};
    for (std::size_t k = 0; k < 4; ++k) {
        amplitude[k] = 0.25 * uniform() / static_cast<double>(k + 1);
        phase[k] = 2 * std::numbers::pi * uniform();
    }
    const auto inside = [=](double x, double y) {
        const double angle = std::atan2(y - size / 2, x - size / 2);
        double radius = 0.32;
        for (std::size_t k = 0; k < 4; ++k)
            radius += 0.32 * amplitude[k] * std::sin(static_cast<double>(k + 2) * angle + phase[k]);
        return std::hypot(x - size / 2, y - size / 2) < radius * size;
    };
    return shape(inside, size, edge, seed);
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b, const Point& offset) {
    TriangleMesh both;
    both.V.resize(a.V.rows() + b.V.rows(), 2);
    both.V << a.V, b.V.rowwise() + offset.transpose();
    both.F.resize(a.F.rows() + b.F.rows(), 3);
    both.F << a.F, (b.F.array() + static_cast<int>(a.V.rows())).matrix();
    return both;
}

int nearest_vertex(const TriangleMesh& mesh, const Point& p) {
    Eigen::Index nearest = 0;
    (mesh.V.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    return static_cast<int>(nearest);
}

Rig rig_of_points(const std::vector<Point>& places) {
    Rig rig;
    for (std::size_t i = 0; i < places.size(); ++i) {
        rig.handles.push_back({std::string("p").append(std::to_string(i)), PointHandle{places[i], {}}});
    }
    return rig;
}

Rig rig_of_vertices(const std::vector<int>& indices) {
    Rig rig;
    for (std::size_t i = 0; i < indices.size(); ++i) {
        rig.handles.push_back({vertex_id(i), VertexHandle{indices[i]}});
    }
    return rig;
}

std::string vertex_id(std::size_t k) {
    return std::string("v").append(std::to_string(k));
}

std::complex<double> mean_turn(const TriangleMesh& mesh, const Eigen::MatrixX2d& moved, const Point& at,
                               double radius) {
    std::complex<double> sum = 0;
    double area = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const Point centroid =
            (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))).transpose() / 3;
        const double share = (centroid - at).norm() / radius;
        if (share > 1) continue;
        Eigen::Matrix2d rest, now;
        for (int k = 0; k < 2; ++k) {
            rest.col(k) = (mesh.V.row(mesh.F(t, k + 1)) - mesh.V.row(mesh.F(t, 0))).transpose();
            now.col(k) = (moved.row(mesh.F(t, k + 1)) - moved.row(mesh.F(t, 0))).transpose();
        }
        const Eigen::Matrix2d J = now * rest.inverse();
        const double weight = std::abs(rest.determinant()) * std::pow(1 - share * share, 2);
        sum += weight * std::complex<double>(J(0, 0) + J(1, 1), J(1, 0) - J(0, 1)) / 2.0;
        area += weight;
    }
    return sum / area;
}

Point rigid(const Point& p, const Point& centre, double angle_rad, const Point& move) {
    return centre + move + Eigen::Rotation2Dd(angle_rad) * (p - centre);
}

}  // namespace puppetwarp::reference
