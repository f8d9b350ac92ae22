#include <puppetwarp/image/exr_channels.h>

#include <puppetwarp/base/threads.h>

#include <puppetwarp/image/exr_stream.h>

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfThreading.h>

#include <algorithm>

namespace puppetwarp {

namespace {

constexpr int rows_at_a_time = 64;  // whole blocks of ZIP, which are 16 rows high

// OpenEXR has one pool of threads a process; it grows to what the loops of puppetwarp use. Blocks are written in their
// order, whoever compresses them.
int exr_threads() {
    const int threads = thread_count();
    if (threads < 2) return 0;
    if (Imf::globalThreadCount() < threads) Imf::setGlobalThreadCount(threads);
    return threads;
}

PixelWindow window_of(const Imath::Box2i& box) {
    return {box.min.x, box.min.y, box.max.x - box.min.x + 1, box.max.y - box.min.y + 1};
}

Imath::Box2i box_of(const PixelWindow& window) {
    return {{window.x, window.y}, {window.x + window.width - 1, window.y + window.height - 1}};
}

std::map<std::string, double> numbers_of(const Imf::Header& header) {
    std::map<std::string, double> numbers;
    for (auto it = header.begin(); it != header.end(); ++it) {
        if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&it.attribute())) {
            numbers[it.name()] = whole->value();
        } else if (const auto* single = dynamic_cast<const Imf::FloatAttribute*>(&it.attribute())) {
            numbers[it.name()] = static_cast<double>(single->value());
        } else if (const auto* twice = dynamic_cast<const Imf::DoubleAttribute*>(&it.attribute())) {
            numbers[it.name()] = twice->value();
        }
    }
    return numbers;
}

cv::Mat buffer_for(const std::string& name, const PixelWindow& data, std::size_t channels) {
    return allocate(name, data.width, std::min(rows_at_a_time, data.height),
                    CV_MAKETYPE(CV_32F, static_cast<int>(channels)));
}

// A frame whose row `first_row` of the window is the first of `rows`.
Imf::FrameBuffer frame_over(cv::Mat& rows, const PixelWindow& data, int first_row,
                            const std::vector<std::string>& channels) {
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        frame.insert(channels[c],
                     Imf::Slice::Make(Imf::FLOAT, rows.ptr() + c * sizeof(float), {data.x, data.y + first_row},
                                      data.width, rows.rows, rows.elemSize(), rows.step));
    }
    return frame;
}

// The first part of a file, its header checked.
class ChannelFile {
public:
    ChannelFile(const PictureFile& file, const ReadOptions& options)
        : name_(file.name()), stream_(file), file_(stream_, exr_threads()), header_(file_.header(0)) {
        if (header_.hasType() && !Imf::isImage(header_.type()))
            throw InvalidInput(name_, "deep EXR pictures are not known", "flatten it first");
        data_ = window_of(header_.dataWindow());
        if (data_.width < 1 || data_.height < 1) throw_damaged(name_, "it has no pixels");
        require_size(name_, data_.width, data_.height, options);
    }

    ChannelLayout layout() const {
        ChannelLayout layout{{}, data_, window_of(header_.displayWindow()), numbers_of(header_), {}};
        const Imf::ChannelList& list = header_.channels();
        for (auto it = list.begin(); it != list.end(); ++it) {
            layout.channels.emplace_back(it.name());
            if (it.channel().type == Imf::HALF) layout.halves.insert(it.name());
        }
        return layout;
    }

    void decode(const std::vector<std::string>& channels, const TakeRows& take) {
        for (const std::string& channel : channels) {
            const Imf::Channel* found = header_.channels().findChannel(channel);
            if (found == nullptr) throw InvalidInput(name_, "it has no channel " + channel);
            if (found->xSampling != 1 || found->ySampling != 1)
                throw InvalidInput(name_, "channel " + channel + " has less than the full resolution");
        }
        cv::Mat buffer = buffer_for(name_, data_, channels.size());
        Imf::InputPart part(file_, 0);
        for (int row = 0; row < data_.height; row += buffer.rows) {
            cv::Mat rows = buffer.rowRange(0, std::min(buffer.rows, data_.height - row));
            part.setFrameBuffer(frame_over(rows, data_, row, channels));
            part.readPixels(data_.y + row, data_.y + row + rows.rows - 1);
            take(row, rows);
        }
    }

private:
    std::string name_;
    ExrInput stream_;
    Imf::MultiPartInputFile file_;
    const Imf::Header& header_;
    PixelWindow data_;
};

Imf::Header header_for(const ChannelLayout& layout, const WriteOptions& options) {
    Imf::Header header(box_of(layout.display), box_of(layout.data));
    header.compression() = options.compression == 0 ? Imf::NO_COMPRESSION : Imf::ZIP_COMPRESSION;
    if (options.compression > 0) header.zipCompressionLevel() = options.compression;
    for (const std::string& channel : layout.channels) header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    for (const auto& [name, value] : layout.numbers) header.insert(name, Imf::DoubleAttribute(value));
    return header;
}

}  // namespace

ChannelLayout read_exr_layout(const PictureFile& file, const ReadOptions& options) {
    return reading_exr(file, [&] { return ChannelFile(file, options).layout(); });
}

void read_exr_channels(const PictureFile& file, const std::vector<std::string>& channels, const ReadOptions& options,
                       const TakeRows& take) {
    reading_exr(file, [&] { ChannelFile(file, options).decode(channels, take); });
}

void write_exr_channels(const ChannelLayout& layout, const FillRows& fill, const WriteOptions& options,
                        OutputFile& file) {
    const PixelWindow& data = layout.data;
    cv::Mat buffer = buffer_for(file.target().string(), data, layout.channels.size());
    ExrOutput stream(file);
    writing_exr(file, stream, [&] {
        Imf::OutputFile output(stream, header_for(layout, options), exr_threads());
        for (int row = 0; row < data.height; row += buffer.rows) {
            cv::Mat rows = buffer.rowRange(0, std::min(buffer.rows, data.height - row));
            fill(row, rows);
            output.setFrameBuffer(frame_over(rows, data, row, layout.channels));
            output.writePixels(rows.rows);
        }
    });
}

}  // namespace puppetwarp
