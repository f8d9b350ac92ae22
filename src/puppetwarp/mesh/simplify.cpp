#include <puppetwarp/mesh/simplify.h>

#include <puppetwarp/mesh/segment_grid.h>

#include <algorithm>
#include <cstdint>

namespace puppetwarp {

namespace {

double squared_distance(const Point& p, const Point& a, const Point& b) {
    const Point edge = b - a;
    const double squared = edge.squaredNorm();
    const double t = squared > 0 ? std::clamp((p - a).dot(edge) / squared, 0.0, 1.0) : 0.0;
    return (a + t * edge - p).squaredNorm();
}

// One new edge: from point `from` of a loop to point `to`, which may be one past the last and then means the first.
struct Chord {
    std::size_t loop, from, to;
    bool checked = false;
};

class Simplifier {
public:
    Simplifier(const std::vector<Polyline>& loops, const std::function<bool(const Point&, const Point&)>& blocked)
        : loops_(loops), blocked_(blocked) {}

    std::vector<Polyline> run(double tolerance) {
        for (std::size_t loop = 0; loop < loops_.size(); ++loop) reduce(loop, tolerance * tolerance);
        while (divide_faulty()) {
        }
        std::vector<Polyline> simple(loops_.size());
        for (const Chord& chord : chords_) simple[chord.loop].push_back(start(chord));
        return simple;
    }

private:
    const Point& start(const Chord& chord) const { return loops_[chord.loop][chord.from]; }
    const Point& end(const Chord& chord) const { return loops_[chord.loop][chord.to % loops_[chord.loop].size()]; }

    // The point that is farthest from the chord, and how far it is, squared. \pre there is one between its ends.
    std::pair<std::size_t, double> farthest(const Chord& chord) const {
        std::pair<std::size_t, double> best{(chord.from + chord.to) / 2, 0.0};
        for (std::size_t k = chord.from + 1; k < chord.to; ++k) {
            const double squared = squared_distance(loops_[chord.loop][k], start(chord), end(chord));
            if (squared > best.second) best = {k, squared};
        }
        return best;
    }

    void reduce(std::size_t loop, double squared_tolerance) {
        const std::size_t first_chord = chords_.size();
        const std::size_t count = loops_[loop].size();
        const std::size_t opposite = farthest({loop, 0, count}).first;
        std::vector<Chord> open{{loop, opposite, count}, {loop, 0, opposite}};
        while (!open.empty()) {
            const Chord chord = open.back();
            open.pop_back();
            const auto [point, squared] =
                chord.to - chord.from > 1 ? farthest(chord) : std::pair<std::size_t, double>{0, -1.0};
            // A polygon needs a third corner: the first chord is always divided where it can be.
            const bool needed = chords_.size() == first_chord && chord.to == opposite && chord.from == 0;
            if (squared > squared_tolerance || (needed && squared >= 0)) {
                open.push_back({loop, point, chord.to});
                open.push_back({loop, chord.from, point});
            } else {
                chords_.push_back(chord);
            }
        }
        if (chords_.size() - first_chord < 3) divide_all_from(first_chord);
    }

    void divide_all_from(std::size_t first_chord) {
        std::vector<Chord> finer;
        for (std::size_t k = first_chord; k < chords_.size(); ++k) divide(chords_[k], finer);
        chords_.resize(first_chord);
        chords_.insert(chords_.end(), finer.begin(), finer.end());
    }

    void divide(const Chord& chord, std::vector<Chord>& finer) const {
        if (chord.to - chord.from < 2) {
            finer.push_back(chord);
            return;
        }
        const std::size_t point = farthest(chord).first;
        finer.push_back({chord.loop, chord.from, point});
        finer.push_back({chord.loop, point, chord.to});
    }

    // Divides every chord that is blocked or meets another; false when none was or none can be divided further.
    bool divide_faulty() {
        std::vector<std::uint8_t> faulty(chords_.size(), 0);
        std::vector<Segment> segments;
        segments.reserve(chords_.size());
        for (std::size_t k = 0; k < chords_.size(); ++k) {
            Chord& chord = chords_[k];
            segments.push_back({start(chord), end(chord)});
            if (!chord.checked && chord.to - chord.from > 1) faulty[k] = blocked_(start(chord), end(chord));
            chord.checked = true;
        }
        for (const auto& [one, other] : meeting_pairs(segments)) faulty[one] = faulty[other] = 1;
        std::vector<Chord> finer;
        for (std::size_t k = 0; k < chords_.size(); ++k) {
            if (faulty[k]) {
                divide(chords_[k], finer);
            } else {
                finer.push_back(chords_[k]);
            }
        }
        const bool divided = finer.size() > chords_.size();
        chords_.swap(finer);
        return divided;
    }

    const std::vector<Polyline>& loops_;
    const std::function<bool(const Point&, const Point&)>& blocked_;
    std::vector<Chord> chords_;  // in the order of the loops and of their points
};

}  // namespace

std::vector<Polyline> simplify(const std::vector<Polyline>& loops, double tolerance,
                               const std::function<bool(const Point&, const Point&)>& blocked) {
    return Simplifier(loops, blocked).run(tolerance);
}

}  // namespace puppetwarp
