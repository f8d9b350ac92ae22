#pragma once

#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/image/vips_output.h>
#include <puppetwarp/image/vips_session.h>

#include <opencv2/core/mat.hpp>

#include <array>
#include <exception>
#include <mutex>

namespace puppetwarp {

//! Rows as a picture of libvips, whose threads ask for pieces of them while a saver runs.
class VipsRows {
public:
    //! \param picture  must live as long as this.
    explicit VipsRows(const PictureRows& picture);
    VipsRows(const VipsRows&) = delete;
    VipsRows& operator=(const VipsRows&) = delete;

    VipsImage* image() const { return image_.get(); }
    //! Throws what making the rows threw, when it did: the reason why a saver failed.
    void rethrow_failure() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    static int generate(VipsRegion* piece, void* sequence, void* self, void* unused, gboolean* stop);
    void copy_rows(VipsRegion* piece);
    const cv::Mat& block(int number);

    // Pieces are a few rows high, and come almost in order: the threads are never further apart than two blocks.
    struct Block {
        int number = -1;
        cv::Mat rows;
    };

    const PictureRows& picture_;
    VipsImagePtr image_;
    std::mutex mutex_;
    std::array<Block, 2> blocks_;  // even and odd ones
    std::exception_ptr failure_;
};

}  // namespace puppetwarp
