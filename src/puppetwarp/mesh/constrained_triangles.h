#pragma once
// Private header: CGAL's types. What includes it is compiled with the options in CMakeLists.txt.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cstddef>

namespace puppetwarp {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using Triangles = CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Triangles, CGAL::Exact_predicates_tag>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Cdt>;
using Mesher = CGAL::Delaunay_mesher_2<Cdt, Criteria>;

//! What CGAL's criteria want of an angle.
double squared_sine(double angle_deg);

enum class Refinement {
    done,
    too_many,  //!< more vertices than allowed
    in_vain    //!< round-off made triangles flat, which are split for ever
};

//! Refines until no triangle of the domain is bad. \pre mesher.init() was called.
Refinement refine_domain(Mesher& mesher, const Cdt& cdt, std::size_t max_vertices);

//! The triangles in the domain, each from its lowest index on, sorted; vertices in the order of their insertion.
//! Afterwards `info()` of each vertex is its index, or -1.
TriangleMesh domain_triangles(Cdt& cdt);

}  // namespace puppetwarp
