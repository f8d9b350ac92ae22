#pragma once

#include <puppetwarp/mesh/outline.h>

#include <sstream>
#include <string>
#include <vector>

namespace puppetwarp::tests {

//! What a text of the outline corpus describes.
struct OutlineText {
    Outline outline;
    std::vector<Polyline> constraints;
};

//! Lines `outer`, `hole` or `line` begin a polygon, a hole of the last polygon or a constraint; `x y` lines are its
//! points (nan and inf are read); everything else is passed over.
inline OutlineText parse_outline_text(const std::string& text) {
    OutlineText result;
    Polyline* points = nullptr;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string first, second;
        words >> first >> second;
        std::vector<OutlineComponent>& components = result.outline.components;
        if (first == "outer") {
            points = &components.emplace_back().outer;
        } else if (first == "hole" && !components.empty()) {
            points = &components.back().holes.emplace_back();
        } else if (first == "line") {
            points = &result.constraints.emplace_back();
        } else if (points != nullptr && !second.empty()) {
            char* end = nullptr;
            const double x = std::strtod(first.c_str(), &end);
            if (end == first.c_str()) continue;
            const double y = std::strtod(second.c_str(), &end);
            if (end != second.c_str()) points->emplace_back(x, y);
        }
    }
    return result;
}

}  // namespace puppetwarp::tests
