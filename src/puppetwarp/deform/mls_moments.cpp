#include <puppetwarp/deform/mls_moments.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Angles below this are their tangents, to double precision with the next term of the series.
constexpr double small_angle = 1e-4;

double dot(const Complex& a, const Complex& b) {
    return a.real() * b.real() + a.imag() * b.imag();
}

// Without the checks for infinity of the operator.
Complex product(const Complex& a, const Complex& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

double cross(const Complex& a, const Complex& b) {
    return a.real() * b.imag() - a.imag() * b.real();
}

}  // namespace

MlsMoments& MlsMoments::operator+=(const MlsMoments& other) {
    weight += other.weight;
    first += other.first;
    norm += other.norm;
    square += other.square;
    return *this;
}

MlsMoments point_moments(const Complex& v, const Complex& p) {
    const Complex arm = p - v;
    const double weight = 1 / std::norm(arm);
    return {weight, weight * arm, 1, weight * product(arm, arm)};
}

// Along the segment p - v = foot + t e, with the foot of the perpendicular from v at t = 0.
MlsMoments segment_moments(const Complex& v, const Complex& a, const Complex& b) {
    const double length = std::abs(b - a);
    const Complex e = (b - a) / length;
    const Complex foot = (a - v) - dot(e, a - v) * e;
    // Integrals of 1, t, t^2 over |foot|^2 + t^2.
    const double across = std::abs(cross(a - v, b - v)), along = dot(a - v, b - v);
    const double tangent = across / along;
    const double zeroth = along > 0 && tangent < small_angle ? length / along * (1 - tangent * tangent / 3)
                                                             : std::atan2(across, along) * length / across;
    const double first = std::log(std::norm(b - v) / std::norm(a - v)) / 2;
    const double second = length - std::norm(foot) * zeroth;
    return {zeroth, zeroth * foot + first * e, length, zeroth * foot * foot + 2 * first * foot * e + second * e * e};
}

double segment_distance(const Complex& v, const Complex& a, const Complex& b) {
    const double t = std::clamp(dot(b - a, v - a) / std::norm(b - a), 0.0, 1.0);
    return std::abs(v - (a + t * (b - a)));
}

void MlsFit::add(const MlsMoments& moments, const Complex& move) {
    places_ += moments;
    moved_ += move * moments.weight;
    turn_ += product(std::conj(moments.first), move);
    shear_ += product(moments.first, move);
    moved_norm_ += std::norm(move) * moments.weight;
}

void MlsFit::add(const MlsMoments& moments, const Complex& alpha, const Complex& beta, const Complex& move) {
    places_ += moments;
    moved_ += alpha * moments.first + beta * std::conj(moments.first) + move * moments.weight;
    turn_ += alpha * moments.norm + beta * std::conj(moments.square) + move * std::conj(moments.first);
    shear_ += alpha * moments.square + beta * moments.norm + move * moments.first;
    moved_norm_ += (std::norm(alpha) + std::norm(beta)) * moments.norm + std::norm(move) * moments.weight +
                   2 * (alpha * std::conj(beta) * moments.square + alpha * std::conj(move) * moments.first +
                        beta * std::conj(move * moments.first))
                           .real();
}

void MlsFit::add_turn(double weight, const Complex& alpha, const Complex& beta) {
    wish_ += weight;
    wish_turn_ += weight * alpha;
    wish_shear_ += weight * beta;
    wish_norm_ += weight * (std::norm(alpha) + std::norm(beta));
}

MlsFit::Centred MlsFit::centred(const Complex& mean) const {
    return {std::max(places_.norm - std::norm(places_.first) / places_.weight, 0.0) + wish_,
            places_.square - product(places_.first, mean), turn_ - product(std::conj(mean), moved_) + wish_turn_,
            shear_ - product(mean, moved_) + wish_shear_,
            moved_norm_ - std::norm(moved_) / places_.weight + wish_norm_};
}

MlsFit::Map MlsFit::fitted(const Centred& sums, Kind kind) {
    switch (kind) {
        case Kind::translation: break;
        case Kind::rigid: {
            const Complex correlation = sums.norm + sums.turn;
            const double length = std::abs(correlation);
            return {length > 0 ? correlation / length - 1.0 : Complex(0), 0};
        }
        case Kind::similarity: return {sums.norm > 0 ? sums.turn / sums.norm : Complex(0), 0};
        case Kind::affine: {
            const double determinant = sums.norm * sums.norm - std::norm(sums.square);
            return {(sums.norm * sums.turn - product(std::conj(sums.square), sums.shear)) / determinant,
                    (sums.norm * sums.shear - product(sums.square, sums.turn)) / determinant};
        }
    }
    return {};
}

MlsFit::Displacement MlsFit::solve(Kind kind) const {
    const Complex mean = places_.first / places_.weight;
    const Centred sums = centred(mean);
    const Map map = fitted(sums, kind);
    const double missed = sums.moved - 2 * (dot(map.alpha, sums.turn) + dot(map.beta, sums.shear)) +
                          (std::norm(map.alpha) + std::norm(map.beta)) * sums.norm +
                          2 * dot(map.beta, product(map.alpha, sums.square));
    return {moved_ / places_.weight - product(map.alpha, mean) - product(map.beta, std::conj(mean)),
            std::max(missed, 0.0) / places_.weight};
}

}  // namespace puppetwarp
