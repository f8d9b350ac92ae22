#include <puppetwarp/image/write.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>

#include <puppetwarp/image/convert.h>
#include <puppetwarp/image/exr_file.h>
#include <puppetwarp/image/formats.h>
#include <puppetwarp/image/jpeg_writer.h>
#include <puppetwarp/image/png_writer.h>
#include <puppetwarp/image/pnm_writer.h>
#include <puppetwarp/image/tiff_writer.h>
#include <puppetwarp/image/webp_writer.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace puppetwarp {

namespace {

void require_options(const WriteOptions& options) {
    if (options.compression < 0 || options.compression > 9)
        throw InvalidInput("compression " + std::to_string(options.compression), "is not between 0 and 9");
    if (options.quality < 1 || options.quality > 100)
        throw InvalidInput("quality " + std::to_string(options.quality), "is not between 1 and 100");
}

void require_picture(const PictureRows& picture, const std::string& name) {
    const int depth = CV_MAT_DEPTH(picture.type);
    if (picture.width <= 0 || picture.height <= 0 || CV_MAT_CN(picture.type) > 4 ||
        (depth != CV_8U && depth != CV_16U && depth != CV_32F))
        throw InvalidInput(name, "there is no picture of 1 to 4 channels to write");
}

void require_side(const PictureRows& picture, const FormatTraits& format, const std::string& name) {
    if (format.max_side_px == 0 || std::max(picture.width, picture.height) <= format.max_side_px) return;
    throw InvalidInput(name,
                       "the picture has " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                           " pixels, and " + std::string(format.name) + " ends at " +
                           std::to_string(format.max_side_px),
                       "choose another format");
}

}  // namespace

void write_image(const Image& image, const std::filesystem::path& path, const WriteOptions& options) {
    write_rows(rows_of(image), path, options);
}

void write_rows(const PictureRows& picture, const std::filesystem::path& path, const WriteOptions& options) {
    const FormatTraits& format = format_traits(output_format(path));
    require_options(options);
    require_picture(picture, path.string());
    require_side(picture, format, path.string());
    OutputFile file(path);
    const PictureRows fitted = fit_to_format(picture, format);
    if (format.name == "png") {
        write_png(fitted, options, [&](std::string_view bytes) { file.write(bytes); });
    } else if (format.name == "jpeg") {
        write_jpeg(fitted, options, file);
    } else if (format.name == "tiff") {
        write_tiff(fitted, options, file);
    } else if (format.name == "webp") {
        write_webp(fitted, options, file);
    } else if (format.name == "exr") {
        write_exr(fitted, options, file);
    } else {
        write_pnm(fitted, format.name, file);
    }
    file.commit();
}

}  // namespace puppetwarp
