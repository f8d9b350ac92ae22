#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/write.h>

namespace puppetwarp {

//! PNG (3rd edition), packed by all threads in bands of fixed size: the bytes do not depend on the number of threads.
//! \param pixels  CV_8U or CV_16U, 1 to 4 channels. Written front to back, so that it may go into a pipe.
void write_png(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file);

}  // namespace puppetwarp
