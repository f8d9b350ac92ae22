#include <puppetwarp/diff/html_report.h>

#include <puppetwarp/diff/display.h>
#include <puppetwarp/diff/page_text.h>
#include <puppetwarp/diff/report_page.h>
#include <puppetwarp/image/png_writer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

namespace puppetwarp {

namespace {

constexpr int kLongest_px = 2000;

constexpr std::array kStates{PairState::different, PairState::missing, PairState::extra, PairState::not_compared,
                             PairState::same};

// As a value of an attribute: without the space of `not compared`.
std::string state_key(PairState state) {
    std::string key = pair_state_name(state);
    std::replace(key.begin(), key.end(), ' ', '-');
    return key;
}

// What cannot be told has no value, so that it sorts after all that can; infinity does not fit a cell's number.
std::string number_cell(const std::optional<double>& value, const char* infinite = "") {
    if (!value) return "<td class=\"number\" data-value=\"\"></td>";
    std::ostringstream cell;
    if (std::isfinite(*value)) {
        cell << "<td class=\"number\" data-value=\"" << *value << "\">" << *value << "</td>";
    } else {
        cell << "<td class=\"number\" data-value=\"" << (*value > 0 ? "1e999" : "-1e999") << "\">" << infinite
             << "</td>";
    }
    return cell.str();
}

// What people read stands on the left, where a narrow window shows it.
constexpr std::array kColumns{"State", "Picture", "Reason", "Size", "Differing pixels", "Percent", "Max",
                              "RMSE",  "PSNR dB", "SSIM",   "FLIP"};

std::string figures_cells(const Comparison& comparison, bool compared) {
    const bool figures = compared && comparison.comparable;
    const auto value = [&](double figure) { return figures ? std::optional(figure) : std::nullopt; };
    std::ostringstream cells;
    if (compared) {
        cells << "<td class=\"number\" data-value=\"" << static_cast<double>(comparison.width) * comparison.height
              << "\">" << comparison.width << " x " << comparison.height << "</td>";
    } else {
        cells << number_cell(std::nullopt);
    }
    cells << number_cell(value(static_cast<double>(comparison.differing_pixels)))
          << number_cell(value(comparison.differing_percent)) << number_cell(value(comparison.max), "infinite")
          << number_cell(value(comparison.rmse), "infinite") << number_cell(value(comparison.psnr), "equal")
          << number_cell(comparison.ssim) << number_cell(comparison.flip);
    return cells.str();
}

PagePicture shown(const Image& image, HtmlReport::Pictures& pictures) {
    PagePicture picture = page_picture(image, kLongest_px);
    pictures.shrunk = std::max(pictures.shrunk, picture.shrunk);
    return picture;
}

}  // namespace

HtmlReport::Pictures HtmlReport::pictures_of(const ComparedFiles& files) {
    Pictures pictures;
    const WriteOptions packing{6, 95};
    pictures.expected = png_bytes(shown(files.expected, pictures).pixels, packing);
    pictures.actual = png_bytes(shown(files.actual, pictures).pixels, packing);
    if (!files.heat_map.pixels.empty()) {
        pictures.heat_map = png_bytes(shown(files.heat_map, pictures).pixels, packing);
    }
    return pictures;
}

HtmlReport::HtmlReport(const std::filesystem::path& expected, const std::filesystem::path& actual,
                       std::size_t room_bytes)
    : expected_(expected.string()), actual_(actual.string()), room_bytes_(room_bytes) {}

void HtmlReport::add(const PairResult& pair, std::optional<Pictures> pictures) {
    Row row{pair, std::nullopt};
    if (pictures && bytes_ < room_bytes_) {
        bytes_ += pictures->bytes();
        row.pictures = pictures_.size();
        pictures_.push_back(std::move(*pictures));
    }
    rows_.push_back(std::move(row));
}

std::size_t HtmlReport::count(PairState state) const {
    return static_cast<std::size_t>(
        std::count_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.pair.state == state; }));
}

// The page is walked through once, so that what is put in is not looked at for places.
void HtmlReport::write(OutputFile& file) const {
    std::string_view rest = report_page;
    for (std::size_t open = rest.find("{{"); open != std::string_view::npos; open = rest.find("{{")) {
        const std::size_t close = rest.find("}}", open);
        file.write(rest.substr(0, open));
        write_place(rest.substr(open + 2, close - open - 2), file);
        rest.remove_prefix(close + 2);
    }
    file.write(rest);
}

void HtmlReport::write_place(std::string_view name, OutputFile& file) const {
    const std::size_t same = count(PairState::same);
    if (name == "title") {
        file.write(same == rows_.size() ? "same" : "different");
        file.write(" - puppetwarp diff");
    } else if (name == "verdict") {
        const bool all = same == rows_.size();
        file.write(all ? "<span class=\"same\">same</span>" : "<span class=\"different\">different</span>");
        if (rows_.size() == 1) return;
        file.write(": " + std::to_string(same) + " of " + std::to_string(rows_.size()) + " pictures are the same");
    } else if (name == "paths") {
        file.write("expected " + html_text(expected_) + "<br>actual " + html_text(actual_));
        const auto left_out = std::count_if(rows_.begin(), rows_.end(), [](const Row& row) {
            return row.pair.state == PairState::different && !row.pictures;
        });
        if (left_out > 0) file.write("<br>" + std::to_string(left_out) + " pairs are in the table only");
    } else if (name == "filters") {
        file.write(filters());
    } else if (name == "columns") {
        for (const char* column : kColumns) file.write(std::string("<th tabindex=\"0\">") + column + "</th>");
    } else if (name == "rows") {
        write_rows(file);
    } else if (name == "pictures") {
        write_pictures(file);
    }
}

std::string HtmlReport::filters() const {
    std::string boxes;
    for (const PairState state : kStates) {
        const std::size_t pairs = count(state);
        if (pairs == 0) continue;
        boxes += "<label><input type=\"checkbox\" value=\"" + state_key(state) + "\" checked> " +
                 pair_state_name(state) + ' ' + std::to_string(pairs) + "</label>";
    }
    return boxes;
}

void HtmlReport::write_rows(OutputFile& file) const {
    for (const Row& row : rows_) {
        const PairResult& pair = row.pair;
        const bool compared = pair.state == PairState::same || pair.state == PairState::different;
        std::string text = "<tr data-state=\"" + state_key(pair.state) + '"';
        if (row.pictures) text += " data-pictures=\"" + std::to_string(*row.pictures) + '"';
        text += "><td><span class=\"state " + state_key(pair.state) + "\">" + pair_state_name(pair.state) +
                "</span></td><td class=\"path\">" + html_text(pair.path) + "</td><td class=\"reason\">" +
                html_text(compared ? pair.comparison.reason : pair.error) + "</td>" +
                figures_cells(pair.comparison, compared) + "</tr>\n";
        file.write(text);
    }
}

void HtmlReport::write_pictures(OutputFile& file) const {
    file.write("[");
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
        const Pictures& pictures = pictures_[i];
        file.write(i == 0 ? "\n" : ",\n");
        file.write("{\"shrunk\":" + std::to_string(pictures.shrunk) + ",\"expected\":\"" + base64(pictures.expected));
        file.write("\",\"actual\":\"" + base64(pictures.actual));
        file.write("\",\"heat\":\"" + base64(pictures.heat_map) + "\"}");
    }
    file.write("]");
}

}  // namespace puppetwarp
