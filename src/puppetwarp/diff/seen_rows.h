#pragma once

#include <puppetwarp/diff/measure.h>

#include <vector>

namespace puppetwarp {

//! Colours as a person sees them, of a part of a row: one plane of values 0 to 1 for each of R, G and B (of grey one
//! plane), gamma as in the file, values beyond 0 to 1 cut off.
struct SeenRow {
    std::vector<float> planes;
    int planes_count = 1;  //!< 1 or 3
    int width = 0;

    const float* plane(int index) const { return planes.data() + static_cast<std::size_t>(index) * width; }
    float* plane(int index) { return planes.data() + static_cast<std::size_t>(index) * width; }
};

//! The backgrounds that two pictures are to be seen over: black and white where some pixel is transparent and alpha is
//! not ignored, else one, which does not matter.
std::vector<float> backgrounds_of(const AlignedPair& pair);

//! Rows of both pictures as a person sees them. What is not selected is the expected picture's in both; NaN is 0 in
//! both where both have it, else as different as can be. One object a thread; the pair must outlive it.
class SeenRows {
public:
    SeenRows(const AlignedPair& pair, float background);

    //! Reads columns [first, last) of row y.
    void read(int y, int first, int last);
    const SeenRow& expected() const { return expected_; }
    const SeenRow& actual() const { return actual_; }

private:
    const AlignedPair& pair_;
    float background_;
    SeenRow expected_;
    SeenRow actual_;
};

}  // namespace puppetwarp
