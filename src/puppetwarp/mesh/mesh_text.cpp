#include <puppetwarp/mesh/mesh_text.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

constexpr std::size_t most_vertices = 50'000'000;  // indices stay far from overflow, memory within reason

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

// Lines of a text without comments, one at a time, and the words on them.
class LineReader {
public:
    LineReader(std::string_view text, const std::string& subject) : text_(text), subject_(subject) {}

    // The next line that has a word on it; false at the end.
    bool next_line() {
        while (!text_.empty()) {
            const std::size_t end = std::min(text_.find('\n'), text_.size());
            line_ = text_.substr(0, end);
            text_.remove_prefix(std::min(end + 1, text_.size()));
            ++number_;
            line_ = line_.substr(0, line_.find('#'));
            skip_space();
            if (!line_.empty()) return true;
        }
        line_ = {};
        return false;
    }

    // The next word of this line; empty at its end.
    std::string_view word() {
        const auto end = std::find_if(line_.begin(), line_.end(), is_space);
        const std::string_view word = line_.substr(0, static_cast<std::size_t>(end - line_.begin()));
        line_.remove_prefix(word.size());
        skip_space();
        return word;
    }

    double coordinate() {
        const std::string_view text = word();
        double value = 0;
        const char* begin = text.data() + (!text.empty() && text.front() == '+' ? 1 : 0);
        const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
        if (text.empty() || end != text.data() + text.size() ||
            (error != std::errc() && error != std::errc::result_out_of_range)) {
            fail("a coordinate is missing or not a number");
        }
        if (error == std::errc::result_out_of_range || !std::isfinite(value))
            fail("a coordinate is not a finite number");
        return value;
    }

    long long integer(const char* what) { return integer(word(), what); }

    long long integer(std::string_view text, const char* what) const {
        long long value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (text.empty() || error != std::errc() || end != text.data() + text.size()) {
            fail(std::string(what) + " is missing or not a whole number");
        }
        return value;
    }

    [[noreturn]] void fail(const std::string& reason) const {
        throw InvalidInput(subject_, "line " + std::to_string(number_) + ": " + reason, "export the mesh again");
    }

private:
    void skip_space() {
        const auto first = std::find_if_not(line_.begin(), line_.end(), is_space);
        line_.remove_prefix(static_cast<std::size_t>(first - line_.begin()));
    }

    std::string_view text_, line_;
    const std::string& subject_;
    int number_ = 0;
};

// Gathers a mesh of unknown size.
struct MeshParts {
    std::vector<std::array<double, 2>> points;
    std::vector<std::array<int, 3>> triangles;

    void add_polygon(const std::vector<int>& corners) {
        for (std::size_t k = 1; k + 1 < corners.size(); ++k)
            triangles.push_back({corners[0], corners[k], corners[k + 1]});
    }

    TriangleMesh mesh() const {
        TriangleMesh mesh{Eigen::MatrixX2d(static_cast<Eigen::Index>(points.size()), 2),
                          Eigen::MatrixX3i(static_cast<Eigen::Index>(triangles.size()), 3)};
        Eigen::Index row = 0;
        for (const auto& [x, y] : points) mesh.V.row(row++) << x, y;
        row = 0;
        for (const auto& [a, b, c] : triangles) mesh.F.row(row++) << a, b, c;
        return mesh;
    }
};

int checked_index(const LineReader& lines, long long index, std::size_t vertices) {
    if (index < 0 || index >= static_cast<long long>(vertices)) {
        lines.fail("a triangle names a vertex that does not exist");
    }
    return static_cast<int>(index);
}

// What stands before the coordinates' count: OFF, or with texture coordinates, colours, normals. The numbers of those
// come after the coordinates on a vertex's line and are passed over.
bool is_off_header(std::string_view word) {
    for (const std::string_view prefix : {"ST", "C", "N"}) {
        if (word.substr(0, prefix.size()) == prefix) word.remove_prefix(prefix.size());
    }
    return word == "OFF";
}

std::string number(double value) {
    char buffer[32];
    return std::string(buffer, static_cast<std::size_t>(std::snprintf(buffer, sizeof(buffer), "%.17g", value)));
}

// Words with spaces between them.
void append(std::string& text, std::initializer_list<std::string> words) {
    bool first = true;
    for (const std::string& word : words) {
        if (!first) text += ' ';
        text += word;
        first = false;
    }
}

std::vector<std::pair<int, int>> edges_of(const TriangleMesh& mesh) {
    std::vector<std::pair<int, int>> edges;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (Eigen::Index k = 0; k < 3; ++k) {
            edges.push_back(std::minmax<int>({mesh.F(t, k), mesh.F(t, (k + 1) % 3)}));
        }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

}  // namespace

