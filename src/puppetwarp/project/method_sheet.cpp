#include <puppetwarp/project/method_sheet.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/stage_timer.h>
#include <puppetwarp/image/convert.h>
#include <puppetwarp/project/distortion_colours.h>
#include <puppetwarp/project/sheet_cell.h>
#include <puppetwarp/project/sheet_layout.h>
#include <puppetwarp/project/stiffness_pictures.h>
#include <puppetwarp/rig/snap.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace puppetwarp {

namespace {

constexpr int smallest_cell_px = 120;
constexpr int largest_cell_px = 2000;
constexpr int most_columns = 64;
const TextStyle header_style{12, true, {20, 20, 20}};
const cv::Scalar paper(255, 255, 255);
const cv::Scalar frame_colour(205, 205, 205);

void require_sound(const MethodSheetOptions& options) {
    if (options.cell_px < smallest_cell_px || options.cell_px > largest_cell_px) {
        throw InvalidInput("cell size " + std::to_string(options.cell_px), "is out of range",
                           "use " + std::to_string(smallest_cell_px) + " to " + std::to_string(largest_cell_px));
    }
    if (options.columns < 0 || options.columns > most_columns) {
        throw InvalidInput("columns " + std::to_string(options.columns), "is out of range",
                           "use 1 to " + std::to_string(most_columns) + ", or 0 to have them chosen");
    }
}

std::vector<LabelledMethod> chosen_methods(const MethodOptions& options, const std::vector<std::string>& labels) {
    std::vector<LabelledMethod> known = labelled_methods(options);
    if (labels.empty()) return known;
    std::string list;
    for (const LabelledMethod& each : known) list += (list.empty() ? "" : ", ") + each.label;
    std::vector<LabelledMethod> chosen;
    for (const std::string& label : labels) {
        const auto of_label = [&](const LabelledMethod& each) { return each.label == label; };
        if (std::any_of(chosen.begin(), chosen.end(), of_label)) {
            throw InvalidInput("method '" + label + "'", "is named twice", "name each method once");
        }
        const auto found = std::find_if(known.begin(), known.end(), of_label);
        if (found == known.end()) {
            throw InvalidInput("method '" + label + "'", "there is none of this name", "known: " + list);
        }
        chosen.push_back(*found);
    }
    return chosen;
}

MethodResult result_of(const LabelledMethod& method, const MethodSheet& sheet, const Pose& pose, Progress& progress) {
    MethodResult result;
    result.label = method.label;
    try {
        StageTimer timer(result.report.timings_ms);
        const std::unique_ptr<Deformer> deformer = make_deformer(method.options, sheet.mesh, sheet.rig, progress);
        timer.end("bind");
        Deformation deformation = deformer->deform(pose, nullptr, progress);
        timer.end("deform");
        describe(method.options, sheet.mesh, sheet.rig, pose, deformation, result.report);
        result.moved = std::move(deformation.V);
    } catch (const InvalidInput& error) {
        result.error = error.what();
    }
    return result;
}

// Throws what the first method said, when none could take the pose.
void require_some_result(const std::vector<MethodResult>& methods, const Pose& pose) {
    const auto failed = [](const MethodResult& each) { return !each.error.empty(); };
    if (!std::all_of(methods.begin(), methods.end(), failed)) return;
    throw InvalidInput("pose '" + pose.name + "'", "no method can take it: " + methods.front().error);
}

// Chooses the part of image space that all cells show, and marks who does not keep to it.
void choose_view(MethodSheet& sheet) {
    std::vector<Eigen::MatrixX2d> moved;
    for (const MethodResult& each : sheet.methods) {
        if (each.error.empty()) moved.push_back(each.moved);
    }
    sheet.canvas = common_view(sheet.mesh.V, moved);
    for (MethodResult& each : sheet.methods) each.cut_off = each.error.empty() && runs_out_of(sheet.canvas, each.moved);
}

SheetLayout layout_of(const MethodSheet& sheet, const MethodSheetOptions& options) {
    const double scale = static_cast<double>(options.cell_px) / std::max(sheet.canvas.width, sheet.canvas.height);
    const auto scaled = [&](int side) { return std::max(1, static_cast<int>(std::lround(side * scale))); };
    SheetContents contents;
    contents.cells = static_cast<int>(sheet.methods.size()) + 1;
    contents.columns = options.columns;
    contents.picture_width = scaled(sheet.canvas.width);
    contents.picture_height = scaled(sheet.canvas.height);
    contents.text_height = cell_text_height(options.timings);
    contents.header_height = header_style.line_px();
    contents.footer_height = options.show == MethodSheetOptions::Show::distortion ? distortion_legend_height() : 0;
    return SheetLayout(contents);
}

void require_size(const cv::Size& size, std::int64_t max_pixels) {
    if (std::int64_t{size.width} * size.height <= max_pixels) return;
    throw InvalidInput("sheet",
                       "would have " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                           " pixels, more than " + std::to_string(max_pixels),
                       "ask for smaller cells");
}

void put_picture(cv::Mat& pixels, const cv::Mat& picture, const cv::Rect& place) {
    picture.copyTo(pixels(place));
    cv::rectangle(pixels, cv::Rect(place.x - 1, place.y - 1, place.width + 2, place.height + 2), frame_colour, 1);
}

std::string file_name(const Puppet& puppet) {
    return std::filesystem::path(puppet.image).filename().string();
}

std::vector<std::string> rest_lines(const MethodSheet& sheet) {
    const std::size_t handles = sheet.rig.handles.size();
    return {std::to_string(handles) + (handles == 1 ? " handle" : " handles"),
            std::to_string(sheet.mesh.V.rows()) + " vertices, " + std::to_string(sheet.mesh.F.rows()) + " triangles"};
}

// Words have the whole width of the column, pictures their own.
void draw_method(cv::Mat& pixels, const CellPainter& painter, const MethodResult& result, const Pose& pose,
                 const MethodSheetOptions& options, const SheetLayout& layout, int cell, Progress& progress) {
    const cv::Rect place = layout.picture(cell), column = layout.text(cell);
    if (!result.error.empty()) {
        write_error(pixels, result.error, {column.x, place.y, column.width, place.height});
    } else if (options.show == MethodSheetOptions::Show::distortion) {
        put_picture(pixels, painter.distortion(result.moved, pose), place);
    } else {
        put_picture(pixels, painter.warped(result.moved, pose, progress), place);
    }
    write_result(pixels, result, options.timings, column);
}

cv::Mat draw_sheet(const MethodSheet& sheet, const Puppet& puppet, const Pose& pose, const Image& subject,
                   const SheetLayout& layout, const MethodSheetOptions& options, Progress& progress) {
    cv::Mat pixels(layout.size(), CV_8UC3, paper);
    const cv::Rect header = layout.header();
    const std::string title = file_name(puppet) + (pose.name.empty() ? "" : ", pose " + pose.name);
    for (const std::string& line : wrapped(title, header_style, header.width, 1)) {
        draw_text(pixels, line, header_style, header.x, header.y);
    }
    const cv::Size cell = layout.picture(0).size();
    const CellPainter painter(subject, sheet.mesh, sheet.rig, sheet.canvas, cell.width, cell.height);
    put_picture(pixels, painter.warped(sheet.mesh.V, Pose(), progress), layout.picture(0));
    write_lines(pixels, "rest", rest_lines(sheet), layout.text(0));
    for (std::size_t i = 0; i < sheet.methods.size(); ++i) {
        draw_method(pixels, painter, sheet.methods[i], pose, options, layout, static_cast<int>(i) + 1, progress);
    }
    const cv::Rect footer = layout.footer();
    if (footer.height > 0) draw_distortion_legend(pixels, footer.x, footer.y, footer.width);
    return pixels;
}

}  // namespace

