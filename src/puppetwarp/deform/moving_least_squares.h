#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/mls_moments.h>
#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

//! `mls-affine`, `mls-similarity`, `mls-rigid`: at each vertex the affine map, the similarity or the rigid motion that
//! fits all handles best, weighted by 1 / d^2, in closed form.   Schaefer et al. 2006.
//! A field over the plane, evaluated at the vertices: no mesh, no energy of it, nothing of the shape; only parts that
//! no handle holds stay, as in every method. Points are interpolated at their own place, not in the mean over their
//! disc.
//! - A bone is a segment, by the integrals over it; it weighs as points a default disc radius apart. A region is the
//!   segments of its outline, and what lies inside moves by its map. Both are interpolated where the map's kind can.
//! - A point's angle, scale 1 unless given, is a wish for the map's f_z with the weight of the point times its
//!   squared radius: two further handles on its disc, opposite to each other, that share its weight. The field then has
//!   this f_z at the point. A scale alone takes the direction that the field has there without it. `mls-rigid` cannot
//!   scale and says so. An affine map (`mls-affine` alone) is such a wish for f_z and f_zbar.
//! - One handle: its translation, with its angle. Handles on one line: `mls-affine` is `mls-similarity`.
//! Energy: the mean over the vertices of the weighted mean square residual of their fits, px^2.
class MovingLeastSquaresDeformer : public Deformer {
public:
    //! \param method  one of the three.
    MovingLeastSquaresDeformer(Method method, const TriangleMesh& mesh, const Rig& rig);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    struct Disc {                  // a point, or a vertex
        std::vector<int> handles;  // all that are in this place: it weighs once
        std::complex<double> at;
        double radius_px;
    };
    struct Curve {  // a bone, or the outline of a region
        int handle;
        std::vector<std::complex<double>> points;
    };
    // What a pose makes of a disc.
    struct Moved {
        std::complex<double> move;
        std::complex<double> turn = 0, shear = 0;  // f_z - 1, f_zbar
        bool turned = false;
    };

    AffineUse affine_use() const { return method_ == Method::mls_affine ? AffineUse::yes : AffineUse::no; }
    void collect(const Rig& rig);
    void add_disc(int handle, const std::complex<double>& at, double radius_px);
    void classify();
    int control_at(const std::complex<double>& v) const;
    MlsMoments moments(const Curve& curve, const std::complex<double>& v) const;
    std::vector<Moved> moved_discs(const Targets& targets, const Pose& pose) const;
    std::complex<double> direction_at(std::size_t disc, const std::vector<Moved>& moved, const Targets& targets) const;
    MlsFit fit_at(const std::complex<double>& v, const MlsMoments* curves, const std::vector<Moved>& moved,
                  const Targets& targets) const;
    double largest_error(const std::vector<Moved>& moved, const Targets& targets, MlsFit::Kind kind) const;
    const HandlePose* pose_of(int handle, const Pose& pose) const;
    std::vector<std::string> warnings(const Pose& pose) const;

    Method method_;
    TriangleMesh mesh_;
    Rig rig_;
    Eigen::VectorXcd rest_;
    double size_;
    Binding binding_;
    std::vector<Disc> discs_;
    std::vector<Curve> curves_;
    std::vector<int> control_;         // #V: the handle that has the vertex, or -1
    std::vector<MlsMoments> moments_;  // of each vertex and curve
    bool one_place_ = false;           // all handles are in one
    bool one_line_ = false;            // or on one
};

}  // namespace puppetwarp
