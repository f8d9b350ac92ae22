// Drags at random and counts what must not be: triangles folded over by `fold-free`, and numbers that are none by any.
#include "reference/random_drags.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace puppetwarp {
namespace {

constexpr int most_vertices = 2000;

reference::DragTally drag_for(Method method, double seconds, std::uint32_t seed, bool worker) {
    MethodOptions options;
    options.method = method;
    options.max_iterations = 300;
    reference::RandomDrags drags(options, seed, most_vertices, worker);
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) drags.drag();
    const reference::DragTally& tally = drags.tally();
    std::printf("%-12s %6s %7d %8d %8d %6d %10d %12.1e\n", method_name(method).c_str(), worker ? "yes" : "no",
                tally.drags, tally.calls, tally.refused, tally.folds, tally.not_finite, tally.worst_rise);
    std::fflush(stdout);
    return tally;
}

bool drag_all(double seconds, std::uint32_t seed) {
    std::printf("method       worker   drags    calls  refused  folds  no numbers  worst rise\n");
    bool good = true;
    const auto judge = [&](Method method, double share, bool worker) {
        const reference::DragTally tally = drag_for(method, share * seconds, seed, worker);
        const bool folded = method == Method::fold_free && tally.folds > 0;
        if (!folded && tally.not_finite == 0) return;
        std::printf("  the subject of seed %u is at fault\n", tally.worst_at);
        good = false;
    };
    judge(Method::fold_free, 0.6, false);
    judge(Method::fold_free, 0.2, true);
    judge(Method::smooth_arap, 0.1, false);
    judge(Method::arap, 0.1, false);
    return good;
}

}  // namespace
}  // namespace puppetwarp

// Usage: drag_at_random [SECONDS [SEED]]
int main(int argc, char** argv) {
    const double seconds = argc > 1 ? std::strtod(argv[1], nullptr) : 60;
    const auto seed = argc > 2 ? static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10)) : 1u;
    return puppetwarp::drag_all(seconds, seed) ? EXIT_SUCCESS : EXIT_FAILURE;
}
