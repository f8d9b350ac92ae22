// Any bytes as a picture file: read, or refused with InvalidInput; never anything else.
#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/read.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
    const int descriptor = ::memfd_create("picture", MFD_CLOEXEC);
    if (descriptor < 0 || ::write(descriptor, bytes, count) != static_cast<ssize_t>(count)) std::abort();
    const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
    const puppetwarp::ReadOptions options{.max_pixels = 1 << 20};
    try {
        const puppetwarp::ImageInfo info = puppetwarp::read_image_info(path, options);
        const puppetwarp::Image image = puppetwarp::read_image(path, options);
        const int bits = static_cast<int>(image.pixels.elemSize1()) * 8;
        if (info.width != image.width() || info.height != image.height() || info.channels != image.pixels.channels() ||
            info.bits != bits) {
            std::abort();
        }
    } catch (const puppetwarp::InvalidInput&) {
        // Refused: what most bytes deserve.
    }
    ::close(descriptor);
    return 0;
}
