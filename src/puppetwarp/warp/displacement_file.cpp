#include <puppetwarp/warp/displacement_file.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/image/exr_channels.h>
#include <puppetwarp/image/exr_file.h>
#include <puppetwarp/image/tiff_writer.h>
#include <puppetwarp/warp/warp_input.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int band_rows = 64;
const cv::Vec3f nothing(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::quiet_NaN(), 0);

const std::string width_attribute = "puppetwarp:sourceWidth";
const std::string height_attribute = "puppetwarp:sourceHeight";
const std::string scale_attribute = "puppetwarp:scale";

// What a pixel of a file holds, in this order; a TIFF only the first four.
constexpr int st_channels = 4;
const std::vector<std::string> exr_names{"R", "G", "B", "A", "displacement.x", "displacement.y"};

// Shares of the source's size: the rounding of a 32-bit float up to 1, and what a program may lose that computes in
// such floats.
constexpr double float_rounding = 0x1p-25;
constexpr double float_noise = 0x1p-23;
constexpr double half_rounding = 0x1p-12;
constexpr double word_rounding = 1 / 131070.0;

bool is_exr_name(const std::filesystem::path& path) {
    return output_format(path) == "exr";
}

// \param channels  st_channels, or all. \param out  so many numbers a pixel.
void store_row(const DisplacementPlane& plane, const cv::Vec3f* displacement, int row, int channels, float* out) {
    for (int column = 0; column < plane.canvas.width; ++column, out += channels) {
        const cv::Vec3f& moved = displacement[column];
        std::fill_n(out, channels, 0.0F);
        if (!std::isfinite(moved[0]) || !std::isfinite(moved[1])) continue;
        const Point at = plane.place(column, row) + Point(moved[0], moved[1]);
        out[0] = static_cast<float>(at.x() / plane.source_width);
        out[1] = static_cast<float>(1 - at.y() / plane.source_height);
        out[2] = 1;
        out[3] = moved[2];
        if (channels == st_channels) continue;
        out[4] = moved[0];
        out[5] = -moved[1];
    }
}

ChannelLayout exr_layout(const DisplacementPlane& plane) {
    const Canvas& canvas = plane.canvas;
    const Canvas source = scaled_canvas({0, 0, plane.source_width, plane.source_height}, plane.scale, plane.scale);
    ChannelLayout layout;
    layout.channels = exr_names;
    layout.data = {canvas.x, canvas.y, canvas.width, canvas.height};
    layout.display = {source.x, source.y, source.width, source.height};
    layout.numbers = {
        {width_attribute, plane.source_width}, {height_attribute, plane.source_height}, {scale_attribute, plane.scale}};
    return layout;
}

// \param displacements  as `DisplacementRows::fill`.
void write_rows(const DisplacementPlane& plane, const FillRows& displacements, const std::filesystem::path& path,
                const WriteOptions& options, Progress& progress) {
    require_displacement_name(path);
    progress.step("write", 0);
    const bool exr = is_exr_name(path);
    const FillRows fill = [&](int first_row, cv::Mat& rows) {
        // libvips calls from threads of its own, which nobody may be told of or stop.
        if (exr) progress.step("write", static_cast<double>(first_row) / plane.canvas.height);
        cv::Mat band(rows.rows, rows.cols, CV_32FC3);
        displacements(first_row, band);
        parallel_for(0, rows.rows, 1, [&](int first, int last) {
            for (int row = first; row < last; ++row) {
                store_row(plane, band.ptr<cv::Vec3f>(row), first_row + row, rows.channels(), rows.ptr<float>(row));
            }
        });
    };
    OutputFile file(path);
    if (exr) {
        write_exr_channels(exr_layout(plane), fill, options, file);
    } else {
        const auto rows = [&](int first, int last) {
            cv::Mat made(last - first, plane.canvas.width, CV_32FC(st_channels));
            fill(first, made);
            return made;
        };
        write_tiff({plane.canvas.width, plane.canvas.height, CV_32FC(st_channels), {}, rows}, options, file);
    }
    file.commit();
    progress.step("write", 1);
}

// What the pixels of a file hold, in this order: s, t, alpha when there is one, the displacement when there is one.
struct MapForm {
    Canvas canvas;
    bool alpha = false;
    bool displacement = false;
    double rounding = float_rounding;
    std::optional<DisplacementPlane> plane;  // as a file of ours tells
};

