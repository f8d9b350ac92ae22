#pragma once

#include <puppetwarp/base/progress.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp {

//! The families of weights, by their names on the command line and in puppet files.
enum class WeightKind {
    shepard,        //!< inverse squared distance
    harmonic,       //!< least Dirichlet energy
    biharmonic,     //!< least Laplacian energy
    bbw,            //!< bounded biharmonic: the same between 0 and 1
    l1,             //!< bounded biharmonic with a budget of the integral, compact support
    monotonic,      //!< biharmonic without extrema away from the handles
    mean_value,     //!< of a cage: mean value coordinates
    harmonic_cage,  //!< of a cage: harmonic coordinates
    green,          //!< of a cage: Green coordinates, the same map as `cauchy`
    cauchy          //!< of a cage: Cauchy coordinates, complex
};

//! How `bbw` makes the weights of a vertex sum to 1.
enum class Partition {
    coupled,    //!< within the minimisation, all handles at once: the minimum of the paper's energy
    normalised  //!< afterwards, by division: each handle on its own, quicker, up to 0.14 off
};

struct WeightOptions {
    WeightKind kind = WeightKind::bbw;
    Partition partition = Partition::coupled;
    double tolerance = 1e-8;   //!< largest KKT residual of `bbw`, `l1` and `monotonic` that counts as solved, above 0
    int max_iterations = 200;  //!< of those, at least 1; stopping here is `converged = false`
    double l1_budget = 0.8;    //!< of `l1`: largest integral of a weight, as a share of what it has unbounded; (0, 1]
};

//! Names of all kinds, in the order of `WeightKind`.
std::vector<std::string> weight_kind_names();
std::string weight_kind_name(WeightKind kind);
//! \throw InvalidInput  unknown name (lists the known ones).
WeightKind weight_kind_from_name(std::string_view name);
std::string partition_name(Partition partition);
//! \throw InvalidInput  unknown name (lists the known ones).
Partition partition_from_name(std::string_view name);

//! Whose share one column of weights is.
struct WeightColumn {
    int handle = 0;   //!< index in Rig::handles
    int corner = -1;  //!< of a cage, 0-based; -1 for the others, which have one column

    bool operator==(const WeightColumn&) const = default;
};

//! How much each vertex follows each handle.
struct Weights {
    std::vector<WeightColumn> columns;  //!< in the order of the handles, a cage's corners one after the other
    //! #V x #columns; rows sum to 1. Of `green` and `cauchy` the real part.
    Eigen::MatrixXd W;
    //! #V x #columns imaginary part of `green` and `cauchy`, rows sum to 0; empty for the others. A vertex goes to the
    //! sum of (W + i W_imaginary) times the corners' places, written as complex numbers x + i y.
    Eigen::MatrixXd W_imaginary;
    int iterations = 0;  //!< factorisations of the solver, all handles together; 0 where one solve is enough
    bool converged = true;
    double kkt_residual = 0;     //!< of the constrained kinds, as `WeightOptions::tolerance` measures it
    double partition_error = 0;  //!< largest |row sum - 1|
    std::string fallback;        //!< which slower solver finished the work, or empty
    std::vector<std::string> warnings;
};

//! Header of a column: the handle's id, with the corner for cages: `hull[3]`.
std::string column_name(const Rig& rig, const WeightColumn& column);

//! Weights of every handle at every vertex. Points hold the vertex nearest to them, bones the vertices along them, but
//! for a small radius about joints that they share; regions hold what lies inside; on the edges of a cage weights are
//! linear. A component of the mesh that no handle holds goes to the nearest handle, and a warning says so.
//! Where a cage lies outside the mesh, weights are computed on a larger mesh that the cage bounds.
//! \param progress  hears of `weights`, of `bbw` handle by handle; may cancel.
//! \throw InvalidInput  no handles, a handle outside the mesh, two handles on one vertex, bones that cross, a cage that
//!        crosses itself or holds nothing of the mesh, a kind that cannot use a handle, options out of range.
//! \throw Cancelled
Weights compute_weights(const TriangleMesh& mesh, const Rig& rig, const WeightOptions& options, Progress& progress);

}  // namespace puppetwarp
