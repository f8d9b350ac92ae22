#include <puppetwarp/image/exr_file.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/image/exr_stream.h>
#include <puppetwarp/image/vips_decode.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <string>
#include <vector>

namespace puppetwarp {

namespace {

constexpr double mm_an_inch = 25.4;
constexpr int rows_at_a_time = 256;

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

std::vector<const char*> channel_names(int channels) {
    std::vector<const char*> names = channels <= 2 ? std::vector{"Y"} : std::vector{"R", "G", "B"};
    if (channels % 2 == 0) names.push_back("A");
    return names;
}

Imf::Header header_for(const PictureRows& picture, const WriteOptions& options) {
    Imf::Header header(picture.width, picture.height);
    const ImageMetadata& metadata = picture.metadata;
    header.compression() = options.compression == 0 ? Imf::NO_COMPRESSION : Imf::ZIP_COMPRESSION;
    if (options.compression > 0) header.zipCompressionLevel() = options.compression;
    if (metadata.x_pixels_per_mm > 0 && metadata.y_pixels_per_mm > 0) {
        Imf::addXDensity(header, static_cast<float>(metadata.x_pixels_per_mm * mm_an_inch));
        header.pixelAspectRatio() = static_cast<float>(metadata.y_pixels_per_mm / metadata.x_pixels_per_mm);
    }
    for (const char* name : channel_names(CV_MAT_CN(picture.type)))
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
}

// A frame whose row `first_row` of the picture is the first of `rows`.
Imf::FrameBuffer frame_over(const cv::Mat& rows, int first_row) {
    Imf::FrameBuffer frame;
    std::size_t c = 0;
    for (const char* name : channel_names(rows.channels())) {
        // OpenEXR's slices are of char*, also where it only reads them.
        auto* base = const_cast<char*>(reinterpret_cast<const char*>(rows.ptr()) + c++ * sizeof(float));
        frame.insert(
            name, Imf::Slice::Make(Imf::FLOAT, base, {0, first_row}, rows.cols, rows.rows, rows.elemSize(), rows.step));
    }
    return frame;
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

void write_exr(const PictureRows& picture, const WriteOptions& options, OutputFile& file) {
    const bool alpha = CV_MAT_CN(picture.type) % 2 == 0;
    ExrOutput stream(file);
    writing_exr(file, stream, [&] {
        Imf::OutputFile output(stream, header_for(picture, options), 0);
        for (int first = 0; first < picture.height; first += rows_at_a_time) {
            const cv::Mat rows = picture.rows(first, std::min(picture.height, first + rows_at_a_time));
            const cv::Mat stored = alpha ? multiplied_by_alpha(rows) : rows;
            output.setFrameBuffer(frame_over(stored, first));
            output.writePixels(stored.rows);
        }
    });
}

}  // namespace puppetwarp