std::optional<DisplacementPlane> plane_of(const ChannelLayout& layout, const Canvas& canvas) {
    const auto number = [&](const std::string& name) {
        const auto found = layout.numbers.find(name);
        return found == layout.numbers.end() ? 0.0 : found->second;
    };
    const double width = number(width_attribute), height = number(height_attribute), scale = number(scale_attribute);
    constexpr double most = 1 << 28;
    const bool sound =
        width >= 1 && height >= 1 && width <= most && height <= most && scale > 0 && std::isfinite(scale);
    if (!sound) return std::nullopt;
    return DisplacementPlane{canvas, scale, static_cast<int>(width), static_cast<int>(height)};
}

// Reads places off the rows of one file.
class PlaceReader {
public:
    PlaceReader(const MapForm& form, const DisplacementPlane& plane)
        : form_(form),
          plane_(plane),
          size_(plane.source_width, plane.source_height),
          displacement_(detail::allocate_canvas(form.canvas, CV_32FC3)) {}

    void take(int first_row, const cv::Mat& rows) {
        parallel_for(0, rows.rows, 1, [&](int first, int last) {
            for (int row = first; row < last; ++row) read_row(rows.ptr<float>(row), rows.channels(), first_row + row);
        });
    }

    cv::Mat finished() {
        if (!form_.alpha || form_.plane) return displacement_;
        // Of other programs' maps alpha that is 0 everywhere was never meant; else what stands where it is 0 is
        // nothing.
        parallel_for(0, displacement_.rows, band_rows, [&](int first, int last) {
            for (int row = first; row < last; ++row) {
                cv::Vec3f* p = displacement_.ptr<cv::Vec3f>(row);
                for (int column = 0; column < displacement_.cols; ++column) {
                    if (p[column][2] == 0) p[column] = any_alpha_ ? nothing : cv::Vec3f(p[column][0], p[column][1], 1);
                }
            }
        });
        return displacement_;
    }

private:
    void read_row(const float* p, int channels, int row) {
        cv::Vec3f* out = displacement_.ptr<cv::Vec3f>(row);
        bool any = false;
        for (int column = 0; column < displacement_.cols; ++column, p += channels) {
            const float shown = form_.alpha ? (p[2] > 0 ? std::min(p[2], 1.0F) : 0.0F) : 1.0F;
            out[column] = read(p, p + channels - 2, plane_.place(column, row), shown);
            any |= shown > 0;
        }
        if (any) any_alpha_ = true;
    }

    // \param finer  the displacement, when the form has it.
    cv::Vec3f read(const float* st, const float* finer, const Point& own, float shown) const {
        const Point at(st[0] * size_.x(), (1 - static_cast<double>(st[1])) * size_.y());
        if (form_.displacement) {
            const cv::Vec3f displacement(finer[0], -finer[1], shown);
            const Point off = own + Point(displacement[0], displacement[1]) - at;
            if ((off.array().abs() <= 2 * float_noise * size_.array()).all()) return displacement;
        }
        // Our own maps hold nothing at all where they show nothing.
        if (form_.plane && shown == 0) return nothing;
        const Point displacement = Point(centred(at.x(), size_.x()), centred(at.y(), size_.y())) - own;
        const cv::Vec3f rounded(static_cast<float>(displacement.x()), static_cast<float>(displacement.y()), shown);
        return std::isfinite(rounded[0]) && std::isfinite(rounded[1]) ? rounded : nothing;
    }

    double centred(double coordinate, double size) const {
        const double centre = std::floor(coordinate) + 0.5;
        const bool near = form_.rounding == float_rounding && std::abs(coordinate - centre) <= float_noise * size;
        return near ? centre : coordinate;
    }

    MapForm form_;
    DisplacementPlane plane_;
    Point size_;
    cv::Mat displacement_;
    std::atomic<bool> any_alpha_ = false;
};

StoredDisplacement read_with(const MapForm& form, int width, int height,
                             const std::function<void(const TakeRows&)>& read_rows) {
    StoredDisplacement result;
    result.knows_source = form.plane.has_value();
    result.map.plane = form.plane.value_or(DisplacementPlane{form.canvas, 1, width, height});
    result.map.rounding_px = form.rounding * std::max(result.map.plane.source_width, result.map.plane.source_height);
    PlaceReader reader(form, result.map.plane);
    read_rows([&](int first_row, const cv::Mat& rows) { reader.take(first_row, rows); });
    result.map.displacement = reader.finished();
    return result;
}

