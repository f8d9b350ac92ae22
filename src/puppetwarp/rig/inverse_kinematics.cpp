#include <puppetwarp/rig/inverse_kinematics.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/bones.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

constexpr int most_rounds = 200;
// FABRIK has come close enough for the closed form to finish, as a share of the chain's length.
constexpr double close_share = 1e-4;
// Joints this share of a chain's length off the line from its start to its end are on it: no side to bend to.
constexpr double straight_share = 1e-9;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

Complex unit(const Complex& z, const Complex& otherwise) {
    return std::abs(z) > 0 ? z / std::abs(z) : otherwise;
}

// On which side of the line from a to c the point b lies: 1, -1, or 0 on it.
int side_of(const Complex& a, const Complex& b, const Complex& c) {
    const Complex along = c - a, off = b - a;
    const double across = (std::conj(along) * off).imag();
    const double size = std::abs(off) + std::abs(c - b);
    if (std::abs(across) <= straight_share * size * std::max(std::abs(along), straight_share * size)) return 0;
    return across > 0 ? 1 : -1;
}

// Moves the joints of two stiff parts, from the first joint to the `elbow` and from there to the last, so that the last
// is at the distance of the target, or as near to that as their lengths let it, and in its direction.
void bend_at(std::vector<Complex>& joints, std::size_t elbow, const Complex& target, int side) {
    const Complex start = joints.front();
    const double upper = std::abs(joints[elbow] - start), lower = std::abs(joints.back() - joints[elbow]);
    const Complex towards = unit(target - start, unit(joints.back() - start, 1));
    const double distance = std::clamp(std::abs(target - start), std::abs(upper - lower), upper + lower);
    // Law of cosines: the angle at the start between the upper part and the target.
    double cosine = 1;
    if (upper > 0 && distance > 0) {
        cosine = (upper * upper + distance * distance - lower * lower) / (2 * upper * distance);
    } else if (upper > 0) {
        cosine = 0;
    }
    cosine = std::clamp(cosine, -1.0, 1.0);
    const Complex new_elbow = start + upper * towards * Complex(cosine, side * std::sqrt(1 - cosine * cosine));
    const Complex new_end = start + distance * towards;
    const Complex first_turn = unit(new_elbow - start, 1) / unit(joints[elbow] - start, 1);
    const Complex second_turn = unit(new_end - new_elbow, 1) / unit(joints.back() - joints[elbow], 1);
    for (std::size_t i = elbow + 1; i < joints.size(); ++i) {
        joints[i] = new_elbow + second_turn * (joints[i] - joints[elbow]);
    }
    for (std::size_t i = 1; i < elbow; ++i) joints[i] = start + first_turn * (joints[i] - start);
    joints[elbow] = new_elbow;
}

std::vector<double> lengths_of(const std::vector<Complex>& joints) {
    std::vector<double> lengths;
    for (std::size_t i = 1; i < joints.size(); ++i) lengths.push_back(std::abs(joints[i] - joints[i - 1]));
    return lengths;
}

// One round of FABRIK: from the target back, from the start on.
void reach_forward_and_back(std::vector<Complex>& joints, const std::vector<double>& lengths, const Complex& target) {
    const Complex start = joints.front();
    joints.back() = target;
    for (std::size_t i = joints.size() - 1; i-- > 0;) {
        joints[i] = joints[i + 1] + lengths[i] * unit(joints[i] - joints[i + 1], 1);
    }
    joints.front() = start;
    for (std::size_t i = 1; i < joints.size(); ++i) {
        joints[i] = joints[i - 1] + lengths[i - 1] * unit(joints[i] - joints[i - 1], 1);
    }
}

// The joint whose two sides of the chain are most alike: there the closed form reaches farthest.
std::size_t middle_joint(const std::vector<double>& lengths) {
    double total = 0, sum = 0;
    for (const double length : lengths) total += length;
    std::size_t best = 1;
    double least = total;
    for (std::size_t i = 1; i < lengths.size(); ++i) {
        sum += lengths[i - 1];
        if (std::abs(total - 2 * sum) >= least) continue;
        least = std::abs(total - 2 * sum);
        best = i;
    }
    return best;
}

