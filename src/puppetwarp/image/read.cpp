#include <puppetwarp/image/read.h>

#include <puppetwarp/image/exr_file.h>
#include <puppetwarp/image/picture_file.h>
#include <puppetwarp/image/vips_decode.h>

namespace puppetwarp {

Image read_image(const std::filesystem::path& path, const ReadOptions& options) {
    const PictureFile file(path);
    return is_exr(file) ? read_exr(file, options) : VipsPicture(file, options).decode(file);
}

ImageInfo read_image_info(const std::filesystem::path& path, const ReadOptions& options) {
    const PictureFile file(path);
    return is_exr(file) ? read_exr_info(file, options) : VipsPicture(file, options).info();
}

}  // namespace puppetwarp