TriangleMesh mesh_from_off(std::string_view text, const std::string& subject) {
    LineReader lines(text, subject);
    if (!lines.next_line() || !is_off_header(lines.word())) lines.fail("it does not begin with OFF");
    std::string_view count = lines.word();
    if (count == "BINARY") lines.fail("it is a binary OFF file");
    if (count.empty()) {
        if (!lines.next_line()) lines.fail("the numbers of vertices and faces are missing");
        count = lines.word();
    }
    const long long vertices = lines.integer(count, "the number of vertices");
    const long long faces = lines.integer("the number of faces");
    if (vertices < 0 || faces < 0) lines.fail("a count is negative");
    if (vertices > static_cast<long long>(most_vertices)) lines.fail("it has too many vertices");
    // Counts are claims: memory grows with what is there.
    MeshParts parts;
    for (long long k = 0; k < vertices; ++k) {
        if (!lines.next_line()) lines.fail("the file ends before its last vertex");
        const double x = lines.coordinate();
        parts.points.push_back({x, lines.coordinate()});
    }
    std::vector<int> corners;
    for (long long k = 0; k < faces; ++k) {
        if (!lines.next_line()) lines.fail("the file ends before its last face");
        const long long size = lines.integer("the number of corners");
        if (size < 3) lines.fail("a face has fewer than three corners");
        corners.clear();
        for (long long corner = 0; corner < size; ++corner) {
            corners.push_back(checked_index(lines, lines.integer("a corner"), parts.points.size()));
        }
        parts.add_polygon(corners);
    }
    return parts.mesh();
}

TriangleMesh mesh_from_obj(std::string_view text, const std::string& subject) {
    LineReader lines(text, subject);
    MeshParts parts;
    std::vector<int> corners;
    while (lines.next_line()) {
        const std::string_view kind = lines.word();
        if (kind == "v") {
            if (parts.points.size() >= most_vertices) lines.fail("it has too many vertices");
            const double x = lines.coordinate();
            parts.points.push_back({x, lines.coordinate()});
        } else if (kind == "f") {
            corners.clear();
            for (std::string_view corner = lines.word(); !corner.empty(); corner = lines.word()) {
                const long long index = lines.integer(corner.substr(0, corner.find('/')), "a corner");
                if (index == 0) lines.fail("indices count from 1");
                const long long from_end = static_cast<long long>(parts.points.size());
                // Faces may name vertices that come later; those are looked at when all are known.
                if (index < -from_end || index > static_cast<long long>(most_vertices)) {
                    lines.fail("a triangle names a vertex that does not exist");
                }
                corners.push_back(static_cast<int>(index > 0 ? index - 1 : from_end + index));
            }
            if (corners.size() < 3) lines.fail("a face has fewer than three corners");
            parts.add_polygon(corners);
        }
    }
    for (const auto& triangle : parts.triangles) {
        for (const int corner : triangle) {
            if (corner >= static_cast<int>(parts.points.size())) {
                throw InvalidInput(subject,
                                   "a triangle names vertex " + std::to_string(corner + 1) + " of " +
                                       std::to_string(parts.points.size()),
                                   "export the mesh again");
            }
        }
    }
    return parts.mesh();
}

std::string off_from_mesh(const TriangleMesh& mesh) {
    std::string text = "OFF\n";
    append(text, {std::to_string(mesh.V.rows()), std::to_string(mesh.F.rows()), "0\n"});
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        append(text, {number(mesh.V(v, 0)), number(mesh.V(v, 1)), "0\n"});
    }
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        append(text, {"3", std::to_string(mesh.F(t, 0)), std::to_string(mesh.F(t, 1)), std::to_string(mesh.F(t, 2))});
        text += "\n";
    }
    return text;
}

std::string obj_from_mesh(const TriangleMesh& mesh, const Eigen::MatrixX2d& texture) {
    std::string text;
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        append(text, {"v", number(mesh.V(v, 0)), number(mesh.V(v, 1)), "0\n"});
    }
    for (Eigen::Index v = 0; v < texture.rows(); ++v) {
        append(text, {"vt", number(texture(v, 0)), number(texture(v, 1)) + "\n"});
    }
    const auto corner = [&](int vertex) {
        const std::string index = std::to_string(vertex + 1);
        return texture.rows() == 0 ? index : index + "/" + index;
    };
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        append(text, {"f", corner(mesh.F(t, 0)), corner(mesh.F(t, 1)), corner(mesh.F(t, 2))});
        text += "\n";
    }
    return text;
}

std::string svg_from_mesh(const TriangleMesh& mesh, const DrawingArea& area) {
    std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(area.width * area.scale) +
                       "\" height=\"" + number(area.height * area.scale) + "\" viewBox=\"";
    append(text, {number(area.x), number(area.y), number(area.width), number(area.height)});
    text += "\">\n<path fill=\"none\" stroke=\"#202020\" stroke-width=\"0.5\" d=\"";
    for (const auto& [a, b] : edges_of(mesh)) {
        text += "M";
        append(text, {number(mesh.V(a, 0)), number(mesh.V(a, 1))});
        text += "L";
        append(text, {number(mesh.V(b, 0)), number(mesh.V(b, 1))});
        text += "\n";
    }
    return text + "\"/>\n</svg>\n";
}

}  // namespace puppetwarp
