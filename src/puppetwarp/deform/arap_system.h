#pragma once
// Private header.

#include <puppetwarp/deform/arap_energy.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/solve/constraint_space.h>

#include <vector>

namespace puppetwarp {

//! What is constrained of a mesh: a weighted mean and its turn, or one vertex.
struct ArapHold {
    ComplexRow mean;
    ComplexRow turn;  //!< empty when hard
    double radius_px = 0;
    bool hard = false;  //!< one vertex
};

//! The holds of a binding, then its vertices.
std::vector<ArapHold> arap_holds(const Binding& binding);

//! The unknowns of an ARAP problem, (Re, Im) of each vertex that may move freely, and the second derivative over them.
//! Hard holds and parts that no handle holds are not unknowns. Immutable.
class ArapSystem {
public:
    ArapSystem(const ArapCells& cells, const std::vector<ArapHold>& holds, const std::vector<bool>& loose);

    Eigen::Index unknowns() const { return 2 * static_cast<Eigen::Index>(free_.size()); }
    //! The unknowns' part of a function on all vertices.
    Eigen::VectorXd restricted(const Eigen::VectorXcd& x) const;
    //! Adds a step of the unknowns to the positions.
    void add(double factor, const Eigen::VectorXd& step, Eigen::VectorXcd& x) const;

    //! Re(conj(direction) row) as a row over the unknowns; `fixed` receives what the other vertices contribute at x.
    std::vector<std::pair<int, double>> real_row(const ComplexRow& row, std::complex<double> direction,
                                                 const Eigen::VectorXcd& x, double& fixed) const;

    //! How true a factored Hessian is to the energy at hand.
    enum class Hessian { exact, clamped, rotations_held };
    struct Factor {
        CholeskyFactor cholesky;
        Hessian kind;
    };
    //! A factor of Hessian(x) + penalty C^T C: the true Hessian where that is positive definite, else the nearest that
    //! is.   \throw InvalidInput  the mesh's triangles are too bad for any.
    Factor factorise(const Eigen::VectorXcd& x, const ConstraintSpace& constraints, bool try_exact) const;
    //! Weight of the constraints in the factor.
    double penalty() const { return penalty_; }

private:
    void build_pattern(const std::vector<ArapHold>& holds);
    void build_cell_map();
    int find(int row, int column) const;
    void fill(Eigen::SparseMatrix<double>& H, const Eigen::VectorXcd& x, const ConstraintSpace& constraints,
              Hessian kind) const;

    const ArapCells& cells_;
    std::vector<int> free_;
    std::vector<int> slot_;              // of each vertex among free_, or -1
    Eigen::SparseMatrix<double> lower_;  // pattern; values: 2 K
    std::vector<int> cell_map_;          // where each cell's entries are in the values
    std::optional<CholeskyPattern> pattern_;
    double penalty_ = 0;
};

}  // namespace puppetwarp
