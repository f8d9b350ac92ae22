#pragma once
// Private header.

#include <puppetwarp/deform/turn_goals.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/cholesky.h>

#include <Eigen/SparseCore>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp {

//! A quadratic energy x^H A x of complex positions that is 0 for what moves as a whole.
struct QuadraticForm {
    using Matrix = Eigen::SparseMatrix<std::complex<double>>;
    //! What costs nothing on each component: moving it, or any similarity of it. Nothing else may.
    enum class NullSpace { translations, similarities };

    Matrix A;  //!< #V x #V, Hermitian, positive semi-definite, compressed, both triangles
    NullSpace null_space = NullSpace::translations;
    //! A x, where A = B^H B as B^H (B x): entries of A alone are too coarse for what costs almost nothing.
    std::function<Eigen::VectorXcd(const Eigen::VectorXcd&)> product;
};

//! |B x|^2 of a sparse B.
QuadraticForm squared_norm(const QuadraticForm::Matrix& B, QuadraticForm::NullSpace null_space);

//! Where all that is held goes, as values of its rows.
struct HeldGoals {
    Eigen::VectorXcd means;     //!< in the order of Binding::holds
    Eigen::VectorXcd vertices;  //!< positions, in the order of Binding::vertices
    std::vector<RowGoal> rows;  //!< turns and shears
};

//! Minimises a quadratic energy within what handles constrain, prepared once. Held vertices are not unknowns; means are
//! met by fields that are computed beforehand, one for each mean (it moves by 1, the others stay), turns and shears by
//! the answers to a couple on them while the means stay: so that a step without load is one product of these fields
//! with what is missing. Parts that no handle holds stay. Immutable, safe to share between threads.
//! What no handle fixes, a similarity of a part with one hold, stays as it is.
class HeldQuadratic {
public:
    //! \param affine  whether shears may be fixed.
    //! \throw InvalidInput  the mesh's triangles are too bad to compute with.
    HeldQuadratic(QuadraticForm form, const TriangleMesh& mesh, const Binding& binding, AffineUse affine);

    //! Goals for targets. \param free_scale  an angle without a scale leaves that free, else it is 1.
    HeldGoals goals_of(const Targets& targets, const Eigen::VectorXcd& rest, bool free_scale) const;

    //! Takes x to the minimum of u^H A u - 2 Re(load^H u) over the steps u that meet the goals.
    //! \param x     #V.
    //! \param load  #V, or null for 0; must not push on what costs nothing.
    //! \param passes  further ones take away what round-off left, where held vertices or a load are solved for.
    void step(const HeldGoals& goals, const Eigen::VectorXcd* load, Eigen::VectorXcd& x, int passes = 1) const;

    //! The largest distance of what is held from its goal, px.
    double largest_error(const HeldGoals& goals, const Eigen::VectorXcd& x) const;
    //! \throw InvalidInput  the goals are missed by more than round-off: they contradict each other.
    double require_met(const HeldGoals& goals, const Eigen::VectorXcd& x, const std::string& pose) const;

private:
    struct Row {
        int hold;
        bool shear;
        double radius_px;
        ComplexRow entries;  // times the radius
    };
    struct Mode {
        std::vector<int> free;  // the unknowns of one component
        Eigen::VectorXcd value;
    };
    struct Field {
        Eigen::VectorXcd u;            // of the unknowns
        Eigen::VectorXcd multipliers;  // on the means, that hold it
    };

    void find_unknowns(const Binding& binding);
    void find_modes(const Eigen::VectorXi& component);
    void add_modes(const std::vector<int>& free, const std::vector<int>& held);
    void keep_idle_modes();
    void add_stiffness(const ComplexRow& mean, int parts, std::vector<Eigen::Triplet<double>>& entries) const;
    void factorise();
    ComplexRow without_traces(const ComplexRow& row) const;
    void prepare_rows(const Binding& binding, AffineUse affine);
    Eigen::MatrixXcd mean_answers() const;
    Eigen::VectorXcd means_of(const Eigen::VectorXcd& u) const;
    Eigen::VectorXcd answer(const Eigen::MatrixXcd& fields, const Eigen::VectorXcd& shares) const;
    Field field_of(const Eigen::VectorXcd& load, const Eigen::VectorXcd& means, const Eigen::MatrixXcd& fields,
                   const Eigen::MatrixXcd& system) const;
    void prepare_fields();
    Eigen::VectorXcd load_of(const ComplexRow& row) const;
    Eigen::VectorXcd load_of(const Eigen::VectorXcd& multipliers) const;
    std::complex<double> free_value(const ComplexRow& row, const Eigen::VectorXcd& u) const;
    Eigen::VectorXcd inverse(Eigen::VectorXcd load) const;
    Eigen::VectorXcd meet_goals(const HeldGoals& goals, Eigen::VectorXcd& x) const;
    Eigen::VectorXcd missing_means(const HeldGoals& goals, const Eigen::VectorXcd& x) const;
    void add(const Eigen::VectorXcd& u, Eigen::VectorXcd& x) const;

    QuadraticForm form_;
    Eigen::VectorXcd rest_;
    double size_;
    bool real_ = true;           // all entries of A are
    std::vector<int> free_;      // vertices that may move
    std::vector<int> slot_;      // of each vertex among them, or -1
    std::vector<int> vertices_;  // that are held
    std::vector<Mode> modes_;    // orthonormal: what costs nothing and no held vertex hinders
    std::vector<int> grounds_;   // unknowns, as many as modes, that together hold them
    double mean_stiffness_ = 0;  // of each mean, in the factor only
    std::optional<CholeskyFactor> factor_;
    std::vector<ComplexRow> means_;
    std::vector<Row> rows_;
    Eigen::MatrixXcd mean_fields_;       // #free x #means
    Eigen::MatrixXcd row_fields_;        // #free x #rows
    Eigen::MatrixXcd mean_multipliers_;  // #means x #means: on the means, that hold such a field
    Eigen::MatrixXcd row_multipliers_;   // #means x #rows: the same
    Eigen::MatrixXcd idle_fields_;       // #free x what costs nothing and moves no mean
    Eigen::MatrixXcd row_response_;
    Eigen::MatrixXcd idle_response_;
};

}  // namespace puppetwarp
