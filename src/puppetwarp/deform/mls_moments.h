#pragma once
// Private header.

#include <complex>

namespace puppetwarp {

//! What moving least squares need to know of weighted places p seen from a point v: sums, or integrals, of powers of
//! p - v times the weight 1 / |p - v|^2.
struct MlsMoments {
    double weight = 0;            //!< of 1
    std::complex<double> first;   //!< of p - v
    double norm = 0;              //!< of |p - v|^2
    std::complex<double> square;  //!< of (p - v)^2

    MlsMoments& operator+=(const MlsMoments& other);
};

//! Of one place. \param p  not v.
MlsMoments point_moments(const std::complex<double>& v, const std::complex<double>& p);

//! Of the segment from a to b, by length: closed forms of the integrals.   Schaefer et al. 2006, section 3, with their
//! alpha = 1, for which these forms are shorter than the paper's.
//! \param a, b  different; v does not lie between them.
MlsMoments segment_moments(const std::complex<double>& v, const std::complex<double>& a, const std::complex<double>& b);

//! Distance of v from the segment.
double segment_distance(const std::complex<double>& v, const std::complex<double>& a, const std::complex<double>& b);

//! The sums of a least-squares fit of displacements m(p): accumulated over controls, then solved.
class MlsFit {
public:
    //! Places of these moments, all moved by m.
    void add(const MlsMoments& moments, const std::complex<double>& move);
    //! Places of these moments, moved by m(p) = alpha (p - v) + beta conj(p - v) + move.
    void add(const MlsMoments& moments, const std::complex<double>& alpha, const std::complex<double>& beta,
             const std::complex<double>& move);
    //! A wish for the map's derivatives: f_z - 1 = alpha and f_zbar = beta, with this weight.
    void add_turn(double weight, const std::complex<double>& alpha, const std::complex<double>& beta);

    enum class Kind { translation, rigid, similarity, affine };
    struct Displacement {
        std::complex<double> at_centre;  //!< at v
        double residual;                 //!< weighted mean square of what the map misses, px^2
    };
    //! The map of this kind that misses least.
    Displacement solve(Kind kind) const;

private:
    // Sums about the weighted means of places and displacements, with the wishes.
    struct Centred {
        double norm;                       // |p|^2
        std::complex<double> square;       // p^2
        std::complex<double> turn, shear;  // conj(p) m, p m
        double moved;                      // |m|^2
    };
    // m = alpha p + beta conj(p) about the means.
    struct Map {
        std::complex<double> alpha = 0;
        std::complex<double> beta = 0;
    };
    Centred centred(const std::complex<double>& mean) const;
    static Map fitted(const Centred& sums, Kind kind);

    MlsMoments places_;
    std::complex<double> moved_, turn_, shear_;  // of m, conj(p) m, p m
    double moved_norm_ = 0;                      // of |m|^2
    double wish_ = 0;                            // weight of the wishes
    std::complex<double> wish_turn_, wish_shear_;
    double wish_norm_ = 0;
};

}  // namespace puppetwarp