void straighten(std::vector<Complex>& joints, const std::vector<double>& lengths, const Complex& towards) {
    for (std::size_t i = 1; i < joints.size(); ++i) joints[i] = joints[i - 1] + lengths[i - 1] * towards;
}

// Joints of three bones and more.
void bend_chain(std::vector<Complex>& joints, const Complex& target, int side) {
    const std::vector<double> lengths = lengths_of(joints);
    double total = 0;
    for (const double length : lengths) total += length;
    const double distance = std::abs(target - joints.front());
    if (distance >= total) {
        straighten(joints, lengths, unit(target - joints.front(), unit(joints.back() - joints.front(), 1)));
        return;
    }
    // On a line there is no side to bend to, and FABRIK would stay on it: an arc to begin with.
    if (side_of(joints.front(), joints[middle_joint(lengths)], joints.back()) == 0) {
        const double bend = 0.2 * (side == 0 ? 1 : side) / static_cast<double>(lengths.size());
        Complex turn = std::polar(1.0, 0.1 * (side == 0 ? 1 : side));
        std::vector<Complex> arc = joints;
        for (std::size_t i = 1; i < joints.size(); ++i, turn *= std::polar(1.0, -bend)) {
            arc[i] = arc[i - 1] + turn * (joints[i] - joints[i - 1]);
        }
        joints = arc;
    }
    for (int round = 0; round < most_rounds; ++round) {
        if (std::abs(joints.back() - target) <= close_share * total) break;
        reach_forward_and_back(joints, lengths, target);
    }
    const std::size_t elbow = middle_joint(lengths);
    const int now = side_of(joints.front(), joints[elbow], joints.back());
    bend_at(joints, elbow, target, now == 0 ? (side == 0 ? 1 : side) : now);
}

// The ids of a chain's bones, from its first to the last.
std::vector<std::string> chain_of(const Rig& rig, const std::string& bone, int count) {
    std::vector<std::string> chain;
    for (std::string next = bone; !next.empty() && static_cast<int>(chain.size()) < count;) {
        chain.push_back(next);
        next = std::get<BoneHandle>(find_handle(rig, next)->shape).parent;
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
}

void require_turning(const Pose& pose, const std::vector<std::string>& chain) {
    for (const std::string& id : chain) {
        const auto found = pose.handles.find(id);
        if (found == pose.handles.end()) continue;
        const HandlePose& target = found->second;
        const char* field = target.to                            ? "to"
                            : target.affine                      ? "affine"
                            : target.from && id != chain.front() ? "from"
                                                                 : nullptr;
        if (field == nullptr) continue;
        throw InvalidInput("handle '" + id + "'",
                           std::string("'") + field + "' cannot stand in a chain that bends to reach a target",
                           "leave it out, or make the chain shorter");
    }
}

const BoneHandle& bone_of(const Rig& rig, const std::string& id) {
    const Handle* handle = find_handle(rig, id);
    const auto* bone = handle == nullptr ? nullptr : std::get_if<BoneHandle>(&handle->shape);
    if (bone == nullptr) throw InvalidInput("handle '" + id + "'", "it is no bone of the rig, it cannot reach");
    return *bone;
}

// Where the joints of a chain are: the starts of its bones and the end of the last.
std::vector<Complex> joints_of(const Rig& rig, const std::vector<std::string>& chain,
                               const std::vector<AffineMap>& maps) {
    std::vector<Complex> joints;
    const AffineMap* last = nullptr;
    for (const std::string& id : chain) {
        const auto h = static_cast<std::size_t>(find_handle(rig, id) - rig.handles.data());
        last = &maps[h];
        joints.push_back((*last)(complex_of(bone_of(rig, id).from)));
    }
    joints.push_back((*last)(complex_of(bone_of(rig, chain.back()).to)));
    return joints;
}

Pose without_reaches(const Pose& pose) {
    Pose plain = pose;
    for (auto& [id, target] : plain.handles) {
        target.reach.reset();
        target.chain.reset();
    }
    return plain;
}

// To which side a chain bends, by the pose, else by its rest.
int side_of_chain(const std::vector<Complex>& joints, const std::vector<Complex>& rest) {
    const auto side = [](const std::vector<Complex>& chain) {
        return chain.size() < 3 ? 0 : side_of(chain.front(), chain[middle_joint(lengths_of(chain))], chain.back());
    };
    const int posed = side(joints);
    return posed != 0 ? posed : side(rest);
}

}  // namespace

