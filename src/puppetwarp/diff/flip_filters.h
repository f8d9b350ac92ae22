#pragma once

#include <vector>

namespace puppetwarp {

//! One side of a separable filter: the weights from the middle outwards. Towards the other end they are the same, or of
//! an odd filter the same with another sign.
struct FilterSide {
    std::vector<float> weight;
    bool odd = false;

    int reach() const { return static_cast<int>(weight.size()) - 1; }
};

//! The filters of FLIP (Andersson et al. 2020) for an observer who sees so many pixels in a degree.
struct FlipFilters {
    explicit FlipFilters(double pixels_per_degree);

    //! Contrast sensitivity (section 4.1.1), sums of Gaussians that sum to 1: achromatic, red-green, and of blue-yellow
    //! two terms with their shares.
    FilterSide achromatic, red_green;
    FilterSide blue_yellow[2];
    float blue_yellow_share[2];
    //! Features (section 4.2): a Gaussian that sums to 1, its first and its second derivative, of which the positive
    //! weights sum to 1 and the negative ones to -1.
    FilterSide gauss, edge, point;
    int reach = 0;  //!< of the widest
};

//! Rows of floats, one after the other.
struct Plane {
    int width = 0, height = 0;
    std::vector<float> values;

    void resize(int new_width, int new_height);
    const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * width; }
    float* row(int y) { return values.data() + static_cast<std::size_t>(y) * width; }
};

//! Filters along y, then along x, and leaves out the margin: the result is 2 `margin` smaller than `from` along x and
//! y. \param margin   at least the reach of both.   \param scratch  whatever it holds is overwritten.
void filter(const Plane& from, int margin, const FilterSide& along_y, const FilterSide& along_x, Plane& scratch,
            Plane& to);
//! Both halves of it.
void filter_down(const Plane& from, int margin, const FilterSide& side, Plane& to);
void filter_across(const Plane& from, int margin, const FilterSide& side, Plane& to);

}  // namespace puppetwarp
