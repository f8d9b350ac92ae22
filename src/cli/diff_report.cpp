#include "diff_report.h"

#include <puppetwarp/diff/printable.h>

#include <iostream>

namespace puppetwarp::cli {

namespace {

Json place(int x, int y) {
    return x < 0 ? Json(nullptr) : Json({x, y});
}

Json values(const std::vector<double>& values) {
    Json json = Json::array();
    for (const double value : values) json.push_back(finite(value));
    return json;
}

// What the house's contract names, in its order.
void add_figures(const Comparison& comparison, Json& json) {
    json["max"] = finite(comparison.max);
    json["max_at"] = place(comparison.max_x, comparison.max_y);
    json["mean"] = finite(comparison.mean);
    json["rmse"] = finite(comparison.rmse);
    json["psnr"] = finite(comparison.psnr);
    if (comparison.ssim) json["ssim"] = *comparison.ssim;
    json["differing_pixels"] = comparison.differing_pixels;
    json["differing_percent"] = comparison.differing_percent;
    if (comparison.box_width > 0) {
        json["bounding_box"] = {{"x", comparison.box_x},
                                {"y", comparison.box_y},
                                {"width", comparison.box_width},
                                {"height", comparison.box_height}};
    }
}

void add_more(const Comparison& comparison, Json& json) {
    json["compared_pixels"] = comparison.compared_pixels;
    if (comparison.max_channel >= 0) {
        json["max_channel"] = comparison.max_channel;
        json["max_values"] = {{"expected", values(comparison.expected_at_max)},
                              {"actual", values(comparison.actual_at_max)}};
    }
    if (comparison.flip) {
        json["flip"] = *comparison.flip;
        json["flip_max"] = comparison.flip_max;
        json["flip_max_at"] = place(comparison.flip_max_x, comparison.flip_max_y);
    }
    json["antialiased_pixels"] = comparison.antialiased_pixels;
    if (comparison.window_pixels > 0) {
        json["densest_window"] = {
            {"x", comparison.window_x}, {"y", comparison.window_y}, {"pixels", comparison.window_pixels}};
    }
    json["shift"] = {comparison.shift_x, comparison.shift_y};
}

}  // namespace

Json report_json(const Comparison& comparison) {
    Json json;
    json["same"] = comparison.same;
    json["reason"] = comparison.reason;
    json["width"] = comparison.width;
    json["height"] = comparison.height;
    // What cannot be told, or was not asked for, is null.
    for (const char* key :
         {"max", "max_at", "mean", "rmse", "psnr", "ssim", "differing_pixels", "differing_percent", "bounding_box"}) {
        json[key] = nullptr;
    }
    json["failed"] = comparison.failed;
    json["metric"] = diff_metric_name(comparison.metric);
    json["threshold"] = finite(comparison.threshold);
    json["metadata"] = comparison.metadata;
    for (const char* key : {"compared_pixels", "max_channel", "max_values", "flip", "flip_max", "flip_max_at",
                            "antialiased_pixels", "densest_window", "shift"}) {
        json[key] = nullptr;
    }
    if (!comparison.comparable) return json;
    add_figures(comparison, json);
    add_more(comparison, json);
    return json;
}

Json report_json(const FolderComparison& comparison) {
    Json json;
    json["same"] = comparison.same;
    json["pairs"] = comparison.pairs.size();
    for (const auto& [key, state] : {std::pair{"same_pairs", PairState::same},
                                     {"different_pairs", PairState::different},
                                     {"not_compared_pairs", PairState::not_compared}}) {
        json[key] = comparison.count(state);
    }
    json["missing"] = Json::array();
    json["extra"] = Json::array();
    json["links_not_followed"] = comparison.loops;
    json["results"] = Json::array();
    for (const PairResult& pair : comparison.pairs) {
        if (pair.state == PairState::missing) json["missing"].push_back(pair.path);
        if (pair.state == PairState::extra) json["extra"].push_back(pair.path);
        Json result{{"path", pair.path}, {"state", pair_state_name(pair.state)}};
        if (pair.state == PairState::not_compared) result["error"] = pair.error;
        if (pair.state == PairState::same || pair.state == PairState::different) {
            result.update(report_json(pair.comparison));
        }
        json["results"].push_back(std::move(result));
    }
    return json;
}

void print_folders(const FolderComparison& comparison) {
    for (const PairResult& pair : comparison.pairs) {
        if (pair.state == PairState::same || pair.state == PairState::not_compared) continue;
        std::cout << pair_state_name(pair.state) << ": " << printable(pair.path);
        if (pair.state == PairState::different) std::cout << ": " << pair.comparison.reason;
        std::cout << '\n';
    }
    std::cout << (comparison.same ? "same: " : "different: ") << comparison.count(PairState::same) << " of "
              << comparison.pairs.size() << " pictures are the same";
    for (const PairState state :
         {PairState::different, PairState::missing, PairState::extra, PairState::not_compared}) {
        if (const std::size_t pairs = comparison.count(state)) {
            std::cout << ", " << pairs << ' ' << pair_state_name(state);
        }
    }
    std::cout << '\n';
}

}  // namespace puppetwarp::cli
