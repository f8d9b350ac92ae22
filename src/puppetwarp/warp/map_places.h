#pragma once

#include <puppetwarp/warp/displacement.h>

#include <optional>

namespace puppetwarp::detail {

//! What one pixel of an output shows, by a displacement map.
struct ShownPlace {
    Point at;               //!< in pixels of the picture
    double shown = 1;       //!< how much of it, in (0, 1]
    Eigen::Matrix2d slope;  //!< from one pixel of the output to the next: d at / d x, d at / d y as columns
};

//! Reads a displacement map for a picture and an output of any resolution. Keeps a reference to the map.
class MapPlaces {
public:
    //! \param magnification  pixels of the output for one of the map, along x and y.
    MapPlaces(const DisplacementMap& map, const Canvas& canvas, const Eigen::Array2d& magnification,
              const Image& picture);

    //! The place that pixel (column, row) of the canvas shows; none beyond the map and where it shows nothing, nor
    //! where it shows what is more than half a pixel outside of the picture.
    std::optional<ShownPlace> shown(int column, int row) const;
    //! Whether a pixel shows some place, and all of it.
    bool is_covered(int column, int row) const;

private:
    struct Node;
    std::optional<Node> node(int column, int row) const;
    std::optional<Node> node_at(int column, int row) const;
    std::optional<Node> node_near(int column, int row) const;
    std::optional<Point> stored(std::int64_t x, std::int64_t y) const;
    double stored_share(std::int64_t x, std::int64_t y) const;
    Point between(const Node& node) const;
    bool is_in_picture(const Point& at) const;

    const DisplacementMap& map_;
    Canvas canvas_;
    Eigen::Array2d magnification_;
    bool same_size_;  // no magnification
    double width_, height_;
    bool has_alpha_;
    Eigen::Array2d resolution_;  // pixels of the picture for one of the map's source
};

}  // namespace puppetwarp::detail
