#include <puppetwarp/mesh/triangle_sides.h>

#include <cmath>

namespace puppetwarp {

namespace {

int next(int side) {
    return side % 3 == 2 ? side - 2 : side + 1;
}

// Where a side starts.
int corner(const Eigen::MatrixX3i& F, int side) {
    return F(side / 3, side % 3);
}

// Flips edges of triangles.
class Flipper {
public:
    Flipper(const Eigen::MatrixX2d& V, Eigen::MatrixX3i& F, std::vector<int>& opposite)
        : V_(V), F_(F), opposite_(opposite) {}

    void run() {
        for (int side = 0; side < static_cast<int>(opposite_.size()); ++side) {
            if (opposite_[static_cast<std::size_t>(side)] > side) open_.push_back(side);
            while (!open_.empty()) {
                const int one = open_.back();
                open_.pop_back();
                if (is_bad(one)) flip(one);
            }
        }
    }

private:
    int& opposite(int side) { return opposite_[static_cast<std::size_t>(side)]; }

    // Of the angle across from a side.
    double cotangent(int side) const {
        const auto at = [&](int s) { return Eigen::RowVector2d(V_.row(corner(F_, s))); };
        const Eigen::RowVector2d tip = at(next(next(side))), a = at(side) - tip, b = at(next(side)) - tip;
        return a.dot(b) / std::abs(a.x() * b.y() - a.y() * b.x());
    }

    bool is_bad(int side) {
        constexpr double round_off = 1e-9;
        const int other = opposite(side);
        return other >= 0 && cotangent(side) + cotangent(other) < -round_off;
    }

    void join(int side, int other) {
        opposite(side) = other;
        if (other >= 0) opposite(other) = side;
    }

    // Of triangles a b c and b a d, the edge a b becomes c d.
    void flip(int side) {
        const int other = opposite(side);
        const int a = corner(F_, side), b = corner(F_, other);
        const int c = corner(F_, next(next(side))), d = corner(F_, next(next(other)));
        const int beside_bc = opposite(next(side)), beside_ca = opposite(next(next(side)));
        const int beside_ad = opposite(next(other)), beside_db = opposite(next(next(other)));
        const int t = side / 3, u = other / 3;
        F_.row(t) << a, d, c;
        F_.row(u) << b, c, d;
        join(3 * t, beside_ad);
        join(3 * t + 1, 3 * u + 1);
        join(3 * t + 2, beside_ca);
        join(3 * u, beside_bc);
        join(3 * u + 2, beside_db);
        for (const int outer : {3 * t, 3 * t + 2, 3 * u, 3 * u + 2}) open_.push_back(outer);
    }

    const Eigen::MatrixX2d& V_;
    Eigen::MatrixX3i& F_;
    std::vector<int>& opposite_;
    std::vector<int> open_;  // sides to look at
};

}  // namespace

std::vector<int> opposite_sides(const Eigen::MatrixX3i& F, Eigen::Index vertices) {
    std::vector<int> start(static_cast<std::size_t>(F.size()));  // of each side
    for (Eigen::Index t = 0; t < F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) start[static_cast<std::size_t>(3 * t + k)] = F(t, k);
    }
    // Sides sorted by where they start, through counting.
    std::vector<int> first(static_cast<std::size_t>(vertices) + 1);
    for (const int v : start) ++first[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    struct Leaving {
        int side, to;
    };
    std::vector<Leaving> leaving(start.size());
    std::vector<int> filled(first.begin(), first.end() - 1);
    const auto end = [&](std::size_t side) { return start[side % 3 == 2 ? side - 2 : side + 1]; };
    for (std::size_t side = 0; side < start.size(); ++side) {
        const auto at = static_cast<std::size_t>(filled[static_cast<std::size_t>(start[side])]++);
        leaving[at] = {static_cast<int>(side), end(side)};
    }
    std::vector<int> opposite(start.size(), -1);
    for (std::size_t side = 0; side < start.size(); ++side) {
        const auto to = static_cast<std::size_t>(end(side));
        for (int k = first[to]; k < first[to + 1]; ++k) {
            const Leaving& other = leaving[static_cast<std::size_t>(k)];
            if (other.to == start[side]) opposite[side] = other.side;
        }
    }
    return opposite;
}

std::vector<std::pair<int, int>> boundary_edges(const TriangleMesh& mesh) {
    const std::vector<int> opposite = opposite_sides(mesh.F, mesh.V.rows());
    std::vector<std::pair<int, int>> lone;
    for (int side = 0; side < static_cast<int>(opposite.size()); ++side) {
        if (opposite[static_cast<std::size_t>(side)] >= 0) continue;
        lone.emplace_back(corner(mesh.F, side), corner(mesh.F, next(side)));
    }
    return lone;
}

Eigen::MatrixX3i with_delaunay_edges(const Eigen::MatrixX2d& V, Eigen::MatrixX3i F, std::vector<int>& opposite) {
    Flipper(V, F, opposite).run();
    return F;
}

}  // namespace puppetwarp
