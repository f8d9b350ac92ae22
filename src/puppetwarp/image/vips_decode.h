#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/image/read.h>

#include <puppetwarp/image/normalise.h>
#include <puppetwarp/image/picture_file.h>

#include <string>

namespace puppetwarp {

//! A picture file that libvips knows, its header read and checked; pixels come with `decode`, once.
class VipsPicture {
public:
    //! \throw InvalidInput  not a picture, damaged header, over `max_pixels`.
    VipsPicture(const PictureFile& file, const ReadOptions& options);

    ImageInfo info() const;
    //! \param file  the one that this was made from.
    Image decode(const PictureFile& file) const;

private:
    cv::Mat pixels(const PictureFile& file) const;

    std::string name_;
    VipsImagePtr stored_;  // as in the file
    NormalisedPicture picture_;
    ImageMetadata metadata_;  // EXIF as in the file
    std::string format_;
    int orientation_ = 1;
};

//! \throw InvalidInput  over the limit: says the size and what to do.
void require_size(const std::string& name, int width, int height, const ReadOptions& options);

//! \throw InvalidInput  always: the file ends early, or its content contradicts itself.
[[noreturn]] void throw_damaged(const std::string& name, const std::string& detail);

//! An uninitialised matrix. \throw MachineFault  out of memory.
cv::Mat allocate(const std::string& name, int width, int height, int type);

}  // namespace puppetwarp
