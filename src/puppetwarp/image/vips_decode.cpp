#include <puppetwarp/image/vips_decode.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/image/exif.h>
#include <puppetwarp/image/orientation.h>
#include <puppetwarp/image/png_check.h>
#include <puppetwarp/image/png_pixels.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstring>

namespace puppetwarp {

namespace {

using namespace std::literals;

// A TIFF's directory often stands at its end: of a truncated one libvips sees only that nobody can read it.
bool has_tiff_signature(std::string_view signature) {
    return signature.starts_with("II*\0"sv) || signature.starts_with("MM\0*"sv) || signature.starts_with("II+\0"sv) ||
           signature.starts_with("MM\0+"sv);
}

VipsImagePtr open_header(const PictureFile& file) {
    const VipsSourcePtr source(vips_source_new_from_descriptor(file.descriptor()));
    if (!source) throw MachineFault(file.name(), "cannot be read: " + take_vips_error());
    const char* loader = vips_foreign_find_load_source(source.get());
    if (loader == nullptr || !is_allowed_loader(loader)) {
        take_vips_error();
        if (has_tiff_signature(file.signature())) throw_damaged(file.name(), "");
        throw InvalidInput(file.name(), "is not a picture of a known format",
                           "use PNG, JPEG, TIFF, WebP, GIF, HEIF, AVIF, JPEG 2000, EXR, HDR or PNM");
    }
    VipsImage* image = vips_image_new_from_source(source.get(), "", "access", VIPS_ACCESS_SEQUENTIAL, "fail_on",
                                                  VIPS_FAIL_ON_ERROR, nullptr);
    if (image == nullptr) throw_damaged(file.name(), take_vips_error());
    return VipsImagePtr(image);
}

std::vector<std::uint8_t> blob(VipsImage* image, const char* field) {
    const void* data = nullptr;
    std::size_t size = 0;
    if (vips_image_get_typeof(image, field) == 0) return {};
    if (vips_image_get_blob(image, field, &data, &size) != 0) {
        take_vips_error();
        return {};
    }
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    return {bytes, bytes + size};
}

int integer(VipsImage* image, const char* field, int otherwise) {
    int value = otherwise;
    if (vips_image_get_typeof(image, field) != 0 && vips_image_get_int(image, field, &value) != 0) {
        take_vips_error();
        return otherwise;
    }
    return value;
}

ImageMetadata metadata_of(VipsImage* image) {
    ImageMetadata metadata;
    metadata.icc = blob(image, VIPS_META_ICC_NAME);
    const std::vector<std::uint8_t> exif = blob(image, VIPS_META_EXIF_NAME);
    const auto body = without_exif_prefix(exif);
    metadata.exif.assign(body.begin(), body.end());
    metadata.xmp = blob(image, VIPS_META_XMP_NAME);
    metadata.x_pixels_per_mm = image->Xres;
    metadata.y_pixels_per_mm = image->Yres;
    return metadata;
}

// Of a JFIF file (ITU-T T.871): whether its density has a unit.
bool has_jfif_resolution(std::string_view signature) {
    constexpr std::size_t unit_at = 13;
    return signature.size() > unit_at && signature.substr(6, 5) == "JFIF\0"sv && signature[unit_at] != 0;
}

std::string format_name(VipsImage* image, const std::string& signature) {
    const char* loader = nullptr;
    if (vips_image_get_string(image, VIPS_META_LOADER, &loader) != 0) take_vips_error();
    std::string name = loader == nullptr ? "" : loader;
    name = name.substr(0, name.find("load"));
    if (name == "jp2k") return "jpeg2000";
    if (name == "rad") return "hdr";
    if (name == "ppm" && signature.size() > 1) {
        switch (signature[1]) {
            case '1':
            case '4': return "pbm";
            case '2':
            case '5': return "pgm";
            case 'f':
            case 'F': return "pfm";
            default: return "ppm";
        }
    }
    return name;
}

int cv_depth(VipsBandFormat format) {
    return format == VIPS_FORMAT_UCHAR ? CV_8U : format == VIPS_FORMAT_USHORT ? CV_16U : CV_32F;
}

// Called by libvips for strip after strip, from the top, never two at a time.
int copy_strip(VipsRegion* strip, VipsRect* area, void* matrix) {
    cv::Mat& pixels = *static_cast<cv::Mat*>(matrix);
    const std::size_t row_bytes = static_cast<std::size_t>(area->width) * pixels.elemSize();
    for (int y = 0; y < area->height; ++y) {
        std::memcpy(pixels.ptr(area->top + y) + static_cast<std::size_t>(area->left) * pixels.elemSize(),
                    VIPS_REGION_ADDR(strip, area->left, area->top + y), row_bytes);
    }
    return 0;
}

}  // namespace

void throw_damaged(const std::string& name, const std::string& detail) {
    throw InvalidInput(name, "the file is truncated or damaged" + (detail.empty() ? "" : ": " + detail));
}

void require_size(const std::string& name, int width, int height, const ReadOptions& options) {
    if (static_cast<std::int64_t>(width) * height <= options.max_pixels) return;
    throw InvalidInput(name,
                       "the picture has " + std::to_string(width) + " x " + std::to_string(height) +
                           " pixels, more than " + std::to_string(options.max_pixels),
                       "allow more with --max-pixels");
}

cv::Mat allocate(const std::string& name, int width, int height, int type) {
    try {
        return cv::Mat(height, width, type);
    } catch (const cv::Exception&) {
        throw MachineFault(
            name, "not enough memory for " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    }
}

VipsPicture::VipsPicture(const PictureFile& file, const ReadOptions& options) : name_(file.name()) {
    require_vips();
    // Where the file says nothing, libvips says 72 pixels an inch for these two, else 1 a millimetre.
    bool known = !file.signature().starts_with("\xff\xd8"sv) || has_jfif_resolution(file.signature());
    if (is_png(file)) known = require_whole_png(file).has_resolution;
    stored_ = open_header(file);
    if (stored_->Xsize < 1 || stored_->Ysize < 1) throw_damaged(name_, "it has no pixels");
    require_size(name_, stored_->Xsize, stored_->Ysize, options);
    metadata_ = metadata_of(stored_.get());
    known = known || has_exif_resolution(metadata_.exif);
    if (!known || (stored_->Xres == 1 && stored_->Yres == 1) || !(stored_->Xres > 0 && stored_->Yres > 0))
        metadata_.x_pixels_per_mm = metadata_.y_pixels_per_mm = 0;
    format_ = format_name(stored_.get(), file.signature());
    // HEIF has an orientation of its own beside EXIF's; its library has applied it already.
    if (format_ != "heif") {
        orientation_ =
            std::clamp(integer(stored_.get(), VIPS_META_ORIENTATION, exif_orientation(metadata_.exif)), 1, 8);
    }
    // A second reference: normalise() takes one of its own.
    g_object_ref(stored_.get());
    picture_ = normalise(VipsImagePtr(stored_.get()), name_);
    if (picture_.recoloured) metadata_.icc.clear();
}

ImageInfo VipsPicture::info() const {
    ImageInfo info;
    info.format = format_;
    info.width = picture_.image->Xsize;
    info.height = picture_.image->Ysize;
    info.x_pixels_per_mm = metadata_.x_pixels_per_mm;
    info.y_pixels_per_mm = metadata_.y_pixels_per_mm;
    if (swaps_sides(orientation_)) {
        std::swap(info.width, info.height);
        std::swap(info.x_pixels_per_mm, info.y_pixels_per_mm);
    }
    info.channels = picture_.image->Bands;
    info.bits = static_cast<int>(vips_format_sizeof(picture_.image->BandFmt)) * 8;
    info.has_alpha = info.channels % 2 == 0;
    info.has_icc = !metadata_.icc.empty();
    info.has_exif = !metadata_.exif.empty();
    info.has_xmp = !metadata_.xmp.empty();
    info.orientation = orientation_;
    info.pages = std::max(1, integer(stored_.get(), VIPS_META_N_PAGES, 1));
    return info;
}

// Of PNG files as most are, libvips reads no more than the header.
cv::Mat VipsPicture::pixels(const PictureFile& file) const {
    VipsImage* source = picture_.image.get();
    const int type = CV_MAKETYPE(cv_depth(source->BandFmt), source->Bands);
    if (format_ == "png" && source == stored_.get() && CV_MAT_DEPTH(type) != CV_32F) {
        cv::Mat plain = plain_png_pixels(file, source->Xsize, source->Ysize, type);
        if (!plain.empty()) return plain;
    }
    cv::Mat pixels = allocate(name_, source->Xsize, source->Ysize, type);
    if (vips_sink_disc(source, copy_strip, &pixels) != 0) throw_damaged(name_, take_vips_error());
    // PFM stores its rows from the bottom up, which libvips leaves to its caller.
    if (format_ == "pfm") cv::flip(pixels, pixels, 0);
    return pixels;
}

Image VipsPicture::decode(const PictureFile& file) const {
    Image image;
    image.pixels = pixels(file);
    image.pixels = upright(std::move(image.pixels), orientation_);
    image.metadata = metadata_;
    reset_exif_orientation(image.metadata.exif);
    if (swaps_sides(orientation_)) std::swap(image.metadata.x_pixels_per_mm, image.metadata.y_pixels_per_mm);
    return image;
}

}  // namespace puppetwarp
