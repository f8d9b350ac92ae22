#include <puppetwarp/diff/compare_folders.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>

#include <puppetwarp/diff/folder_listing.h>
#include <puppetwarp/diff/printable.h>

#include <algorithm>
#include <array>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

// So many pairs are shared out among the threads at a time; observers hold no more than that unsettled.
constexpr int kPairsATime = 64;

// Both listings are sorted.
std::vector<PairResult> pair_up(const std::vector<std::string>& expected, const std::vector<std::string>& actual) {
    std::vector<PairResult> pairs;
    const auto add = [&](const std::string& path, PairState state) { pairs.push_back({path, state, {}, {}}); };
    auto theirs = actual.begin();
    for (const std::string& path : expected) {
        for (; theirs != actual.end() && *theirs < path; ++theirs) add(*theirs, PairState::extra);
        const bool both = theirs != actual.end() && *theirs == path;
        add(path, both ? PairState::same : PairState::missing);
        if (both) ++theirs;
    }
    for (; theirs != actual.end(); ++theirs) add(*theirs, PairState::extra);
    return pairs;
}

class PairWork {
public:
    PairWork(const fs::path& expected, const fs::path& actual, const CompareOptions& options,
             const ReadOptions& reading, bool show, PairObserver& observer)
        : expected_(expected),
          actual_(actual),
          options_(options),
          reading_(reading),
          show_(show),
          observer_(observer) {}

    void compare(std::size_t index, PairResult& pair) const {
        try {
            const ComparedFiles files = compare_files(expected_ / pair.path, actual_ / pair.path, options_, reading_,
                                                      show_, PairReading::one_after_other);
            pair.comparison = files.comparison;
            pair.state = files.comparison.same ? PairState::same : PairState::different;
            pair.error.clear();
            observer_.see(index, pair.path, files);
        } catch (const InvalidInput& error) {
            pair.state = PairState::not_compared;
            pair.error = printable(complaint(error, pair.path));
        }
    }

private:
    // What is not a file's own fault is the options', for this pair.
    std::string complaint(const InvalidInput& error, const std::string& path) const {
        const bool names_file =
            error.subject() == (expected_ / path).string() || error.subject() == (actual_ / path).string();
        return names_file ? error.what() : path + ": " + error.what();
    }

    const fs::path& expected_;
    const fs::path& actual_;
    const CompareOptions& options_;
    const ReadOptions& reading_;
    bool show_;
    PairObserver& observer_;
};

bool is_pair(const PairResult& pair) {
    return pair.state != PairState::missing && pair.state != PairState::extra;
}

void compare_some(const PairWork& work, int first, int last, std::vector<PairResult>& pairs) {
    const auto at = [&](int i) -> PairResult& { return pairs[static_cast<std::size_t>(i)]; };
    parallel_for(first, last, 1, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
            if (is_pair(at(i))) work.compare(static_cast<std::size_t>(i), at(i));
        }
    });
    // Decoders share one place for their complaints: alone, each file at fault gets its own.
    for (int i = first; i < last; ++i) {
        if (at(i).state == PairState::not_compared) work.compare(static_cast<std::size_t>(i), at(i));
    }
}

}  // namespace

std::string pair_state_name(PairState state) {
    static constexpr std::array<const char*, 5> kNames{"same", "different", "missing", "extra", "not compared"};
    return kNames[static_cast<std::size_t>(state)];
}

std::size_t FolderComparison::count(PairState state) const {
    return static_cast<std::size_t>(
        std::count_if(pairs.begin(), pairs.end(), [&](const PairResult& pair) { return pair.state == state; }));
}

FolderComparison compare_folders(const fs::path& expected, const fs::path& actual, const CompareOptions& options,
                                 const ReadOptions& reading, bool show, PairObserver& observer, Progress& progress) {
    require_sound(options);
    const FolderListing wanted = list_pictures(expected), found = list_pictures(actual);
    FolderComparison result;
    result.pairs = pair_up(wanted.pictures, found.pictures);
    result.loops = wanted.loops;
    result.loops.insert(result.loops.end(), found.loops.begin(), found.loops.end());
    if (result.pairs.empty()) {
        throw InvalidInput(expected.string(), "neither this folder nor " + actual.string() + " has a picture");
    }
    const PairWork work(expected, actual, options, reading, show, observer);
    const int pairs = static_cast<int>(result.pairs.size());
    for (int first = 0; first < pairs; first += kPairsATime) {
        const int last = std::min(pairs, first + kPairsATime);
        compare_some(work, first, last, result.pairs);
        observer.settle(static_cast<std::size_t>(first), static_cast<std::size_t>(last));
        progress.step("diff", static_cast<double>(last) / pairs);
    }
    result.same = result.count(PairState::same) == result.pairs.size();
    return result;
}

}  // namespace puppetwarp
