#include <puppetwarp/diff/compare.h>

#include <puppetwarp/base/errors.h>

#include <puppetwarp/diff/examine.h>
#include <puppetwarp/diff/heat_map.h>

namespace puppetwarp {

Comparison compare(const Image& expected, const Image& actual, const CompareOptions& options) {
    return examine(expected, actual, options, false).comparison;
}

Image heat_map(const Image& expected, const Image& actual, const CompareOptions& options) {
    ShownComparison shown = compare_and_show(expected, actual, options);
    if (!shown.comparison.comparable) {
        throw InvalidInput("heat map", shown.comparison.reason, "compare pictures of one size and one kind");
    }
    return std::move(shown.heat_map);
}

ShownComparison compare_and_show(const Image& expected, const Image& actual, const CompareOptions& options) {
    const Examination examination = examine(expected, actual, options, true);
    ShownComparison shown{examination.comparison, {}};
    if (shown.comparison.comparable) shown.heat_map = heat_map_of(expected, examination);
    return shown;
}

}  // namespace puppetwarp
