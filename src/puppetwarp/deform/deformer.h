#pragma once

#include <puppetwarp/base/progress.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>
#include <puppetwarp/weights/weights.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp {

//! The deformation methods, by their names on the command line and in puppet files.
enum class Method {
    harmonic,
    biharmonic,
    triharmonic,
    tetraharmonic,
    thin_shell,
    laplacian,
    laplacian_rotated,
    laplacian_similarity,
    multiresolution,
    arap,
    smooth_arap,
    fold_free,
    fast,
    lbs,
    dual_complex,
    intrinsic,
    mls_affine,
    mls_similarity,
    mls_rigid
};

//! Which edges share a rotation in the `arap` energy.
enum class ArapEnergy {
    elements,        //!< each triangle: Liu et al. 2008
    spokes,          //!< edges at a vertex, each counted at both ends: Sorkine & Alexa 2007
    spokes_and_rims  //!< all edges of the triangles at a vertex, each triangle counted three times: Chao et al. 2010
};

struct MethodOptions {
    Method method = Method::arap;
    ArapEnergy arap_energy = ArapEnergy::elements;
    //! Of `smooth-arap`: lengths below it bend together. Above 0; none: a fixed share of the subject's size.
    std::optional<double> bending_length_px;
    double stretching = 1;      //!< of `thin-shell`: k_s, at least 0
    double bending = 0.01;      //!< of `thin-shell`: k_b as a share of the subject's squared diagonal, at least 0
    double tolerance = 1e-8;    //!< iterative methods stop at this relative change of energy, above 0
    int max_iterations = 1000;  //!< at least 1; stopping here is `converged = false`
    WeightOptions weights;      //!< of the skinning methods
};

//! What `smooth-arap` bends by when no length is given: a fiftieth of the bounding diagonal, in pixels.
double usual_bending_length_px(const TriangleMesh& mesh);

//! Names of all methods, in the order of `Method`.
std::vector<std::string> method_names();
std::string method_name(Method method);
//! \throw InvalidInput  unknown name (lists the known ones).
Method method_from_name(std::string_view name);
std::string arap_energy_name(ArapEnergy energy);
ArapEnergy arap_energy_from_name(std::string_view name);

//! What a method made of a pose.
struct Deformation {
    Eigen::MatrixX2d V;  //!< #V x 2 moved positions, image pixels
    int iterations = 0;  //!< 0 for linear methods and blends
    bool converged = true;
    double energy = 0;  //!< the method's own energy at V, px^2; of a k-harmonic displacement px^(4 - 2 k);
                        //!< 0 of a blend, which minimises none
    std::vector<double> energy_history;  //!< from the start to `energy`, never rising
    double max_handle_error_px = 0;      //!< against what each handle constrains
    std::vector<std::string> warnings;   //!< what a person should know of: parts of the mesh that no handle holds
};

//! A method made ready for one mesh and one set of handles; immutable, safe to share between threads.
class Deformer {
public:
    virtual ~Deformer() = default;

    //! \param pose      targets; handles that it does not name stay at rest.
    //! \param start     #V x 2 positions to begin from, or null for the rest pose.
    //! \param progress  hears of each iteration; may cancel.
    //! \throw InvalidInput  the pose does not fit the rig, or asks for what the method cannot do; two handles in
    //!        one place are sent to different ones.
    //! \throw Cancelled
    virtual Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const = 0;

    //! The same method on the same mesh for another rig, quicker than anew: it shares what does not change, such as
    //! factors and the responses to handles that stay. For handles added or removed while a person works. Both remain
    //! usable, and independent of each other's lifetime.
    //! \return null where nothing can be shared: `make_deformer` then.
    //! \throw InvalidInput  as `make_deformer`.
    virtual std::unique_ptr<Deformer> with_rig(const Rig& rig) const;
};

//! Whether a method moves the mesh by weights of the handles: `fast`, `lbs`, `dual-complex`, `intrinsic`.
bool uses_weights(Method method);

//! Prepares a method: operators, binding of the handles, factorisations, weights.
//! \param progress  hears of `weights`, which may take seconds; may cancel. Without it nobody does.
//! \throw InvalidInput  a handle outside the mesh, handles that the method cannot use,
//!        no handles, options out of range.
//! \throw Cancelled
std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                        Progress& progress);
std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);

//! Prepares a method that uses weights with ones that are ready.
//! \param weights  `compute_weights` of this mesh and rig; `options.weights` is not asked.
//! \pre uses_weights(options.method)
//! \throw InvalidInput  as above; the weights do not fit the mesh and the rig.
std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                        const Weights& weights);

}  // namespace puppetwarp