Reached reach(const Rig& rig, const Pose& pose, const std::string& bone, const Point& target, int chain) {
    bone_of(rig, bone);
    if (chain < 1) throw InvalidInput("handle '" + bone + "'", "chain must be at least 1");
    const std::vector<std::string> ids = chain_of(rig, bone, chain);
    Reached result{without_reaches(pose), 0};
    require_turning(result.pose, ids);
    const std::vector<Complex> before = joints_of(rig, ids, bone_maps(rig, result.pose));
    const std::vector<Complex> rest = joints_of(rig, ids, bone_maps(rig, Pose()));
    const Complex goal = complex_of(target);
    const int side = side_of_chain(before, rest);
    std::vector<Complex> joints = before;
    if (ids.size() == 1) {
        straighten(joints, lengths_of(joints), unit(goal - joints[0], unit(joints[1] - joints[0], 1)));
    } else if (ids.size() == 2) {
        bend_at(joints, 1, goal, side == 0 ? 1 : side);
    } else {
        bend_chain(joints, goal, side);
    }
    double turned = 0;  // by the bones before
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Complex was = before[i + 1] - before[i], is = joints[i + 1] - joints[i];
        if (std::abs(was) == 0 || std::abs(is) == 0) continue;
        const double turn = std::remainder(std::arg(is / was) - turned, 2 * std::numbers::pi);
        HandlePose& posed = result.pose.handles[ids[i]];
        posed.rotate_rad = posed.rotate_rad.value_or(0) + turn;
        turned += turn;
    }
    result.distance_px = std::abs(joints_of(rig, ids, bone_maps(rig, result.pose)).back() - goal);
    return result;
}

namespace {

// Nobody sees an end that stays this share of its bone's length away.
constexpr double missed_share = 1e-3;

bool is_missed(const Reached& reached, const BoneHandle& bone) {
    return reached.distance_px > missed_share * (bone.to - bone.from).norm();
}

std::string stays_away(double distance_px) {
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), " cannot come to its target and stays %.3g px away", distance_px);
    return text.data();
}

// \param missed  takes what is to be said of targets that are too far or too near; or null.
Pose bent_to_reaches(const Rig& rig, const Pose& pose, std::vector<std::string>* missed) {
    const bool some = std::any_of(pose.handles.begin(), pose.handles.end(),
                                  [](const auto& each) { return each.second.reach.has_value(); });
    if (!some) return pose;
    Pose bent = without_reaches(pose);
    std::set<std::string> used;
    for (const Handle& handle : rig.handles) {
        const auto found = pose.handles.find(handle.id);
        if (found == pose.handles.end() || !found->second.reach) continue;
        const int chain = found->second.chain.value_or(2);
        bone_of(rig, handle.id);
        for (const std::string& id : chain_of(rig, handle.id, chain)) {
            if (used.insert(id).second) continue;
            throw InvalidInput("handle '" + id + "'", "two chains that reach for targets share this bone",
                               "make one of them shorter");
        }
        Reached reached = reach(rig, bent, handle.id, *found->second.reach, chain);
        if (missed != nullptr && is_missed(reached, bone_of(rig, handle.id))) {
            missed->push_back("handle '" + handle.id + "': its chain" + stays_away(reached.distance_px));
        }
        bent = std::move(reached.pose);
    }
    return bent;
}

}  // namespace

Pose with_reaches(const Rig& rig, const Pose& pose) {
    return bent_to_reaches(rig, pose, nullptr);
}

std::vector<std::string> reach_warnings(const Rig& rig, const Pose& pose) {
    std::vector<std::string> missed;
    bent_to_reaches(rig, pose, &missed);
    return missed;
}

}  // namespace puppetwarp
