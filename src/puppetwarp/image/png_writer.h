#pragma once

#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/image/write.h>

#include <functional>
#include <string>
#include <string_view>

namespace puppetwarp {

//! Takes the next bytes of a file.
using ByteSink = std::function<void(std::string_view)>;

//! PNG (3rd edition), packed by all threads in bands of fixed size: the bytes do not depend on the number of threads.
//! \param picture  CV_8U or CV_16U, 1 to 4 channels. Written front to back, so that it may go into a pipe.
void write_png(const PictureRows& picture, const WriteOptions& options, const ByteSink& sink);

//! The bytes of a whole PNG. \param pixels  as above.
std::string png_bytes(const cv::Mat& pixels, const WriteOptions& options);

}  // namespace puppetwarp
