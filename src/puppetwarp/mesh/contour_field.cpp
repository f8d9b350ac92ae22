#include <puppetwarp/mesh/contour_field.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <new>

namespace puppetwarp {

namespace {

// One bit a node: the contour that has its outside to the left of this node has been followed.
class NodeMarks {
public:
    explicit NodeMarks(const ContourField& field)
        : columns_(static_cast<std::size_t>(field.columns())),
          words_((columns_ * static_cast<std::size_t>(field.rows()) + 63) / 64) {}
    bool marked(int i, int j) const { return (words_[word(i, j)] >> bit(i, j)) & 1U; }
    void mark(int i, int j) { words_[word(i, j)] |= std::uint64_t{1} << bit(i, j); }

private:
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * columns_ + static_cast<std::size_t>(i);
    }
    std::size_t word(int i, int j) const { return index(i, j) / 64; }
    unsigned bit(int i, int j) const { return static_cast<unsigned>(index(i, j) % 64); }

    std::size_t columns_;
    std::vector<std::uint64_t> words_;
};

Crossing crossing_between(const ContourField& field, int i, int j, std::uint8_t way) {
    const float in = field.row(j)[i];
    const float out = ContourField::value(field.row(j + grid_steps[way][1])[i + grid_steps[way][0]]);
    return {i, j, way, in / (in - out)};
}

// Walks round with the inside on the right hand of the screen's view, that is with positive area in image space:
// the outside lies to the `way` of the inside node, the walk goes a quarter turn clockwise from there (on screen).
Contour follow(const ContourField& field, int i, int j, NodeMarks& marks) {
    Contour contour;
    std::uint8_t way = 2;
    const int first_i = i, first_j = j;
    do {
        contour.push_back(crossing_between(field, i, j, way));
        if (way == 2) marks.mark(i, j);
        const std::uint8_t ahead = (way + 1) & 3U;
        const int di = grid_steps[ahead][0], dj = grid_steps[ahead][1];
        const int oi = grid_steps[way][0], oj = grid_steps[way][1];
        if (!field.inside(i + di, j + dj)) {
            way = ahead;  // round the corner of this node; a diagonal neighbour stays apart
        } else if (!field.inside(i + di + oi, j + dj + oj)) {
            i += di;
            j += dj;
        } else {
            i += di + oi;
            j += dj + oj;
            way = (way + 3) & 3U;
        }
    } while (i != first_i || j != first_j || way != 2);
    return contour;
}

// Whether eight nodes are surely on the same side as the one before them.
bool eight_like(std::int8_t before, const std::int8_t* nodes) {
    constexpr std::uint64_t top_bits = 0x8080808080808080U;
    std::uint64_t eight = 0;
    std::memcpy(&eight, nodes, sizeof(eight));
    const std::uint64_t negative = eight & top_bits;
    if (before <= 0) return eight == 0 || negative == top_bits;
    return negative == 0 && ((eight + ~top_bits) & top_bits) == top_bits;
}

}  // namespace

ContourField::ContourField(double x0, double y0, int columns, int rows)
    : x0_(x0),
      y0_(y0),
      columns_(columns),
      rows_(rows),
      values_(
          static_cast<std::int8_t*>(std::calloc(static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)))) {
    assert(columns >= 3 && rows >= 3);
    if (!values_) throw std::bad_alloc();
}

Point crossing_point(const ContourField& field, const Crossing& crossing, double at) {
    return {field.x0() + crossing.i + at * grid_steps[crossing.way][0],
            field.y0() + crossing.j + at * grid_steps[crossing.way][1]};
}

std::vector<Contour> trace_contours(const ContourField& field) {
    std::vector<Contour> contours;
    NodeMarks marks(field);
    for (int j = 1; j + 1 < field.rows(); ++j) {
        const std::int8_t* row = field.row(j);
        int i = 1;
        while (i + 1 < field.columns()) {
            if (i + 8 < field.columns() && eight_like(row[i - 1], row + i)) {
                i += 8;
                continue;
            }
            const int end = std::min(i + 8, field.columns() - 1);
            for (; i < end; ++i) {
                if (row[i - 1] <= 0 && row[i] > 0 && !marks.marked(i, j))
                    contours.push_back(follow(field, i, j, marks));
            }
        }
    }
    return contours;
}

}  // namespace puppetwarp
