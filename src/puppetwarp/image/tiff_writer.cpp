#include <puppetwarp/image/tiff_writer.h>

#include <puppetwarp/image/vips_output.h>
#include <puppetwarp/image/vips_rows.h>

#include <cstdint>
#include <vector>

namespace puppetwarp {

namespace {

void attach(VipsImage* image, const char* field, const std::vector<std::uint8_t>& bytes) {
    if (!bytes.empty()) vips_image_set_blob_copy(image, field, bytes.data(), bytes.size());
}

}  // namespace

void write_tiff(const PictureRows& picture, const WriteOptions& options, OutputFile& file) {
    require_vips();
    const VipsRows rows(picture);
    VipsImage* image = rows.image();
    const ImageMetadata& metadata = picture.metadata;
    attach(image, VIPS_META_ICC_NAME, metadata.icc);
    attach(image, VIPS_META_XMP_NAME, metadata.xmp);
    if (metadata.x_pixels_per_mm > 0 && metadata.y_pixels_per_mm > 0) {
        image->Xres = metadata.x_pixels_per_mm;
        image->Yres = metadata.y_pixels_per_mm;
    }
    // A classic TIFF ends at 4 GB; half of it leaves room for incompressible data and the predictor's tables.
    const std::uint64_t pixels = static_cast<std::uint64_t>(picture.width) * static_cast<std::uint64_t>(picture.height);
    const bool big = pixels * CV_ELEM_SIZE(picture.type) > (std::uint64_t{1} << 31);
    const bool floats = CV_MAT_DEPTH(picture.type) == CV_32F;
    const VipsOutput output(file);
    const int status = vips_tiffsave_target(
        image, output.target(), "compression",
        options.compression == 0 ? VIPS_FOREIGN_TIFF_COMPRESSION_NONE : VIPS_FOREIGN_TIFF_COMPRESSION_DEFLATE,
        "predictor", floats ? VIPS_FOREIGN_TIFF_PREDICTOR_FLOAT : VIPS_FOREIGN_TIFF_PREDICTOR_HORIZONTAL, "bigtiff",
        static_cast<gboolean>(big), nullptr);
    rows.rethrow_failure();
    output.finish(status);
}

}  // namespace puppetwarp
