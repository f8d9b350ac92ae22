#include <puppetwarp/image/tiff_writer.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/image/vips_output.h>

#include <cstdint>
#include <cstring>
#include <exception>
#include <mutex>

namespace puppetwarp {

namespace {

void attach(VipsImage* image, const char* field, const std::vector<std::uint8_t>& bytes) {
    if (!bytes.empty()) vips_image_set_blob_copy(image, field, bytes.data(), bytes.size());
}

// As every TIFF of ours is: compressed, with a predictor for its numbers.
void save(VipsImage* image, bool floats, std::uint64_t bytes, const WriteOptions& options, const VipsOutput& output) {
    // A classic TIFF ends at 4 GB; half of it leaves room for incompressible data and the predictor's tables.
    const bool big = bytes > (std::uint64_t{1} << 31);
    output.finish(vips_tiffsave_target(
        image, output.target(), "compression",
        options.compression == 0 ? VIPS_FOREIGN_TIFF_COMPRESSION_NONE : VIPS_FOREIGN_TIFF_COMPRESSION_DEFLATE,
        "predictor", floats ? VIPS_FOREIGN_TIFF_PREDICTOR_FLOAT : VIPS_FOREIGN_TIFF_PREDICTOR_HORIZONTAL, "bigtiff",
        static_cast<gboolean>(big), nullptr));
}

// Rows on demand for libvips, whose threads ask for pieces of them.
class RowSource {
public:
    RowSource(int width, int height, int channels, const FillRows& fill)
        : width_(width), channels_(channels), fill_(fill), image_(vips_image_new()) {
        vips_image_init_fields(image_.get(), width, height, channels, VIPS_FORMAT_FLOAT, VIPS_CODING_NONE,
                               channels <= 2 ? VIPS_INTERPRETATION_B_W : VIPS_INTERPRETATION_sRGB, 1, 1);
        if (vips_image_pipelinev(image_.get(), VIPS_DEMAND_STYLE_THINSTRIP, nullptr) != 0 ||
            vips_image_generate(image_.get(), nullptr, generate, nullptr, this, nullptr) != 0)
            throw MachineFault("libvips", "cannot make a picture: " + take_vips_error());
    }

    VipsImage* image() const { return image_.get(); }
    void rethrow_failure() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    static int generate(VipsRegion* piece, void* /*sequence*/, void* self, void* /*unused*/, gboolean* /*stop*/) {
        return static_cast<RowSource*>(self)->copy_rows(piece);
    }

    int copy_rows(VipsRegion* piece) {
        const VipsRect& area = piece->valid;
        try {
            cv::Mat rows(area.height, width_, CV_MAKETYPE(CV_32F, channels_));
            fill_(area.top, rows);
            for (int row = 0; row < area.height; ++row) {
                std::memcpy(VIPS_REGION_ADDR(piece, area.left, area.top + row),
                            rows.ptr(row) + static_cast<std::size_t>(area.left) * rows.elemSize(),
                            static_cast<std::size_t>(area.width) * rows.elemSize());
            }
            return 0;
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            return -1;
        }
    }

    int width_;
    int channels_;
    const FillRows& fill_;
    VipsImagePtr image_;
    std::mutex mutex_;
    std::exception_ptr failure_;
};

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
    save(image.get(), pixels.depth() == CV_32F, pixels.total() * pixels.elemSize(), options, VipsOutput(file));
}

void write_tiff_rows(int width, int height, int channels, const FillRows& fill, const WriteOptions& options,
                     OutputFile& file) {
    require_vips();
    RowSource rows(width, height, channels, fill);
    const std::uint64_t bytes = std::uint64_t{4} * static_cast<std::uint64_t>(width) *
                                static_cast<std::uint64_t>(height) * static_cast<std::uint64_t>(channels);
    try {
        save(rows.image(), true, bytes, options, VipsOutput(file));
    } catch (const MachineFault&) {
        rows.rethrow_failure();
        throw;
    }
}

}  // namespace puppetwarp
