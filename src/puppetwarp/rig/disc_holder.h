#pragma once
// Private header.

#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

//! Takes hold of a mesh by discs: what that needs to know of the mesh, computed once for all handles. The mesh must
//! outlive it.
class DiscHolder {
public:
    explicit DiscHolder(const TriangleMesh& mesh);

    //! A disc's hold, `handle` left 0.
    //! \param place   where `at` lies in the mesh; inside it or on its border.
    //! \param radius  above 0, px.
    Hold hold(const MeshLocation& place, const Point& at, double radius) const;

    MeshLocation locate(const Point& at) const { return locator_.locate(at); }
    //! Whether a place is neither in the mesh nor on its border.
    bool outside(const MeshLocation& place) const { return place.distance_px > on_border * size_; }
    const Eigen::VectorXi& component() const { return component_; }
    double size() const { return size_; }

private:
    double distance(int vertex, const Point& p) const { return (mesh_.V.row(vertex).transpose() - p).norm(); }
    std::vector<int> reachable(int triangle, const Point& centre, double radius) const;
    bool centre_mean(ComplexRow& row, const Point& centre) const;
    double longest_edge(int triangle) const;
    ComplexRow mean_over_disc(const std::vector<int>& vertices, const Point& centre, double radius) const;
    std::vector<std::pair<int, double>> triangle_weights(const std::vector<int>& vertices, const Point& centre,
                                                         double radius, int triangle) const;
    ComplexRow mean_turn(const std::vector<std::pair<int, double>>& weights) const;

    const TriangleMesh& mesh_;
    MeshLocator locator_;
    Eigen::VectorXi component_;
    Eigen::VectorXd mass_;
    Eigen::MatrixX3cd gradients_;
    Eigen::VectorXd double_areas_;
    double size_;
    std::vector<std::vector<int>> triangles_at_;
};

//! `take_hold` for one rig after the other of one mesh.
//! \param discs  of this mesh.
Binding take_hold(const DiscHolder& discs, const TriangleMesh& mesh, const Rig& rig, std::string_view user);

}  // namespace puppetwarp
