#include <puppetwarp/image/exr_file.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/image/vips_decode.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <vector>

#include <unistd.h>

namespace puppetwarp {

namespace {

constexpr double mm_an_inch = 25.4;

class ExrInput : public Imf::IStream {
public:
    explicit ExrInput(const PictureFile& file) : IStream(file.name().c_str()), file_(file) {}

    bool read(char bytes[], int count) override {
        for (int done = 0; done < count;) {
            const ssize_t got = ::pread(file_.descriptor(), bytes + done, static_cast<std::size_t>(count - done),
                                        static_cast<off_t>(position_));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) throw InvalidInput(file_.name(), "the file is truncated or damaged");
            done += static_cast<int>(got);
            position_ += static_cast<std::uint64_t>(got);
        }
        return position_ < file_.size_bytes();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    const PictureFile& file_;
    std::uint64_t position_ = 0;
};

// Keeps the first failure: OpenEXR swallows what is thrown while it closes a file.
class ExrOutput : public Imf::OStream {
public:
    explicit ExrOutput(OutputFile& file) : OStream(file.target().c_str()), file_(file) {}

    void write(const char bytes[], int count) override {
        try {
            file_.write({bytes, static_cast<std::size_t>(count)});
        } catch (...) {
            if (!failure_) failure_ = std::current_exception();
            throw;
        }
    }
    std::uint64_t tellp() override { return static_cast<std::uint64_t>(::lseek(file_.descriptor(), 0, SEEK_CUR)); }
    void seekp(std::uint64_t position) override { ::lseek(file_.descriptor(), static_cast<off_t>(position), SEEK_SET); }
    void rethrow_failure() const {
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    OutputFile& file_;
    std::exception_ptr failure_;
};

// The first part of an EXR file, its header checked.
class ExrPicture {
public:
    ExrPicture(const PictureFile& file, const ReadOptions& options)
        : name_(file.name()), stream_(file), file_(stream_, 0), header_(file_.header(0)) {
        if (header_.hasType() && !Imf::isImage(header_.type()))
            throw InvalidInput(name_, "deep EXR pictures are not known", "flatten it first");
        const Imath::Box2i& window = header_.dataWindow();
        width_ = window.max.x - window.min.x + 1;
        height_ = window.max.y - window.min.y + 1;
        if (width_ < 1 || height_ < 1) throw_damaged(name_, "it has no pixels");
        require_size(name_, width_, height_, options);
        find_channels();
    }

    ImageInfo info() const {
        ImageInfo info;
        info.format = "exr";
        info.width = width_;
        info.height = height_;
        info.channels = static_cast<int>(channels_.size());
        info.bits = 32;
        info.has_alpha = has_alpha();
        const ImageMetadata found = metadata();
        info.x_pixels_per_mm = found.x_pixels_per_mm;
        info.y_pixels_per_mm = found.y_pixels_per_mm;
        info.pages = file_.parts();
        return info;
    }

    Image decode() {
        Image image;
        image.metadata = metadata();
        image.pixels = allocate(name_, width_, height_, CV_MAKETYPE(CV_32F, static_cast<int>(channels_.size())));
        const Imath::Box2i& window = header_.dataWindow();
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < channels_.size(); ++c) {
            frame.insert(channels_[c], Imf::Slice::Make(Imf::FLOAT, image.pixels.ptr() + c * sizeof(float), window.min,
                                                        width_, height_, image.pixels.elemSize(), image.pixels.step));
        }
        Imf::InputPart part(file_, 0);
        part.setFrameBuffer(frame);
        part.readPixels(window.min.y, window.max.y);
        if (has_alpha()) divide_by_alpha(image.pixels);
        return image;
    }

private:
    bool has_alpha() const { return channels_.back() == "A"; }

    void find_channels() {
        const Imf::ChannelList& list = header_.channels();
        if (list.findChannel("R") && list.findChannel("G") && list.findChannel("B")) {
            channels_ = {"R", "G", "B"};
        } else if (list.findChannel("Y") && !list.findChannel("RY") && !list.findChannel("BY")) {
            channels_ = {"Y"};
        } else {
            throw InvalidInput(name_, "it has no plain R, G, B or Y channels", "convert it to RGB first");
        }
        if (list.findChannel("A")) channels_.emplace_back("A");
        for (const std::string& channel : channels_) {
            const Imf::Channel& found = list[channel];
            if (found.xSampling != 1 || found.ySampling != 1)
                throw InvalidInput(name_, "channel " + channel + " has less than the full resolution");
        }
    }

