#pragma once
// Private header: what the solvers of quadratic programs share.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <unordered_set>

namespace puppetwarp {

struct QpOptions {
    double tolerance = 1e-8;             //!< largest KKT residual that counts as solved, above 0
    int max_iterations = 200;            //!< factorisations, at least 1
    std::function<void()> on_iteration;  //!< called before each factorisation, or empty; may throw to end the work
};

//! How the work on a quadratic program went.
struct QpReport {
    int iterations = 0;  //!< factorisations
    bool converged = false;
    double kkt_residual = 0;
    bool safeguarded = false;  //!< the active set went in circles, projected Newton steps took over
};

//! Share of the tolerance by which an active set's signs may be wrong at first: below it they are mostly round-off, on
//! which sets cycle.
inline constexpr double sign_share = 0.1;

//! Asks more of signs, where clipping what is left of the wrong ones leaves more than the tolerance.
//! \return whether there is more to ask for.
inline bool tighten(double& sign, double tolerance) {
    constexpr double least_share = 1e-4;
    if (sign <= least_share * tolerance) return false;
    sign *= 0.1;
    return true;
}

//! The active sets that an iteration has been at.
class VisitedSets {
public:
    //! Notes a set, one byte a constraint. \return whether it is new. FNV-1a of 64 bits: two different sets taken for
    //! one would cost time only.
    bool note(std::string_view set) {
        std::uint64_t hash = 14695981039346656037u;
        for (const char side : set) hash = (hash ^ static_cast<unsigned char>(side)) * 1099511628211u;
        return seen_.insert(hash).second;
    }

private:
    std::unordered_set<std::uint64_t> seen_;
};

}  // namespace puppetwarp
