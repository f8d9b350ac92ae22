#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>

#include <vector>

namespace puppetwarp {

enum class MotionKind { translation, rigid, similarity };

//! How each component moves as a whole.
class ReferenceMotion {
public:
    //! The motion of this kind of each held component that fits its handles best: means of discs and held vertices by
    //! least squares, angles as the disc's radius times the turn. Exact where the handles move so; what they leave free
    //! stays as it rests. Components without handles stay.
    //! \param component  of each vertex.   \param rest  #V.
    ReferenceMotion(MotionKind kind, const Binding& binding, const Targets& targets, const Eigen::VectorXi& component,
                    const Eigen::VectorXcd& rest);

    //! The f_z of the motion of a vertex's component.
    std::complex<double> turn(int vertex) const { return motions_[static_cast<std::size_t>(component_(vertex))].turn; }
    //! The rest pose moved. #V
    Eigen::VectorXcd applied(const Eigen::VectorXcd& rest) const;

private:
    // z -> from + move + turn (z - from)
    struct Motion {
        std::complex<double> from = 0, move = 0, turn = 1;
    };
    const Eigen::VectorXi& component_;
    std::vector<Motion> motions_;
};

}  // namespace puppetwarp
