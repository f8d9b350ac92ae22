#pragma once

#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/sampling.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace puppetwarp::detail {

//! Pixels [x_first, x_last) x [y_first, y_last) of a picture; none when it has no width.
struct PixelBox {
    int x_first = 0, y_first = 0, x_last = 0, y_last = 0;
};

//! Means of 2 x 2, 4 x 4, ... pixels of a part of a picture, as binary32, colours multiplied by alpha; decoded for
//! linear light. At the picture's right and lower border they are the means of what there is.
class Pyramid {
public:
    //! One without levels.
    Pyramid() = default;
    //! \param box  what is asked for; the part is grown for filters that reach out of it.
    Pyramid(const Source& source, ReadPremultiplied read, const PixelBox& box, int levels);

    int top_level() const { return static_cast<int>(levels_.size()); }
    //! \param level  1 to `top_level()`.
    Source level(int level) const;
    ViewFrame frame(int level) const;

private:
    PixelBox box_;
    std::vector<cv::Mat> levels_;
};

//! The highest level that a picture can have: one pixel.
int highest_level(int width, int height);

}  // namespace puppetwarp::detail
