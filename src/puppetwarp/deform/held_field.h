#pragma once
// Private header.

#include <puppetwarp/deform/field_inverse.h>
#include <puppetwarp/rig/binding.h>

#include <memory>
#include <vector>

namespace puppetwarp {

//! All vertices that are held by themselves.
struct HeldVertices {
    std::vector<int> handles;          //!< that hold any, index in the rig, ascending
    std::vector<HeldVertex> vertices;  //!< in the binding's order; `handle` is the place in `handles`
    std::vector<bool> region;          //!< of each handle, whether an affine map moves it, rather than vertex by vertex
    std::vector<bool> still;           //!< of each handle, whether it stays 0
};

//! The field of least energy between vertices that are held by themselves: regions and vertex handles. What a region's
//! affine map and what a vertex's move do to the rest of the mesh is computed once, as long as these are few; else a
//! pose costs one solve. Immutable.
class HeldField {
public:
    //! \param rest  #V positions.
    HeldField(std::shared_ptr<const FieldInverse> inverse, const Eigen::VectorXcd& rest, HeldVertices held);

    //! The displacement with the held vertices' values minus `offset`, and 0 at those that are still. #V
    //! \param values  in the order of the vertices.
    //! \param maps    in the order of the handles.
    Eigen::VectorXcd operator()(const Eigen::VectorXcd& values, const std::vector<AffineMap>& maps,
                                std::complex<double> offset) const;

private:
    // What a column of `responses_` is the answer to: a vertex's own move, or a region's x^i y^j about its middle.
    struct Basis {
        int handle;
        int vertex;  // in the order of the vertices; of a region, -1
    };
    Eigen::VectorXcd coefficients(const Eigen::VectorXcd& values, const std::vector<AffineMap>& maps,
                                  std::complex<double> offset) const;

    std::shared_ptr<const FieldInverse> inverse_;
    HeldVertices held_;
    std::complex<double> middle_;  // of the mesh
    double size_ = 1;
    std::vector<Basis> bases_;  // three columns for a region, one for a vertex
    Eigen::MatrixXd responses_;
};

}  // namespace puppetwarp
