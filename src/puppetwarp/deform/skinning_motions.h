#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>
#include <puppetwarp/weights/weights.h>

#include <complex>
#include <vector>

namespace puppetwarp {

//! How one column of weights moves: a handle, or a corner of a cage.
struct ColumnMotion {
    AffineMap map;
    double angle_rad = 0;         //!< of map.alpha, whole turns counted
    std::complex<double> centre;  //!< of the handle at rest: a point's place, a bone's start, a region's centroid
};

//! Points, bones, regions and vertices move as `handle_maps` says, a corner of a cage by its translation. A point with
//! a free angle keeps that at 0. Angles are unwrapped once for the whole mesh: a bone's along its chain, the others' as
//! the pose says.
//! \param V  #V x 2 rest positions.   \pre require_sound(rig); the columns are those of its handles.
//! \return one motion a column.
//! \throw InvalidInput  require_sound(pose, rig); both ends of a bone are sent to one place; a target more than a
//!        million times the subject's size away.
std::vector<ColumnMotion> column_motions(const Rig& rig, const Pose& pose, const std::vector<WeightColumn>& columns,
                                         const Eigen::MatrixX2d& V);

//! A motion of which the rigid blends make two: first the shear, then the similarity. With the place z seen from the
//! centre the shear is z + mu conj(z), |mu| < 1, which is symmetric and positive definite.
struct SplitMotion {
    std::complex<double> mu;
    std::complex<double> log;    //!< of the similarity's factor: log scale + i angle, whole turns counted
    std::complex<double> shift;  //!< of the similarity: e^log z + shift
    std::complex<double> centre;
};

//! \param method  who asks, for messages.
//! \return one a column.
//! \throw InvalidInput  a map mirrors, or flattens to a line or a point.
std::vector<SplitMotion> split_motions(const std::vector<ColumnMotion>& motions, const Rig& rig,
                                       const std::vector<WeightColumn>& columns, std::string_view method);

}  // namespace puppetwarp
