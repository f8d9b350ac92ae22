#include <puppetwarp/deform/deformer.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/deform/fast_skinning.h>
#include <puppetwarp/deform/laplacian_linear.h>
#include <puppetwarp/deform/laplacian_rotated.h>
#include <puppetwarp/deform/moving_least_squares.h>
#include <puppetwarp/deform/multiresolution.h>
#include <puppetwarp/deform/polyharmonic.h>
#include <puppetwarp/deform/skinning.h>
#include <puppetwarp/deform/thin_shell.h>
#include <puppetwarp/deform/variational.h>

#include <cassert>
#include <cmath>

namespace puppetwarp {

std::unique_ptr<Deformer> Deformer::with_rig(const Rig&) const {
    return nullptr;
}

namespace {

void require_sound(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig) {
    if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
        throw InvalidInput("tolerance", "must be a number above 0");
    }
    if (options.max_iterations < 1) throw InvalidInput("max_iterations", "must be at least 1");
    require_sound(mesh, "mesh");
    require_sound(rig);
}

}  // namespace

bool uses_weights(Method method) {
    return method == Method::fast || method == Method::lbs || method == Method::dual_complex ||
           method == Method::intrinsic;
}

std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig) {
    Progress nobody;
    return make_deformer(options, mesh, rig, nobody);
}

std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                        const Weights& weights) {
    require_sound(options, mesh, rig);
    assert(uses_weights(options.method));
    if (options.method == Method::fast) return std::make_unique<FastSkinningDeformer>(options, mesh, rig, weights);
    return std::make_unique<SkinningDeformer>(options.method, mesh, rig, weights);
}

std::unique_ptr<Deformer> make_deformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                        Progress& progress) {
    require_sound(options, mesh, rig);
    switch (options.method) {
        case Method::harmonic: return make_polyharmonic(1, mesh, rig);
        case Method::biharmonic: return make_polyharmonic(2, mesh, rig);
        case Method::triharmonic: return make_polyharmonic(3, mesh, rig);
        case Method::tetraharmonic: return make_polyharmonic(4, mesh, rig);
        case Method::thin_shell: return make_thin_shell(options, mesh, rig);
        case Method::laplacian:
        case Method::laplacian_similarity: return std::make_unique<LinearLaplacianDeformer>(options.method, mesh, rig);
        case Method::laplacian_rotated: return std::make_unique<RotatedLaplacianDeformer>(options, mesh, rig);
        case Method::multiresolution: return std::make_unique<MultiresolutionDeformer>(options, mesh, rig);
        case Method::arap:
        case Method::smooth_arap:
        case Method::fold_free:
            return std::make_unique<VariationalDeformer>(std::make_shared<VariationalProblem>(options, mesh, rig));
        case Method::fast:
        case Method::lbs:
        case Method::dual_complex:
        case Method::intrinsic:
            return make_deformer(options, mesh, rig, compute_weights(mesh, rig, options.weights, progress));
        case Method::mls_affine:
        case Method::mls_similarity:
        case Method::mls_rigid: return std::make_unique<MovingLeastSquaresDeformer>(options.method, mesh, rig);
    }
    assert(false);
    return nullptr;
}

}  // namespace puppetwarp
