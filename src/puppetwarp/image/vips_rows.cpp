#include <puppetwarp/image/vips_rows.h>

#include <puppetwarp/base/errors.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstring>

namespace puppetwarp {

namespace {

constexpr int block_rows = 256;

}  // namespace

VipsRows::VipsRows(const PictureRows& picture) : picture_(picture), image_(vips_image_new()) {
    const VipsPixelType type = vips_pixel_type(picture.type);
    vips_image_init_fields(image_.get(), picture.width, picture.height, CV_MAT_CN(picture.type), type.format,
                           VIPS_CODING_NONE, type.interpretation, 1, 1);
    if (vips_image_pipelinev(image_.get(), VIPS_DEMAND_STYLE_THINSTRIP, nullptr) != 0 ||
        vips_image_generate(image_.get(), nullptr, generate, nullptr, this, nullptr) != 0)
        throw MachineFault("libvips", "cannot take a picture: " + take_vips_error());
}

int VipsRows::generate(VipsRegion* piece, void* /*sequence*/, void* self, void* /*unused*/, gboolean* /*stop*/) {
    auto& source = *static_cast<VipsRows*>(self);
    const std::lock_guard lock(source.mutex_);
    try {
        // A saver's other threads still ask after the first failure; one reason is enough.
        if (source.failure_) return -1;
        source.copy_rows(piece);
        return 0;
    } catch (...) {
        source.failure_ = std::current_exception();
        return -1;
    }
}

void VipsRows::copy_rows(VipsRegion* piece) {
    const VipsRect& area = piece->valid;
    for (int row = area.top; row < area.top + area.height; ++row) {
        const cv::Mat& rows = block(row / block_rows);
        const std::size_t pixel_bytes = rows.elemSize();
        std::memcpy(VIPS_REGION_ADDR(piece, area.left, row),
                    rows.ptr(row % block_rows) + static_cast<std::size_t>(area.left) * pixel_bytes,
                    static_cast<std::size_t>(area.width) * pixel_bytes);
    }
}

const cv::Mat& VipsRows::block(int number) {
    Block& block = blocks_[static_cast<std::size_t>(number % 2)];
    if (block.number != number) {
        const int first = number * block_rows;
        block.number = -1;
        block.rows = picture_.rows(first, std::min(picture_.height, first + block_rows));
        block.number = number;
    }
    return block.rows;
}

}  // namespace puppetwarp
