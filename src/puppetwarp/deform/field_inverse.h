#pragma once
// Private header.

#include <puppetwarp/deform/field_energy.h>

#include <memory>
#include <vector>

namespace puppetwarp {

//! Solves A u = r for the matrix A of a FieldEnergy, with u given at some vertices. Powers of L are never multiplied
//! out, so that round-off grows with the condition of L and not of its power. Immutable, safe to share between threads.
class FieldInverse {
public:
    FieldInverse() = default;
    FieldInverse(const FieldInverse&) = delete;
    FieldInverse& operator=(const FieldInverse&) = delete;
    virtual ~FieldInverse() = default;

    //! #V
    virtual Eigen::Index vertices() const = 0;

    //! The u with A u = r wherever u is not held, and u = 0 where it is.
    //! A component without held vertices takes what its loads leave after their mean is taken away, and u has mean 0
    //! there, both by area.   \param loads  #V x #fields, r.
    virtual Eigen::MatrixXd respond(const Eigen::MatrixXd& loads) const = 0;

    //! The u with A u = 0 wherever u is not held; 0 on components without held vertices.
    //! \param values  #V x #fields, u where it is held, else 0.
    virtual Eigen::MatrixXd extend(const Eigen::MatrixXd& values) const = 0;
};

//! \param component  #V, as `vertex_components` gives.
//! \param held       #V, whether u is given there.
//! \throw InvalidInput  triangles too bad to compute with.
std::unique_ptr<FieldInverse> make_field_inverse(const FieldEnergy& energy, const Eigen::VectorXi& component,
                                                 const std::vector<bool>& held);

//! Takes functions' means over each component away. \param weight  #V, their weights; nowhere below 0.
class ComponentMeans {
public:
    ComponentMeans(const Eigen::VectorXi& component, const Eigen::VectorXd& weight);
    //! From the functions x (#V x #fields) their means.
    void remove(Eigen::MatrixXd& x) const;
    //! From the loads r (#V x #fields) what does not sum to 0, spread by weight: the transpose of the above.
    void remove_from_loads(Eigen::MatrixXd& r) const;

private:
    Eigen::VectorXi component_;
    Eigen::Index count_;      // of components
    Eigen::VectorXd weight_;  // sums to 1 over each component
};

}  // namespace puppetwarp
