#include <puppetwarp/image/normalise.h>

#include <puppetwarp/base/errors.h>

namespace puppetwarp {

namespace {

[[noreturn]] void throw_conversion(const std::string& name) {
    throw InvalidInput(name, "its colours cannot be converted: " + take_vips_error());
}

bool is_device_independent(VipsInterpretation space) {
    switch (space) {
        case VIPS_INTERPRETATION_XYZ:
        case VIPS_INTERPRETATION_LAB:
        case VIPS_INTERPRETATION_LABQ:
        case VIPS_INTERPRETATION_LABS:
        case VIPS_INTERPRETATION_LCH:
        case VIPS_INTERPRETATION_CMC:
        case VIPS_INTERPRETATION_YXY:
        case VIPS_INTERPRETATION_HSV: return true;
        default: return false;
    }
}

bool is_known_number(VipsBandFormat format) {
    switch (format) {
        case VIPS_FORMAT_UCHAR:
        case VIPS_FORMAT_USHORT:
        case VIPS_FORMAT_UINT:
        case VIPS_FORMAT_FLOAT: return true;
        default: return false;
    }
}

// To sRGB: CMYK through the file's profile, or through libvips' own where the file has none that works.
VipsImagePtr cmyk_to_srgb(const VipsImagePtr& cmyk, const std::string& name) {
    const int depth = cmyk->BandFmt == VIPS_FORMAT_USHORT ? 16 : 8;
    VipsImage* rgb = nullptr;
    if (vips_icc_transform(cmyk.get(), &rgb, "srgb", "embedded", TRUE, "input_profile", "cmyk", "depth", depth,
                           nullptr) != 0)
        throw_conversion(name);
    return VipsImagePtr(rgb);
}

VipsImagePtr to_srgb(const VipsImagePtr& image, const std::string& name) {
    // 8-bit codings stay 8 bits; Lab and XYZ come as floats and keep what 16 bits can hold of them.
    const bool bytes = image->Coding == VIPS_CODING_LABQ || image->BandFmt == VIPS_FORMAT_UCHAR;
    VipsImage* rgb = nullptr;
    if (vips_colourspace(image.get(), &rgb, bytes ? VIPS_INTERPRETATION_sRGB : VIPS_INTERPRETATION_RGB16, nullptr) != 0)
        throw_conversion(name);
    return VipsImagePtr(rgb);
}

VipsImagePtr scaled(const VipsImagePtr& image, double factor, double offset, VipsBandFormat format,
                    const std::string& name) {
    VipsImage* product = nullptr;
    if (vips_linear1(image.get(), &product, factor, offset, nullptr) != 0) throw_conversion(name);
    const VipsImagePtr owned(product);
    VipsImage* cast = nullptr;
    if (vips_cast(owned.get(), &cast, format, nullptr) != 0) throw_conversion(name);
    return VipsImagePtr(cast);
}

// Portable pixmaps name their white; libvips leaves the values as they are.
VipsImagePtr with_full_white(VipsImagePtr image, const std::string& name) {
    int white = 0;
    if (vips_image_get_typeof(image.get(), "ppm-max-value") == 0) return image;
    if (vips_image_get_int(image.get(), "ppm-max-value", &white) != 0 || white <= 0) return image;
    const int full = image->BandFmt == VIPS_FORMAT_UCHAR ? 255 : 65535;
    const bool integer = image->BandFmt == VIPS_FORMAT_UCHAR || image->BandFmt == VIPS_FORMAT_USHORT;
    if (!integer || white == full) return image;
    return scaled(image, static_cast<double>(full) / white, 0.5, image->BandFmt, name);
}

VipsImagePtr to_known_depth(VipsImagePtr image, const std::string& name) {
    constexpr double full_uint = 4294967295.0;
    return image->BandFmt == VIPS_FORMAT_UINT ? scaled(image, 1 / full_uint, 0, VIPS_FORMAT_FLOAT, name)
                                              : std::move(image);
}

}  // namespace

NormalisedPicture normalise(VipsImagePtr image, const std::string& name) {
    NormalisedPicture result;
    if (image->Coding == VIPS_CODING_RAD) {
        VipsImage* floats = nullptr;
        if (vips_rad2float(image.get(), &floats, nullptr) != 0) throw_conversion(name);
        image.reset(floats);
    }
    const VipsInterpretation space = vips_image_guess_interpretation(image.get());
    if (space == VIPS_INTERPRETATION_CMYK) {
        image = cmyk_to_srgb(image, name);
        result.recoloured = true;
    } else if (is_device_independent(space)) {
        image = to_srgb(image, name);
        result.recoloured = true;
    }
    if (!is_known_number(image->BandFmt)) {
        throw InvalidInput(name, "its pixels are neither unsigned whole numbers nor 32-bit floats",
                           "convert it to 8 bits, 16 bits or float");
    }
    if (image->Bands > 4) {
        throw InvalidInput(name, "it has " + std::to_string(image->Bands) + " channels",
                           "puppetwarp knows grey and RGB, each with or without alpha");
    }
    result.image = to_known_depth(with_full_white(std::move(image), name), name);
    return result;
}

}  // namespace puppetwarp
