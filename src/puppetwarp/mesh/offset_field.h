#pragma once

#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/silhouette.h>

#include <vector>

namespace puppetwarp {

//! A closed polygon with the distance by which each of its points is to be grown. Same size.
struct GrownPolygon {
    Polyline points;
    std::vector<double> radii;  //!< at least 0; linear along the edges
};

//! Sets `field` to the signed distance function of the silhouette grown by its radii: positive inside, exact within
//! one unit of the boundary, clamped beyond. Everything in the field's coordinates.
void fill_offset(ContourField& field, const std::vector<GrownPolygon>& silhouette);

//! Makes `field` the union of itself and `other`, whose nodes are some of its own.
void unite(ContourField& field, const ContourField& other);

//! The radius that each point of a support silhouette needs, so that the squares of the covered pixels beside it lie
//! within, slowly varying along the outline. Pixels farther than two pixels out are not considered.
//! \param margin  how much more than needed.
std::vector<GrownPolygon> radii_for_support(const std::vector<Polyline>& silhouette, const MatteReader& matte,
                                            double margin);

}  // namespace puppetwarp
