#include <puppetwarp/mesh/nesting.h>

#include <algorithm>
#include <climits>

namespace puppetwarp {

namespace {

constexpr int none = -1;

// A contour's passage through a row of nodes, between two neighbours in it.
struct Passage {
    int row, column;  // of the left neighbour
    int contour;
    friend bool operator<(const Passage& a, const Passage& b) {
        return a.row != b.row ? a.row < b.row : a.column != b.column ? a.column < b.column : a.contour < b.contour;
    }
};

// The contour that is directly around each one, or none.
std::vector<int> surrounding(const std::vector<Contour>& contours, const std::vector<bool>& is_hole) {
    std::vector<Passage> passages;
    std::vector<Passage> topmost(contours.size());
    for (std::size_t k = 0; k < contours.size(); ++k) {
        topmost[k] = {INT_MAX, INT_MAX, static_cast<int>(k)};
        for (const Crossing& crossing : contours[k]) {
            if (crossing.way & 1U) continue;
            const Passage passage{crossing.j, crossing.way == 0 ? crossing.i : crossing.i - 1, static_cast<int>(k)};
            passages.push_back(passage);
            topmost[k] = std::min(topmost[k], passage);
        }
    }
    std::sort(passages.begin(), passages.end());
    // What is left of a contour's topmost, leftmost passage starts further up or left: go in that order.
    std::sort(topmost.begin(), topmost.end());
    std::vector<int> around(contours.size(), none);
    for (const Passage& top : topmost) {
        const auto at = std::lower_bound(passages.begin(), passages.end(), top);
        if (at == passages.begin() || std::prev(at)->row != top.row) continue;
        const int left = std::prev(at)->contour;
        const bool same_kind =
            is_hole[static_cast<std::size_t>(left)] == is_hole[static_cast<std::size_t>(top.contour)];
        around[static_cast<std::size_t>(top.contour)] = same_kind ? around[static_cast<std::size_t>(left)] : left;
    }
    return around;
}

}  // namespace

Outline nested(const std::vector<Contour>& contours, std::vector<Polyline> polygons, double min_hole_area) {
    const std::size_t count = contours.size();
    std::vector<double> areas;
    std::vector<bool> is_hole;
    for (const Polyline& polygon : polygons) {
        areas.push_back(signed_area(polygon));
        is_hole.push_back(areas.back() < 0);
    }
    const std::vector<int> around = surrounding(contours, is_hole);
    const auto filled = [&](std::size_t contour) {
        for (int k = static_cast<int>(contour); k != none; k = around[static_cast<std::size_t>(k)]) {
            if (is_hole[static_cast<std::size_t>(k)] && -areas[static_cast<std::size_t>(k)] < min_hole_area)
                return true;
        }
        return false;
    };
    Outline outline;
    std::vector<std::size_t> component_of(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
        if (is_hole[k] || filled(k)) continue;
        component_of[k] = outline.components.size();
        outline.components.push_back({std::move(polygons[k]), {}});
    }
    for (std::size_t k = 0; k < count; ++k) {
        if (!is_hole[k] || around[k] == none || filled(k)) continue;
        const std::size_t component = component_of[static_cast<std::size_t>(around[k])];
        outline.components[component].holes.push_back(std::move(polygons[k]));
    }
    return outline;
}

}  // namespace puppetwarp