    ImageMetadata metadata() const {
        ImageMetadata metadata;
        if (Imf::hasXDensity(header_) && Imf::xDensity(header_) > 0 && header_.pixelAspectRatio() > 0) {
            metadata.x_pixels_per_mm = Imf::xDensity(header_) / mm_an_inch;
            metadata.y_pixels_per_mm = metadata.x_pixels_per_mm * header_.pixelAspectRatio();
        }
        return metadata;
    }

    static void divide_by_alpha(cv::Mat& pixels) {
        const int colours = pixels.channels() - 1;
        for (int y = 0; y < pixels.rows; ++y) {
            float* pixel = pixels.ptr<float>(y);
            for (int x = 0; x < pixels.cols; ++x, pixel += colours + 1) {
                const float alpha = pixel[colours];
                if (!(alpha > 0)) continue;
                for (int c = 0; c < colours; ++c) pixel[c] /= alpha;
            }
        }
    }

    std::string name_;
    ExrInput stream_;
    Imf::MultiPartInputFile file_;
    const Imf::Header& header_;
    int width_ = 0;
    int height_ = 0;
    std::vector<std::string> channels_;
};

// What OpenEXR throws, as what puppetwarp throws.
template <typename Work>
auto reading_exr(const PictureFile& file, const Work& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw MachineFault(file.name(), "not enough memory to read it");
    } catch (const std::exception& error) {
        throw_damaged(file.name(), error.what());
    }
}

cv::Mat multiplied_by_alpha(const cv::Mat& pixels) {
    cv::Mat product = pixels.clone();
    const int colours = pixels.channels() - 1;
    for (int y = 0; y < product.rows; ++y) {
        float* pixel = product.ptr<float>(y);
        for (int x = 0; x < product.cols; ++x, pixel += colours + 1) {
            for (int c = 0; c < colours; ++c) pixel[c] *= pixel[colours];
        }
    }
    return product;
}

Imf::Header header_for(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options) {
    Imf::Header header(pixels.cols, pixels.rows);
    header.compression() = options.compression == 0 ? Imf::NO_COMPRESSION : Imf::ZIP_COMPRESSION;
    if (options.compression > 0) header.zipCompressionLevel() = options.compression;
    if (metadata.x_pixels_per_mm > 0 && metadata.y_pixels_per_mm > 0) {
        Imf::addXDensity(header, static_cast<float>(metadata.x_pixels_per_mm * mm_an_inch));
        header.pixelAspectRatio() = static_cast<float>(metadata.y_pixels_per_mm / metadata.x_pixels_per_mm);
    }
    return header;
}

}  // namespace

bool is_exr(const PictureFile& file) {
    return file.signature().starts_with("\x76\x2f\x31\x01");
}

Image read_exr(const PictureFile& file, const ReadOptions& options) {
    return reading_exr(file, [&] { return ExrPicture(file, options).decode(); });
}

ImageInfo read_exr_info(const PictureFile& file, const ReadOptions& options) {
    return reading_exr(file, [&] { return ExrPicture(file, options).info(); });
}

void write_exr(const cv::Mat& pixels, const ImageMetadata& metadata, const WriteOptions& options, OutputFile& file) {
    const int channels = pixels.channels();
    const bool alpha = channels % 2 == 0;
    const cv::Mat stored = alpha ? multiplied_by_alpha(pixels) : pixels;
    std::vector<const char*> names = channels <= 2 ? std::vector{"Y"} : std::vector{"R", "G", "B"};
    if (alpha) names.push_back("A");

    Imf::Header header = header_for(pixels, metadata, options);
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < names.size(); ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        // OpenEXR's slices are of char*, also where it only reads them.
        auto* base = const_cast<char*>(reinterpret_cast<const char*>(stored.ptr()) + c * sizeof(float));
        frame.insert(names[c], Imf::Slice(Imf::FLOAT, base, stored.elemSize(), stored.step));
    }
    ExrOutput stream(file);
    try {
        Imf::OutputFile output(stream, header, 0);
        output.setFrameBuffer(frame);
        output.writePixels(pixels.rows);
    } catch (const std::exception& error) {
        stream.rethrow_failure();
        throw MachineFault(file.target().string(), std::string("cannot be written: ") + error.what());
    }
    stream.rethrow_failure();
}

}  // namespace puppetwarp