std::vector<LabelledMethod> labelled_methods(const MethodOptions& options) {
    std::vector<LabelledMethod> methods;
    for (const std::string& name : method_names()) {
        LabelledMethod method{name, options};
        method.options.method = method_from_name(name);
        method.options.arap_energy = ArapEnergy::elements;
        methods.push_back(method);
        if (method.options.method != Method::arap) continue;
        for (const ArapEnergy energy : {ArapEnergy::spokes, ArapEnergy::spokes_and_rims}) {
            method.label = name + " (" + arap_energy_name(energy) + ")";
            method.options.arap_energy = energy;
            methods.push_back(method);
        }
    }
    return methods;
}

MethodSheet compare_methods(const Puppet& puppet, const Pose& pose, const MethodSheetOptions& options,
                            Progress& progress) {
    require_sound(options);
    const std::vector<LabelledMethod> methods = chosen_methods(puppet.method, options.methods);
    if (puppet.rig.handles.empty()) {
        throw InvalidInput("puppet", "has no pins and no handles", "add --pin X,Y or handles to the puppet file");
    }
    MethodSheet sheet;
    StageTimer timer(sheet.timings_ms);
    progress.step("read", 0);
    const Image image = load_image(puppet, options.read);
    timer.end("read");
    const Cutout cutout = cut_out_subject(puppet, image, options.read);
    const Outline outline = outline_subject(puppet, image.width(), image.height(), cutout);
    timer.end("cutout");
    const bool weighted = std::any_of(methods.begin(), methods.end(),
                                      [](const LabelledMethod& each) { return uses_weights(each.options.method); });
    sheet.mesh = weighted ? mesh_for_weights(puppet, outline) : mesh_subject(puppet, outline);
    timer.end("triangulate");
    const Rig loaded = load_rig(puppet, image.width(), image.height(), options.read);
    sheet.rig = snapped(loaded, sheet.mesh, options.pin_snap_px);
    for (const LabelledMethod& method : methods) {
        sheet.methods.push_back(result_of(method, sheet, pose, progress));
    }
    require_some_result(sheet.methods, pose);
    timer.end("compare");

    sheet.pose = pose.name;
    choose_view(sheet);
    const SheetLayout layout = layout_of(sheet, options);
    require_size(layout.size(), options.read.max_pixels);
    sheet.columns = layout.columns();
    sheet.rows = layout.rows();
    sheet.image.pixels = draw_sheet(sheet, puppet, pose, cut_subject(image, cutout, {}), layout, options, progress);
    if (profile_fits(image.metadata.icc, 3)) sheet.image.metadata.icc = image.metadata.icc;
    timer.end("draw");
    return sheet;
}

}  // namespace puppetwarp
