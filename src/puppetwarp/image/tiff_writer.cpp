#include <puppetwarp/image/tiff_writer.h>

#include <puppetwarp/image/vips_output.h>

#include <cstdint>

namespace puppetwarp {

namespace {

void attach(VipsImage* image, const char* field, const std::vector<std::uint8_t>& bytes) {
    if (!bytes.empty()) vips_image_set_blob_copy(image, field, bytes.data(), bytes.size());
}

}  // namespace

void write_tiff(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file) {
    require_vips();
    const VipsImagePtr image = vips_view(pixels);
    attach(image.get(), VIPS_META_ICC_NAME, metadata.icc);
    attach(image.get(), VIPS_META_XMP_NAME, metadata.xmp);
    if (metadata.x_pixels_per_mm > 0 && metadata.y_pixels_per_mm > 0) {
        image->Xres = metadata.x_pixels_per_mm;
        image->Yres = metadata.y_pixels_per_mm;
    }
    // A classic TIFF ends at 4 GB; half of it leaves room for incompressible data and the predictor's tables.
    const bool big = pixels.total() * pixels.elemSize() > (std::uint64_t{1} << 31);
    const bool floats = pixels.depth() == CV_32F;
    const VipsOutput output(file);
    output.finish(vips_tiffsave_target(
        image.get(), output.target(), "compression",
        options.compression == 0 ? VIPS_FOREIGN_TIFF_COMPRESSION_NONE : VIPS_FOREIGN_TIFF_COMPRESSION_DEFLATE,
        "predictor", floats ? VIPS_FOREIGN_TIFF_PREDICTOR_FLOAT : VIPS_FOREIGN_TIFF_PREDICTOR_HORIZONTAL, "bigtiff",
        static_cast<gboolean>(big), nullptr));
}

}  // namespace puppetwarp