StoredDisplacement read_exr_map(const PictureFile& file, int width, int height, const ReadOptions& options) {
    const ChannelLayout layout = read_exr_layout(file, options);
    const auto has = [&](const std::string& name) {
        return std::find(layout.channels.begin(), layout.channels.end(), name) != layout.channels.end();
    };
    if (!has("R") || !has("G")) {
        std::string names;
        for (const std::string& name : layout.channels) names += (names.empty() ? "" : ", ") + name;
        throw InvalidInput(file.name(), "is no ST map: it has no channels R and G, but " + names,
                           "copy the map into red and green");
    }
    MapForm form;
    form.canvas = {layout.data.x - layout.display.x, layout.data.y - layout.display.y, layout.data.width,
                   layout.data.height};
    form.plane = plane_of(layout, form.canvas);
    form.rounding = layout.halves.count("R") + layout.halves.count("G") > 0 ? half_rounding : float_rounding;
    std::vector<std::string> channels{"R", "G"};
    form.alpha = has("A");
    if (form.alpha) channels.emplace_back("A");
    form.displacement = form.plane && has(exr_names[4]) && has(exr_names[5]);
    if (form.displacement) channels.insert(channels.end(), exr_names.begin() + 4, exr_names.end());
    return read_with(form, width, height,
                     [&](const TakeRows& take) { read_exr_channels(file, channels, options, take); });
}

StoredDisplacement read_picture_map(const std::filesystem::path& path, int width, int height,
                                    const ReadOptions& options) {
    const cv::Mat pixels = read_image(path, options).pixels;
    if (pixels.channels() < 2)
        throw InvalidInput(path.string(), "is no ST map: it has one channel", "an ST map has red and green");
    if (pixels.depth() == CV_8U) {
        throw InvalidInput(path.string(), "8 bits a channel are too coarse for places in a picture",
                           "give an ST map of 32-bit floats, as EXR or TIFF");
    }
    const bool words = pixels.depth() == CV_16U;
    MapForm form;
    form.canvas = {0, 0, pixels.cols, pixels.rows};
    form.alpha = pixels.channels() == 4;
    form.rounding = words ? word_rounding : float_rounding;
    return read_with(form, width, height, [&](const TakeRows& take) {
        for (int row = 0; row < pixels.rows; row += band_rows) {
            cv::Mat floats, st;
            pixels.rowRange(row, std::min(row + band_rows, pixels.rows))
                .convertTo(floats, CV_32F, words ? 1 / 65535.0 : 1);
            st.create(floats.size(), form.alpha ? CV_32FC3 : CV_32FC2);
            cv::mixChannels(floats, st, form.alpha ? std::vector{0, 0, 1, 1, 3, 2} : std::vector{0, 0, 1, 1});
            take(row, st);
        }
    });
}

}  // namespace

void require_displacement_name(const std::filesystem::path& path) {
    if (OutputFile::is_stream(path))
        throw InvalidInput(path.string(), "a displacement map cannot be written to a stream", "name a file");
    std::string format;
    try {
        format = output_format(path);
    } catch (const InvalidInput&) {
        format.clear();
    }
    if (format != "exr" && format != "tiff")
        throw InvalidInput(path.string(), "is no name for a displacement map", "use .exr, .tif or .tiff");
}

void write_displacement(const DisplacementRows& rows, const std::filesystem::path& path, const WriteOptions& options,
                        Progress& progress) {
    write_rows(
        rows.plane(), [&](int first_row, cv::Mat& band) { rows.fill(first_row, band); }, path, options, progress);
}

void write_displacement(const DisplacementMap& map, const std::filesystem::path& path, const WriteOptions& options) {
    Progress progress;
    const auto copy = [&](int first_row, cv::Mat& band) {
        map.displacement.rowRange(first_row, first_row + band.rows).copyTo(band);
    };
    write_rows(map.plane, copy, path, options, progress);
}

StoredDisplacement read_displacement(const std::filesystem::path& path, int width, int height,
                                     const ReadOptions& options) {
    const PictureFile file(path);
    return is_exr(file) ? read_exr_map(file, width, height, options) : read_picture_map(path, width, height, options);
}

}  // namespace puppetwarp
